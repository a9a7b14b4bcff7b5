"""How turns are drawn: an arc with its degrees and the turned outline; the numbers of turned cut-outs; and grids of tiles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from wonderful_team.core.actions import PickPlaceStep
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Grid, Point, TurnMark
from wonderful_team.core.values import GroundedTarget, PlannedAction, View
from wonderful_team.images.canvas import INK, PURPLE, WHITE, Canvas
from wonderful_team.images.lettering import plain
from wonderful_team.images.placing import PointLabel

ARC_STEP_DEG = 6.0
FROM_TO = 2
"""Numbers of an action that goes from one place to another."""
SAME_SCALE, SQUARE = 1.25, 0.95
"""A view from above stretches the table one way by at most this, and its sides are square but for this sine."""
STAYS = 0.5
"""A thing that is turned and moved by less than this share of its shorter side is turned where it lies."""
LEAST_RADIUS = 14.0
"""Of an arc, in the canvas's unit: a smaller one cannot be read."""


def draw_turn(canvas: Canvas, mark: TurnMark) -> list[PointLabel]:
    """The outline as it comes to lie, and an arc through the whole turn; returns its plate, to be placed.

    The arc begins above the centre and goes the way of the turn, so that a quarter looks like a quarter.
    """
    canvas.dashes(mark.corners, PURPLE, halo=WHITE)
    radius = max(LEAST_RADIUS * canvas.unit, 0.36 * min(_sides(mark.corners)))
    arc = arc_points(mark.centre, radius, mark.clockwise_deg)
    canvas.lines([[mark.centre, arc[0]]], PURPLE, width_px=max(1, canvas.stroke_px - 1), halo=WHITE)
    canvas.polyline(arc, PURPLE, width_px=canvas.stroke_px, halo=WHITE)
    canvas.arrow_head(arc[-2], arc[-1], PURPLE, 5.0 * canvas.stroke_px)
    # The plate stands beside the thing: what is turned has to be seen.
    canvas.taken.append(Box.bounding(mark.corners).as_tuple)
    way = "clockwise" if mark.clockwise_deg >= 0 else "anticlockwise"
    step = f"{plain(mark.label)}: " if mark.label else ""
    return [PointLabel(mark.centre, f"{step}{abs(mark.clockwise_deg):.0f}° {way}", radius, PURPLE, INK)]


def action_turns(
    actions: Iterable[PlannedAction], grounded: Mapping[str, GroundedTarget], view: View | None = None
) -> tuple[TurnMark, ...]:
    """Every turn of a thing that is carried, where it comes to lie [view px]; labelled by the number of its step.

    None for a view at a slant, in which a turned box is no turned box.
    """
    if view is not None and not seen_from_above(view):
        return ()
    marks, sums = [], dict[str, float]()
    for number, action in enumerate(actions, start=1):
        step = action.step
        if not isinstance(step, PickPlaceStep) or not step.rotate_deg or len(action.sources) < FROM_TO:
            continue
        item = grounded.get(step.pick)
        if item is None or item.box is None:
            continue
        # What was turned before is turned by both.
        sums[step.pick] = turn = sums.get(step.pick, 0.0) + step.rotate_deg
        # The place of an action is where the thing's middle lands.
        put = action.sources[-1].point_px
        corners = tuple(_turned(corner, item.box.centre, put, turn) for corner in item.box.corners)
        marks.append(TurnMark(put, corners, step.rotate_deg, str(number)))
    return tuple(marks)


def stays(path: Sequence[Point], turn: TurnMark) -> bool:
    """Whether a path goes nowhere beside the size of what is turned: the tool then only follows the turn."""
    return math.dist(path[0], path[-1]) < STAYS * min(_sides(turn.corners))


def _turned(point: Point, middle: Point, put: Point, clockwise_deg: float) -> Point:
    """Where a point of a thing ends that is turned about its middle, which ends at `put`."""
    c, s = math.cos(math.radians(clockwise_deg)), math.sin(math.radians(clockwise_deg))
    dx, dy = point[0] - middle[0], point[1] - middle[1]
    return put[0] + c * dx - s * dy, put[1] + s * dx + c * dy


def seen_from_above(view: View) -> bool:
    """Whether a turn on the table is a turn in the picture, the same way round; taken for granted without a camera."""
    if view.camera is None:
        return True
    x, y = view.size_px[0] / 2, view.size_px[1] / 2
    try:
        middle, right, down = view.camera.on_plane([(x, y), (x + 10, y), (x, y + 10)], 0.0)[:, :2]
    except ValueError:
        return False
    across, along = right - middle, down - middle
    one, two = math.hypot(*across), math.hypot(*along)
    turn = float(across[0] * along[1] - across[1] * along[0])
    return turn < -SQUARE * one * two and max(one, two) <= SAME_SCALE * min(one, two)


def arc_points(centre: Point, radius: float, clockwise_deg: float) -> list[Point]:
    """Points along the arc of a turn, from above the centre on; at least two."""
    count = max(2, round(abs(clockwise_deg) / ARC_STEP_DEG) + 1)
    angles = [math.radians(clockwise_deg * k / (count - 1)) for k in range(count)]
    return [(centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle)) for angle in angles]


def _sides(corners: Sequence[Point]) -> list[float]:
    return [math.dist(one, two) for one, two in zip(corners, (*corners[1:], corners[0]), strict=True)]


def number_tiles(canvas: Canvas, boxes: Sequence[Box]) -> None:
    """The number of each tile on a plate above its top-left corner."""
    for number, box in enumerate(boxes, start=1):
        height = canvas.plate_size(str(number))[1]
        canvas.plate(str(number), round(box.x0), max(0, round(box.y0) - height - 1))


def draw_grid(canvas: Canvas, grid: Grid) -> None:
    """Thin lines between the tiles, and the name of each in its upper left corner, small: what is shown stays seen."""
    width, height = canvas.size_px
    lines = [
        ((width * k / grid.columns, 0.0), (width * k / grid.columns, float(height))) for k in range(1, grid.columns)
    ]
    lines += [((0.0, height * k / grid.rows), (float(width), height * k / grid.rows)) for k in range(1, grid.rows)]
    for line in lines:
        canvas.dashes(line, WHITE, width_px=1, halo=INK)
    for name in grid.names:
        tile = grid.tile(name, canvas.size_px)
        canvas.plate(name, round(tile.x0) + 2, round(tile.y0) + 2)
