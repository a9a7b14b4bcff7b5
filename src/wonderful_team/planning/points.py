"""Action points: chosen among numbered candidates inside and beside a box, once coarse and once fine.

In `lean` the fine round is left out where the coarse point is central on a compact shape.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from wonderful_team.contracts import ChoosePoint, PointChoice
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Candidates, PathMark, Picture, Point
from wonderful_team.core.together import together
from wonderful_team.core.values import PointRole
from wonderful_team.images import beside_points, crop, inside_points
from wonderful_team.planning.jobs import Job
from wonderful_team.planning.judged import said_of
from wonderful_team.planning.spending import is_central

GRID = 3
"""Candidates per side of the box in each round (nine inside)."""
BESIDE_SHARE = 0.25
"""How far beside a box push candidates lie, as a share of its longer side."""
FINE_SHARE = 1.0 / GRID
"""Side of the second round's neighbourhood, as a share of the box: one cell of the first grid."""
FINE_MARGIN = 0.15
FINE_SIDE_PX = 640
"""The second round shows the box closer, so that its nine candidates stand apart."""
PUSHES: tuple[PointRole, ...] = ("push_start", "push_end")
ONWARD = "on to where it goes"
"""What the arrow says that points from a box to where the thing is pushed."""

MARK_SHARE = 0.015
"""A numbered mark reaches this far from its point, as a share of the picture's longer side."""


async def choose_points(job: Job, box: Box, roles: Sequence[PointRole] = ()) -> dict[PointRole, Point]:
    """The point for each of these roles (all of the target when none is named), in view pixels; asked at once."""
    # The box is settled: what was tried before is stale.
    job.session.notebooks.forget(job.target.id)
    asked = tuple(roles) or job.target.roles
    points = await together([_choose(job, box, role) for role in asked])
    return dict(zip(asked, points, strict=True))


async def _choose(job: Job, box: Box, role: PointRole) -> Point:
    shown = crop(job.scene.view, box, "crop")
    shown_box = shown.frame.box_to_picture(box)
    candidates = inside_points(shown_box, GRID, GRID)
    if role in PUSHES:
        beside = beside_points(shown_box, BESIDE_SHARE * max(shown_box.width, shown_box.height))
        candidates = (*candidates, *_whole_marks(shown, beside))
    coarse = await _ask(job, shown, box, candidates, role, fine=False)
    if job.session.config.sparing and role in ("pick", "grasp", "place") and is_central(coarse, box):
        job.session.skip("ChoosePoint", "no second round: central on a compact shape", f"{job.target.id} {role}")
        job.tell("point", f"{said_of(role)} point chosen", box, (coarse,))
        return coarse
    cell = Box.around(coarse, box.width * FINE_SHARE, box.height * FINE_SHARE)
    # The point may lie beside the box: the window holds its neighbourhood as well.
    also = (cell.scaled(1 + 2 * FINE_MARGIN),)
    near = crop(job.scene.view, box, "crop", margin=FINE_MARGIN, min_side_px=FINE_SIDE_PX, also=also)
    fine_points = _whole_marks(near, inside_points(near.frame.box_to_picture(cell), GRID, GRID))
    chosen = await _ask(job, near, box, fine_points, role, fine=True)
    job.tell("point", f"{said_of(role)} point chosen", box, (chosen,))
    return chosen


def _whole_marks(shown: Picture, points: tuple[Point, ...]) -> tuple[Point, ...]:
    """The points that lie so far inside the view that their marks are not cut off; those inside it where none does."""
    room = MARK_SHARE * max(shown.size_px)
    valid = shown.frame.valid
    inside = tuple(point for point in points if valid.contains(point))
    return tuple(point for point in inside if valid.grown(-room, -room, -room, -room).contains(point)) or inside


async def _ask(
    job: Job, shown: Picture, box: Box, candidates: tuple[Point, ...], role: PointRole, *, fine: bool
) -> Point:
    boxed = shown.marked(job.view_axes, *_box_marks(job, shown, box, role), Candidates(candidates))
    marked, said = job.with_rejected(boxed)
    whole = None
    if role in PUSHES and not fine:
        # A crop of the thing alone cannot say from which side it has to be pushed.
        whole = job.scene.views[0].marked(*_box_marks(job, job.scene.views[0], box, role, whole=True))
    question = ChoosePoint(job.target, role, job.plan, marked, fine, job.examples, said, whole, job.instruction)
    choice: PointChoice = await job.session.ask(question, stage="ground", branch=job.target.id)
    return shown.frame.point_to_view(candidates[choice.number - 1])


def _box_marks(job: Job, shown: Picture, box: Box, role: PointRole, *, whole: bool = False) -> list[BoxMark | PathMark]:
    """The box, and for a push the arrow to where the thing goes; on a crop as far as the crop reaches."""
    marks: list[BoxMark | PathMark] = [
        BoxMark(shown.frame.box_to_picture(box), "target", job.target.id if whole else "")
    ]
    if role != "push_start" or job.towards is None:
        return marks
    start, end = box.centre, job.towards
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    if length == 0 or box.contains(end):
        return marks
    ahead = ((end[0] - start[0]) / length, (end[1] - start[1]) / length)
    first = _on_edge(box, ahead)
    if not whole:
        # From the box's edge on, so that the thing itself stays free, to just inside the picture's.
        seen = shown.frame.box_to_view(shown.frame.valid)
        last = _on_edge(Box(seen.x0, seen.y0, seen.x1, seen.y1).scaled(0.94), ahead, start)
        end = last if math.dist(start, last) < length else end
    path = (shown.frame.point_to_picture(first), shown.frame.point_to_picture(end))
    return [*marks, PathMark(path, "" if whole else ONWARD)]


def _on_edge(box: Box, ahead: Point, start: Point | None = None) -> Point:
    """Where a ray from `start` (the middle of the box when left out) leaves a box."""
    x, y = start or box.centre
    ways = [
        ((box.x1 if ahead[0] > 0 else box.x0) - x) / ahead[0] if ahead[0] else math.inf,
        ((box.y1 if ahead[1] > 0 else box.y0) - y) / ahead[1] if ahead[1] else math.inf,
    ]
    far = max(0.0, min(ways))
    return x + far * ahead[0], y + far * ahead[1]
