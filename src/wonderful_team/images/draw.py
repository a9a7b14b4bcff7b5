"""Draws the marks of a picture, for models and people that look at pixels. The picture itself is left alone."""

from __future__ import annotations

import math
from collections.abc import Sequence

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import (
    Axes,
    BoxMark,
    BoxStyle,
    Candidates,
    LineMark,
    PathMark,
    Picture,
    Point,
    PointMark,
    Tiles,
    TurnMark,
)
from wonderful_team.images.axes import Ticks, draw_axes
from wonderful_team.images.canvas import (
    BLUE,
    GREEN,
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
from wonderful_team.images.turn_marks import draw_turn, number_tiles

BOX_COLOURS: dict[BoxStyle, Colour] = {
    "target": ORANGE,
    "before": SKY,
    "after": ORANGE,
    "keep_out": VERMILLION,
    "workspace": WHITE,
}
"""Colour of each box style; before, keep_out and workspace are dashed as well, so colour never carries meaning alone."""
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
    boxes = [mark for mark in picture.marks if isinstance(mark, BoxMark)]
    lines = [mark for mark in picture.marks if isinstance(mark, LineMark)]
    paths = [mark for mark in picture.marks if isinstance(mark, PathMark)]
    points = [mark for mark in picture.marks if isinstance(mark, PointMark)]
    choices = [mark for mark in picture.marks if isinstance(mark, Candidates)]
    for box in sorted(boxes, key=lambda mark: mark.style not in ("workspace", "keep_out")):
        draw_box(canvas, box.box.corners, box.style)
    for line in lines:
        draw_line(canvas, line.start, line.end)
    for path in paths:
        draw_strip(canvas, path.points, path.width)
        draw_path(canvas, path.points)
    turned = [label for mark in picture.marks if isinstance(mark, TurnMark) for label in draw_turn(canvas, mark)]
    radius, reach = candidate_radius(canvas), point_reach(canvas)
    numbered = [(point, str(k)) for choice in choices for k, point in enumerate(choice.points, start=1)]
    for point, _ in numbered:
        canvas.keep_clear(point, radius - 1)
    for mark in points:
        canvas.keep_clear(mark.point, reach * 0.8)
    canvas.named += [point for point, _ in numbered] + [mark.point for mark in points]
    for axes in (mark for mark in picture.marks if isinstance(mark, Axes)):
        draw_axes(canvas, picture.frame, axes, ticks)
    labels = [PointLabel(point, text, radius, BLUE) for point, text in numbered]
    labels += [PointLabel(mark.point, plain(mark.label), reach * 0.8, INK) for mark in points if mark.label]
    labels += [
        PointLabel(path.points[len(path.points) // 2], plain(path.label), canvas.stroke_px * 1.5, GREEN)
        for path in paths
        if path.label and path.points
    ]
    placed = label_points(canvas, [*labels, *turned])
    for point, _ in numbered:
        canvas.disc(point, radius, BLUE, WHITE)
    for mark in points:
        canvas.cross(mark.point, reach, WHITE)
    paint_plates(canvas, placed)
    for box in boxes:
        if box.label:
            label_box(canvas, box.box, plain(box.label), back=BOX_COLOURS[box.style])
    number_tiles(canvas, [box for mark in picture.marks if isinstance(mark, Tiles) for box in mark.boxes])
    return canvas.rgb


def line_width_px(picture: Picture) -> int:
    """How wide a box's line is drawn on a picture [px of it]."""
    return Canvas.over(picture.rgb).stroke_px


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
        canvas.polyline(held, stroke, closed=True)


def draw_line(canvas: Canvas, start: Point, end: Point) -> None:
    """A straight line; along the picture's border it is moved inside by half its width, so that it shows."""
    canvas.polyline([_on_picture(canvas, start), _on_picture(canvas, end)], YELLOW)


def draw_strip(canvas: Canvas, points: Sequence[Point], width: float, colour: Colour = GREEN) -> None:
    """What a tool of this width sweeps from the first point straight to the last [px]: tinted, its edge dashed."""
    if width <= 0 or len(points) < 2 or math.dist(points[0], points[-1]) < 1e-6:
        return
    (xa, ya), (xb, yb) = points[0], points[-1]
    length = math.dist(points[0], points[-1])
    ox, oy = -(yb - ya) / length * width / 2, (xb - xa) / length * width / 2
    corners = [(xa + ox, ya + oy), (xb + ox, yb + oy), (xb - ox, yb - oy), (xa - ox, ya - oy)]
    canvas.polygon(corners, colour, 0.3)
    canvas.dashes(corners, colour, width_px=max(1, canvas.stroke_px - 1))


def draw_path(canvas: Canvas, points: Sequence[Point], colour: Colour = GREEN) -> None:
    """A path with small dots at its inner points and an arrow head at its end."""
    if not points:
        return
    if len(points) == 1:
        canvas.disc(points[0], canvas.stroke_px * 1.6, colour, WHITE)
        return
    canvas.polyline(points, colour, width_px=canvas.stroke_px + 1, halo=WHITE)
    for point in points:
        canvas.keep_clear(point, canvas.stroke_px * 2.0)
    for point in points[:-1]:
        canvas.disc(point, canvas.stroke_px * 1.4, colour, WHITE)
    canvas.arrow_head(points[-2], points[-1], colour, 6.0 * canvas.stroke_px)


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
