"""Drawings over pictures: targets, boxes, points, arrows. Coordinates are pixels of the main view."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

from wonderful_team.images.turn_marks import arc_points
from wonderful_team.pages.pictures import Album, text_in_svg

Corner = Sequence[float]
_SHADES = 6
LONG = 6.0
"""Arrows longer than so many times the size of marks carry their number."""
NUMBER_AT = 0.27
"""Where on the way it stands there (0 to 1)."""


def shade(position: int) -> str:
    """The colour class of the n-th target."""
    return f"t{position % _SHADES}"


def view_drawing(album: Album, key: str | None, alt: str, layers: Sequence[Markup], css: str) -> Markup:
    """The whole view with layers over it."""
    shown = album.get(key)
    if shown is None:
        return Markup('<p class="missing">picture missing: {}</p>').format(alt)
    width, height = shown.size_px
    return _drawing(shown.number, (0.0, 0.0, width, height), alt, layers, css)


def crop_drawing(
    album: Album, key: str | None, window: tuple[float, float, float, float], alt: str, layers: Sequence[Markup]
) -> Markup:
    """A part of the view, (x, y, width, height) [px], enlarged, with layers over it."""
    shown = album.get(key)
    if shown is None:
        return Markup('<p class="missing">picture missing: {}</p>').format(alt)
    return _drawing(shown.number, window, alt, layers, "crop")


def _drawing(
    number: int, window: tuple[float, float, float, float], alt: str, layers: Sequence[Markup], css: str
) -> Markup:
    box = " ".join(f"{value:.2f}" for value in window)
    return Markup(
        '<svg class="{}" viewBox="{}" role="img" aria-label="{}"><title>{}</title><use href="#p{}"/>{}</svg>'
    ).format(css, box, alt, alt, number, Markup("").join(layers))


def box_layer(box: dict[str, float], css: str) -> Markup:
    """A box with a light rim, so that it shows on any ground."""
    geometry = Markup('x="{}" y="{}" width="{}" height="{}"').format(
        *(f"{v:.2f}" for v in (box["x0"], box["y0"], box["x1"] - box["x0"], box["y1"] - box["y0"]))
    )
    return Markup('<rect {} class="rim"/><rect {} class="box {}"/>').format(geometry, geometry, css)


def outline_layer(corners: Sequence[Corner], css: str, title: str) -> Markup:
    """A closed outline, such as a keep-out region."""
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)
    return Markup('<polygon points="{}" class="{}"><title>{}</title></polygon>').format(points, css, title)


def point_layer(point: Corner, radius: float, css: str, label: str = "") -> Markup:
    """A dot, with a number in it when there is one."""
    dot = Markup('<circle cx="{}" cy="{}" r="{}" class="dot {}"/>').format(
        f"{point[0]:.2f}", f"{point[1]:.2f}", f"{radius:.2f}", css
    )
    if not label:
        return dot
    return dot + text_in_svg(point[0], point[1] + radius * 0.42, label, "dot-label", radius * 1.25)


def cross_layer(point: Corner, reach: float, css: str) -> Markup:
    """A cross: where something is put down."""
    (x, y), r = point, reach
    path = f"M{x - r:.2f} {y - r:.2f}L{x + r:.2f} {y + r:.2f}M{x - r:.2f} {y + r:.2f}L{x + r:.2f} {y - r:.2f}"
    return Markup('<path d="{}" class="cross-rim"/><path d="{}" class="cross {}"/>').format(path, path, css)


def tag_size(text: str, size: float) -> tuple[float, float]:
    """Width and height of a label's plate."""
    return 0.68 * size * len(text) + 0.5 * size, 1.3 * size


def tag_layer(x: float, y: float, text: str, size: float, css: str) -> Markup:
    """A label on a plate; (x, y) is its lower left corner."""
    width, height = tag_size(text, size)
    return Markup(
        '<rect x="{}" y="{}" width="{}" height="{}" rx="{}" class="tag {}"/>'
    ).format(f"{x:.2f}", f"{y - height:.2f}", f"{width:.2f}", f"{height:.2f}", f"{0.2 * size:.2f}", css) + text_in_svg(
        x + width / 2, y - 0.32 * size, text, "tag-text", size
    )  # fmt: skip


def arrow_layer(points: Sequence[Corner], number: int, size: float) -> Markup:
    """A move through points, bowed when there are two, with a head at its end.

    Its number stands on its first part, so that of arrows that cross each has its own; beside a short one, which it would hide.
    """
    start, end = points[0], points[-1]
    middle: Corner = points[len(points) // 2]
    before, outward = points[-2], _outward(start, end)
    beside = 0.0 if len(points) == 2 and math.dist(start, end) > LONG * size else 1.25 * size
    if len(points) == 2:
        dx, dy = end[0] - start[0], end[1] - start[1]
        side = -1.0 if dx < 0 else 1.0
        before = ((start[0] + end[0]) / 2 + dy * 0.2 * side, (start[1] + end[1]) / 2 - dx * 0.2 * side)
        share = 0.5 if beside else NUMBER_AT
        a, b, c = (1 - share) ** 2, 2 * share * (1 - share), share**2
        middle = (a * start[0] + b * before[0] + c * end[0], a * start[1] + b * before[1] + c * end[1])
        path = f"M{start[0]:.2f} {start[1]:.2f}Q{before[0]:.2f} {before[1]:.2f} {end[0]:.2f} {end[1]:.2f}"
    else:
        path = "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in points)
    # A turn on the spot has no way that a head of full size could stand on.
    head = _head(before, end, min(1.1 * size, math.dist(start, end)) if len(points) == 2 else 1.1 * size)
    number_at = (middle[0] + beside * outward[0], middle[1] + beside * outward[1])
    return Markup(
        '<path d="{0}" class="arrow-rim"/><path d="{0}" class="arrow"/><path d="{1}" class="arrow-head"/>{2}'
    ).format(path, head, point_layer(number_at, 0.75 * size, "move", str(number)))


def turn_layer(at: Corner, clockwise_deg: float, size: float) -> Markup:
    """A turn where something is put down: an arc through its whole angle, with a head and its degrees."""
    arc = arc_points((at[0], at[1]), 2.2 * size, clockwise_deg)
    path = "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in arc)
    text = f"{abs(clockwise_deg):.0f}° {'clockwise' if clockwise_deg >= 0 else 'anticlockwise'}"
    return Markup(
        '<path d="{0}" class="arrow-rim"/><path d="{0}" class="arrow"/><path d="{1}" class="arrow-head"/>{2}'
    ).format(path, _head(arc[-2], arc[-1], 0.9 * size), tag_layer(at[0] + 2.6 * size, at[1], text, size, "turned"))


def _outward(start: Corner, end: Corner) -> Corner:
    """Across an arrow, on the side to which it bows: a number there covers neither the line nor its head."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length, side = math.hypot(dx, dy) or 1.0, -1.0 if dx < 0 else 1.0
    return (dy * side / length, -dx * side / length) if dx or dy else (1.0, 0.0)


def _head(before: Corner, end: Corner, length: float) -> str:
    angle = math.atan2(end[1] - before[1], end[0] - before[0])
    left, right = angle + math.pi - 0.45, angle + math.pi + 0.45
    return (
        f"M{end[0]:.2f} {end[1]:.2f}L{end[0] + length * math.cos(left):.2f} {end[1] + length * math.sin(left):.2f}"
        f"L{end[0] + length * math.cos(right):.2f} {end[1] + length * math.sin(right):.2f}Z"
    )


def window_round(
    boxes: Sequence[dict[str, float]], points: Sequence[Corner], size_px: Sequence[int]
) -> tuple[float, float, float, float]:
    """A 4:3 window round all boxes and points with room to see the neighbourhood, kept inside the view."""
    xs = [box[key] for box in boxes for key in ("x0", "x1")] + [point[0] for point in points]
    ys = [box[key] for box in boxes for key in ("y0", "y1")] + [point[1] for point in points]
    if not xs:
        return 0.0, 0.0, float(size_px[0]), float(size_px[1])
    least = 0.18 if boxes else 0.4  # a point alone needs its neighbourhood to be understood
    width = max((max(xs) - min(xs)) * 1.9, least * size_px[0])
    height = max((max(ys) - min(ys)) * 1.9, least * size_px[1])
    width, height = max(width, height * 4 / 3), max(height, width * 3 / 4)
    shrink = min(1.0, size_px[0] / width, size_px[1] / height)
    width, height = width * shrink, height * shrink
    x = min(max((max(xs) + min(xs) - width) / 2, 0.0), size_px[0] - width)
    y = min(max((max(ys) + min(ys) - height) / 2, 0.0), size_px[1] - height)
    return x, y, width, height


def mark_size(window: Sequence[Any]) -> float:
    """How large labels and dots are in a window [px of the view]."""
    return float(0.05 * math.sqrt(window[2] * window[3]))
