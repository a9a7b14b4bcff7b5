"""Action points: chosen among numbered candidates inside and beside a box, once coarse and once fine.

In `lean` the fine round is left out where the coarse point is central on a compact shape.
"""

from __future__ import annotations

from wonderful_team.contracts import ChoosePoint, PointChoice
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Candidates, Picture, Point
from wonderful_team.core.values import PointRole
from wonderful_team.images import beside_points, crop, inside_points
from wonderful_team.planning.boxes import Job
from wonderful_team.planning.spending import is_central
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


async def choose_points(job: Job, box: Box) -> dict[str, Point]:
    """The point for each role of the target, in view pixels; roles are asked at once."""
    # The box is settled: what was tried before is stale.
    job.session.notebooks.forget(job.target.id)
    roles = job.target.roles
    points = await together([_choose(job, box, role) for role in roles])
    return dict(zip(roles, points, strict=True))


async def _choose(job: Job, box: Box, role: PointRole) -> Point:
    shown = crop(job.scene.view, box, "crop")
    shown_box = shown.frame.box_to_picture(box)
    candidates = inside_points(shown_box, GRID, GRID)
    if role in ("push_start", "push_end"):
        beside = beside_points(shown_box, BESIDE_SHARE * max(shown_box.width, shown_box.height))
        candidates = (*candidates, *(point for point in beside if shown.frame.valid.contains(point)))
    coarse = await _ask(job, shown, shown_box, candidates, role, fine=False)
    if job.session.config.sparing and role in ("pick", "grasp", "place") and is_central(coarse, box):
        job.session.skip("ChoosePoint", "no second round: central on a compact shape", f"{job.target.id} {role}")
        job.tell("point", f"{role.replace('_', ' ')} point chosen", box, (coarse,))
        return coarse
    cell = Box.around(coarse, box.width * FINE_SHARE, box.height * FINE_SHARE)
    near = crop(job.scene.view, box, "crop", margin=FINE_MARGIN, min_side_px=FINE_SIDE_PX)
    fine_points = tuple(
        point
        for point in inside_points(near.frame.box_to_picture(cell), GRID, GRID)
        if near.frame.valid.contains(point)
    )
    chosen = await _ask(job, near, near.frame.box_to_picture(box), fine_points, role, fine=True)
    job.tell("point", f"{role.replace('_', ' ')} point chosen", box, (chosen,))
    return chosen


async def _ask(
    job: Job, shown: Picture, shown_box: Box, candidates: tuple[Point, ...], role: PointRole, *, fine: bool
) -> Point:
    marked = shown.marked(job.view_axes, BoxMark(shown_box), Candidates(candidates))
    choice: PointChoice = await job.session.ask(
        ChoosePoint(job.target, role, job.plan, marked, fine, job.examples), stage="ground", branch=job.target.id
    )
    return shown.frame.point_to_view(candidates[choice.number - 1])
