"""Draws the marks of a picture, for models and people that look at pixels. The picture itself is left alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import (
    Axes,
    BoxMark,
    BoxStyle,
    Candidates,
    Grid,
    LineMark,
    PathMark,
    Picture,
    Point,
    PointMark,
    RegionMark,
    Tiles,
    TurnMark,
)
from wonderful_team.images.arrows import bows, draw_arrows, start_label, step_colour
from wonderful_team.images.axes import Ticks, draw_axes
from wonderful_team.images.canvas import (
    BLUE,
    INK,
    ORANGE,
    SKY,
    VERMILLION,
    WHITE,
    YELLOW,
    Canvas,
    Colour,
)
from wonderful_team.images.lettering import plain
from wonderful_team.images.placing import PointLabel, label_box, label_points, paint_plates
from wonderful_team.images.turn_marks import draw_grid, draw_turn, number_tiles

BOX_COLOURS: dict[BoxStyle, Colour] = {
    "target": ORANGE,
    "before": SKY,
    "after": ORANGE,
    "keep_out": VERMILLION,
    "workspace": WHITE,
}
"""Colour of each box style; before, keep_out and workspace are dashed as well, so colour never carries meaning alone."""
_THINGS: frozenset[BoxStyle] = frozenset({"target", "before", "after"})
_SMALL_BOX = 7.0
"""A box whose shorter side is less than so many heights of a plate is hidden by the plates of points inside it."""
_LEAST_RADIUS = 2.2  # of a numbered dot, in the canvas's unit
_CHOICES = (BLUE, VERMILLION)
"""Colours of numbered points, of one thing and of another."""
DASHED: frozenset[BoxStyle] = frozenset({"before", "keep_out", "workspace"})


def draw(picture: Picture, ticks: Ticks = Ticks.PIXELS) -> Array:
    """The picture with its marks drawn.

    Boxes come first, then lines and paths, then axes, then points, then every label, so that no line crosses a
    number. Marks past the edge are cut there; their labels are pushed inside.

    Args:
        picture: Clean pixels and marks.
        ticks: What the numbers of the axes mean.

    Returns:
        A new image of the same size, shape (H, W, 3), uint8.
    """
    canvas = Canvas.over(picture.rgb)
    for grid in picture.mark(Grid):
        draw_grid(canvas, grid)
    boxes, regions = picture.mark(BoxMark), picture.mark(RegionMark)
    paths = [path for path in picture.mark(PathMark) if path.points]
    _draw_boxes(canvas, boxes, regions)
    for line in picture.mark(LineMark):
        draw_line(canvas, line.start, line.end)
    for number, path in enumerate(paths, start=1):
        draw_strip(canvas, path.points, path.width, step_colour(number))
    ways = bows([path.points for path in paths], canvas.size_px, [path.bowed for path in paths])
    draw_arrows(canvas, ways)
    turned = [label for mark in picture.mark(TurnMark) for label in draw_turn(canvas, mark)]
    choices, points = picture.mark(Candidates), picture.mark(PointMark)
    radius, reach = _choice_radius(canvas, choices), point_reach(canvas)
    numbered = [
        (point, f"{choice.prefix}{k}", _CHOICES[number % len(_CHOICES)])
        for number, choice in enumerate(choices)
        for k, point in enumerate(choice.points, start=1)
    ]
    crowd = _crowd(canvas, [point for point, _, _ in numbered], radius)
    for point, _, _ in numbered:
        canvas.keep_clear(point, radius - 1)
    for mark in points:
        canvas.keep_clear(mark.point, reach * 0.8)
    canvas.named += [point for point, _, _ in numbered] + [mark.point for mark in points]
    for axes in picture.mark(Axes):
        draw_axes(canvas, picture.frame, axes, ticks)
    labels = [PointLabel(point, text, radius, colour, off_things=crowd) for point, text, colour in numbered]
    labels += [
        PointLabel(mark.point, plain(mark.label), reach * 0.8, INK, off_things=True) for mark in points if mark.label
    ]
    labels += [
        start_label(canvas, path.points, plain(path.label), step_colour(number))
        for number, path in enumerate(paths, start=1)
        if path.label
    ]
    placed = label_points(canvas, [*labels, *turned])
    for point, _, colour in numbered:
        canvas.disc(point, radius, colour, WHITE)
    for mark in points:
        canvas.cross(mark.point, reach, WHITE)
    paint_plates(canvas, placed)
    named = [(box.box, box.label, box.style) for box in boxes]
    for outline, label, style in (*named, *((_round(region), region.label, "keep_out") for region in regions)):
        if label:
            label_box(canvas, outline, plain(label), back=BOX_COLOURS[style], inside=style == "keep_out")
    number_tiles(canvas, [box for mark in picture.mark(Tiles) for box in mark.boxes])
    return canvas.rgb


def line_width_px(picture: Picture) -> int:
    """How wide the whole line of a box is drawn on a picture, with its rims [px of it]."""
    return _outline_width(picture.size_px)


@lru_cache(maxsize=64)
def _outline_width(size_px: tuple[int, int]) -> int:
    width, height = size_px
    canvas = Canvas(np.full((height, width, 3), 128, dtype=np.uint8))
    middle, outside = width // 2, 99
    canvas.outline(
        [
            (middle, -outside),
            (width + outside, -outside),
            (width + outside, height + outside),
            (middle, height + outside),
        ],
        ORANGE,
    )
    return int((canvas.rgb[height // 2] != 128).any(axis=-1).sum())


def _round(region: RegionMark) -> Box:
    return Box.bounding(region.corners)


def _draw_boxes(canvas: Canvas, boxes: Sequence[BoxMark], regions: Sequence[RegionMark]) -> None:
    """Regions first, then boxes; what targets' boxes hold is kept clear of plates."""
    for region in regions:
        draw_box(canvas, region.corners, "keep_out")
    for box in sorted(boxes, key=lambda mark: mark.style not in ("workspace", "keep_out")):
        draw_box(canvas, box.box.corners, box.style)
    canvas.things += [box.box.as_tuple for box in boxes if box.style in _THINGS]


def _choice_radius(canvas: Canvas, choices: Sequence[Candidates]) -> float:
    """Radius of the dots of numbered points [px]: smaller where they stand close, so that what lies under them shows."""
    points = [point for choice in choices for point in choice.points]
    gaps = [math.dist(one, two) for k, one in enumerate(points) for two in points[:k]]
    return max(_LEAST_RADIUS * canvas.unit, min([candidate_radius(canvas), *(0.2 * gap for gap in gaps)]))


def _crowd(canvas: Canvas, numbered: Sequence[Point], radius: float) -> bool:
    """Whether the plates of numbered points would hide the thing they stand on: then it is kept clear of them.

    That is so for a box that is small beside a plate, and without a box for points that stand close together.
    """
    if not numbered:
        return False
    tall = canvas.plate_size("0")[1]
    if canvas.things:
        return min(min(x1 - x0, y1 - y0) for x0, y0, x1, y1 in canvas.things) < _SMALL_BOX * tall
    xs, ys = ([point[axis] for point in numbered] for axis in (0, 1))
    if len(numbered) < 2 or max(max(xs) - min(xs), max(ys) - min(ys)) > _SMALL_BOX * tall:  # noqa: PLR2004  one is no crowd
        return False
    room = 1.5 * tall + radius
    canvas.things.append((min(xs) - room, min(ys) - room, max(xs) + room, max(ys) + room))
    return True


def draw_box(canvas: Canvas, corners: Sequence[Point], style: BoxStyle, colour: Colour | None = None) -> None:
    """The outline of a box or quadrangle in its style; keep-out regions are tinted."""
    stroke = colour or BOX_COLOURS[style]
    if style == "keep_out":
        canvas.polygon(corners, stroke, 0.3)
    held = [_on_picture(canvas, corner) for corner in corners] if style != "workspace" else list(corners)
    if style in DASHED:
        thin = max(1, canvas.stroke_px - 1)
        if style == "keep_out":
            canvas.dashes(held, stroke, halo=WHITE)
        else:
            canvas.dashes(held, stroke, width_px=thin if style == "workspace" else None)
    else:
        canvas.outline(held, stroke)


def draw_line(canvas: Canvas, start: Point, end: Point) -> None:
    """A straight line; along the picture's border it is moved inside by half its width, so that it shows."""
    canvas.polyline([_on_picture(canvas, start), _on_picture(canvas, end)], YELLOW)


def draw_strip(canvas: Canvas, points: Sequence[Point], width: float, colour: Colour) -> None:
    """What a tool of this width sweeps from the first point straight to the last [px]: tinted, its edge dashed."""
    if width <= 0 or len(points) < 2 or math.dist(points[0], points[-1]) < 1e-6:
        return
    (xa, ya), (xb, yb) = points[0], points[-1]
    length = math.dist(points[0], points[-1])
    ox, oy = -(yb - ya) / length * width / 2, (xb - xa) / length * width / 2
    corners = [(xa + ox, ya + oy), (xb + ox, yb + oy), (xb - ox, yb - oy), (xa - ox, ya - oy)]
    canvas.polygon(corners, colour, 0.3)
    canvas.dashes(corners, colour, width_px=max(1, canvas.stroke_px - 1))


def candidate_radius(canvas: Canvas) -> float:
    """Radius of a candidate's dot [px]."""
    return 4.5 * canvas.unit


def point_reach(canvas: Canvas) -> float:
    """Half the size of a point's cross [px]."""
    return 10.0 * canvas.unit


def _on_picture(canvas: Canvas, point: Point) -> Point:
    """A point at or just past the border, moved inside by half a stroke; others stay where they are."""
    width, height = canvas.size_px
    half = canvas.stroke_px / 2 + 0.5
    x, y = point
    if -half <= x < half or width - half < x <= width + half:
        x = min(max(x, half), width - half)
    if -half <= y < half or height - half < y <= height + half:
        y = min(max(y, half), height - half)
    return x, y
