"""Action points: chosen among numbered candidates inside and beside a box, once coarse and once fine."""

from __future__ import annotations

from wonderful_team.contracts import ChoosePoint, PointChoice
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Candidates, Picture, Point
from wonderful_team.core.values import PointRole
from wonderful_team.images import beside_points, crop, inside_points
from wonderful_team.planning.boxes import Job
from wonderful_team.planning.together import together

GRID = 3
"""Candidates per side of the box in each round (nine inside)."""
BESIDE_SHARE = 0.25
"""How far beside a box push candidates lie, as a share of its longer side."""
FINE_SHARE = 1.0 / GRID
"""Side of the second round's neighbourhood, as a share of the box: one cell of the first grid."""
FINE_MARGIN = 0.15
FINE_SIDE_PX = 640
"""The second round shows the box closer, so that its nine candidates stand apart."""

MARK_SHARE = 0.015
"""A numbered mark reaches this far from its point, as a share of the picture's longer side."""


async def choose_points(job: Job, box: Box) -> dict[str, Point]:
    """The point for each role of the target, in view pixels; roles are asked at once."""
    roles = job.target.roles
    points = await together([_choose(job, box, role) for role in roles])
    return dict(zip(roles, points, strict=True))


async def _choose(job: Job, box: Box, role: PointRole) -> Point:
    shown = crop(job.scene.view, box, "crop")
    shown_box = shown.frame.box_to_picture(box)
    candidates = inside_points(shown_box, GRID, GRID)
    if role in ("push_start", "push_end"):
        beside = beside_points(shown_box, BESIDE_SHARE * max(shown_box.width, shown_box.height))
        candidates = (*candidates, *_whole_marks(shown, beside))
    coarse = await _ask(job, shown, shown_box, candidates, role, fine=False)
    cell = Box.around(coarse, box.width * FINE_SHARE, box.height * FINE_SHARE)
    near = crop(
        job.scene.view,
        box,
        "crop",
        margin=FINE_MARGIN,
        min_side_px=FINE_SIDE_PX,
        also=(cell.scaled(1 + 2 * FINE_MARGIN),),
    )
    fine_points = _whole_marks(near, inside_points(near.frame.box_to_picture(cell), GRID, GRID))
    chosen = await _ask(job, near, near.frame.box_to_picture(box), fine_points, role, fine=True)
    job.tell("point", f"{role.replace('_', ' ')} point chosen", box, (chosen,))
    return chosen


def _whole_marks(shown: Picture, points: tuple[Point, ...]) -> tuple[Point, ...]:
    """The points that lie so far inside the view that their marks are not cut off; those inside it where none does."""
    room = MARK_SHARE * max(shown.size_px)
    valid = shown.frame.valid
    inside = tuple(point for point in points if valid.contains(point))
    return tuple(point for point in inside if valid.grown(-room, -room, -room, -room).contains(point)) or inside


async def _ask(
    job: Job, shown: Picture, shown_box: Box, candidates: tuple[Point, ...], role: PointRole, *, fine: bool
) -> Point:
    marked = shown.marked(job.view_axes, BoxMark(shown_box), Candidates(candidates))
    choice: PointChoice = await job.session.ask(
        ChoosePoint(job.target, role, job.plan, marked, fine, job.examples), stage="ground", branch=job.target.id
    )
    return shown.frame.point_to_view(candidates[choice.number - 1])
