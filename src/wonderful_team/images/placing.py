"""Where plates go: inside the picture, off each other, off the points they name; with a leader line when crowded."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.images.canvas import INK, WHITE, Canvas, Colour, Rectangle

# Where a plate may stand from its point, in order of preference: above first, as numbers are read.
_DIRECTIONS = ((0, -1), (1, 0), (-1, 0), (0, 1), (1, -1), (-1, -1), (1, 1), (-1, 1))
_RINGS = (1.0, 2.5, 4.0, 6.0, 8.5, 12.0, 16.0, 21.0, 27.0)  # distances tried, in radii of the mark
# For leader lines: the sixteen directions of a compass, so that lines find their way between the points of a grid.
_OBLIQUE = tuple((math.sin(k * math.pi / 8), -math.cos(k * math.pi / 8)) for k in range(16))
_COVERED = 5.0  # cost of covering anything at all
_CROSSED = 0.35  # cost of a leader line over another point
_MISREAD = 0.3  # cost of a plate that stands nearer to another named point than to its own


@dataclass(frozen=True)
class PointLabel:
    """A point and the text of its plate.

    Attributes:
        point: What is named.
        text: What to write.
        radius: The mark's own radius [px]; the plate stays off it.
        back: Colour of the plate.
        colour: Colour of the letters.
        off_things: The plate keeps off the things on the canvas, with a leader line where it stands away.
    """

    point: Point
    text: str
    radius: float
    back: Colour
    colour: Colour = WHITE
    off_things: bool = False


def label_points(canvas: Canvas, labels: Sequence[PointLabel]) -> list[tuple[PointLabel, Rectangle]]:
    """Find places for plates near points, covering neither points nor anything taken, and draw the leader lines.

    All places are settled before a line is drawn, so no leader runs over a number: paint the points next, then the
    plates with `paint_plates`.
    """
    placed: list[tuple[PointLabel, Rectangle]] = []
    leaders: dict[Colour, list[list[Point]]] = {}
    for label in labels:
        off = canvas.things if label.off_things else ()
        spot, ring = _place_round(canvas, label.point, canvas.plate_size(label.text), label.radius + 2, off)
        canvas.taken.append(spot)
        placed.append((label, spot))
        if ring > 0:
            leaders.setdefault(label.back, []).append([label.point, _nearest(spot, label.point)])
    for colour, lines in leaders.items():
        canvas.lines(lines, colour, width_px=max(1, canvas.stroke_px - 1), halo=WHITE)
    return placed


def paint_plates(canvas: Canvas, placed: Sequence[tuple[PointLabel, Rectangle]]) -> None:
    """The plates that `label_points` found places for."""
    for label, spot in placed:
        canvas.plate(label.text, int(spot[0]), int(spot[1]), back=label.back, colour=label.colour, alpha=0.92)


def label_box(canvas: Canvas, box: Box, text: str, *, back: Colour, colour: Colour = INK, inside: bool = False) -> None:
    """A plate at a box: above its top-left corner if there is room, else below, beside, or inside the box.

    With `inside`, which is for regions that are no things, in its corner first.
    """
    width, height = canvas.plate_size(text)
    half = canvas.stroke_px / 2 + 1
    x0, y0, x1, y1 = box.as_tuple
    left, right, above, below = x0 - half, x1 + half - width, y0 - half - height, y1 + half
    corners = (
        (left, above), (right, above), (left, below), (right, below), (x1 + half, y0 - half),
        (x0 - half - width, y0 - half), (x0 + half, y0 + half), (x0 + half, y1 - half - height),
    )  # fmt: skip
    if inside:
        corners = (*corners[-2:], *corners[:-2])
    best, lowest = (0.0, 0.0, float(width), float(height)), math.inf
    for rank, (x, y) in enumerate(corners):
        option = _held_inside((round(x), round(y), round(x) + width, round(y) + height), canvas.size_px)
        moved = abs(option[0] - x) + abs(option[1] - y)
        cost = (
            _overlap(option, [*canvas.taken, *canvas.things]) / (width * height)
            + moved / (width + height)
            + 0.01 * rank
        )
        if cost < lowest:
            best, lowest = option, cost
    canvas.plate(text, int(best[0]), int(best[1]), back=back, colour=colour, alpha=0.92)


def _place_round(
    canvas: Canvas, point: Point, size: tuple[int, int], radius: float, off: Sequence[Rectangle] = ()
) -> tuple[Rectangle, int]:
    """The best free spot round a point, and in which ring it lies (0: touching the mark)."""
    width, height = size
    clear = radius - 0.75  # plates stand on whole pixels, so they may come this much nearer than they were asked to
    taken = [*canvas.taken, *off, (point[0] - clear, point[1] - clear, point[0] + clear, point[1] + clear)]
    best, best_ring, lowest = (0.0, 0.0, float(width), float(height)), 0, math.inf
    for ring, factor in enumerate(_RINGS):
        for rank, (dx, dy) in enumerate(_DIRECTIONS if ring == 0 else _OBLIQUE):
            reach = radius * factor
            x0 = round(point[0] + dx * (reach + width / 2) - width / 2)
            y0 = round(point[1] + dy * (reach + height / 2) - height / 2)
            spot = _held_inside((x0, y0, x0 + width, y0 + height), canvas.size_px)
            blocked = _overlap(spot, taken)
            cost = ring * 0.2 + rank * 0.005 + (_COVERED + 10 * blocked / (width * height) if blocked else 0.0)
            if cost < lowest:
                cost += _MISREAD * _misread(canvas, spot, point)
                cost += _CROSSED * _crossed(canvas, spot, point, radius) if ring else 0.0
            if cost < lowest:
                best, best_ring, lowest = spot, ring, cost
        if lowest < (ring + 1) * 0.2:
            break
    return best, best_ring


def _misread(canvas: Canvas, spot: Rectangle, point: Point) -> bool:
    """Whether another named point lies about as near to the plate as its own."""
    own = math.dist(_nearest(spot, point), point)
    slack = 0.25 * (spot[3] - spot[1])
    return any(
        other != point and math.dist(_nearest(spot, other), other) < own + slack
        for other in canvas.named
        if abs(other[0] - point[0]) + abs(other[1] - point[1]) < 12 * (spot[3] - spot[1])
    )


def _crossed(canvas: Canvas, spot: Rectangle, point: Point, radius: float) -> int:
    """How many other named points the leader line from the point to its plate would run over."""
    end = _nearest(spot, point)
    dx, dy = end[0] - point[0], end[1] - point[1]
    length = math.hypot(dx, dy)
    if length == 0:
        return 0
    dx, dy = dx / length, dy / length
    count = 0
    for x, y in canvas.named:
        along = (x - point[0]) * dx + (y - point[1]) * dy
        aside = abs((x - point[0]) * dy - (y - point[1]) * dx)
        count += 0 < along < length and aside < radius and (x, y) != point
    return count


def _held_inside(spot: Rectangle, size_px: tuple[int, int]) -> Rectangle:
    """The rectangle pushed inside the picture; one larger than the picture starts at its top-left corner."""
    x0, y0, x1, y1 = spot
    dx = -x0 if x0 < 0 or x1 - x0 > size_px[0] else min(0.0, size_px[0] - x1)
    dy = -y0 if y0 < 0 or y1 - y0 > size_px[1] else min(0.0, size_px[1] - y1)
    return x0 + dx, y0 + dy, x1 + dx, y1 + dy


def _overlap(spot: Rectangle, others: Iterable[Rectangle]) -> float:
    x0, y0, x1, y1 = spot
    return sum(
        (min(x1, c) - max(x0, a)) * (min(y1, d) - max(y0, b))
        for a, b, c, d in others
        if x0 < c and a < x1 and y0 < d and b < y1
    )


def _nearest(spot: Rectangle, point: Point) -> Point:
    return min(max(point[0], spot[0]), spot[2]), min(max(point[1], spot[1]), spot[3])
