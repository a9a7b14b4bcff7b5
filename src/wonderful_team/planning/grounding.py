"""Coordinate-level grounding: every target at once, each through its own loop.

`paper`: proposals and a choice, a box, Checker and Mover, two rounds of points; for areas proposals and a choice.
`lean`: all boxes and points in one answer, one judgement per crop, and the paper's loop only for boxes that fail.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Algorithm 2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias

from wonderful_team.contracts import LocatePoints, Points, ReadScene, SceneReading
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import GroundedTarget, Provenance, Subgoal, Target
from wonderful_team.planning.boxes import Job, refine
from wonderful_team.planning.centres import choose, give_box, propose
from wonderful_team.planning.points import choose_points
from wonderful_team.planning.scene import SceneShown, plan_lines
from wonderful_team.planning.session import AgentSession
from wonderful_team.planning.together import together

Fate: TypeAlias = Literal["found", "absent", "gave_up"]
MOVED_SHARE = 0.15
"""When refining moved a box's centre by more than this share of its size, a point read with the old box is stale."""


def make_jobs(
    session: AgentSession, scene: SceneShown, targets: Sequence[Target], subgoals: Sequence[Subgoal]
) -> list[Job]:
    """One job per target."""
    lines = plan_lines(subgoals)
    return [
        Job(session, scene, target, number, lines, scene.examples([target])) for number, target in enumerate(targets)
    ]


async def ground_paper(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """All targets by the paper's loops, at once."""
    grounded = await together([_ground_one(job) for job in jobs])
    return _by_id(jobs, grounded)


async def _ground_one(job: Job) -> GroundedTarget:
    grounded = await (ground_area(job) if job.target.kind == "area" else ground_object(job))
    _remember(job, grounded)
    return grounded


async def ground_object(job: Job) -> GroundedTarget:
    """Centres, choice, box, Checker and Mover; fresh centres when a box is rejected."""
    best: Box | None = None
    for _ in range(1 + job.session.config.bounds.new_centres):
        proposals = await propose(job, "centre")
        if not proposals:
            return _end(job, "absent" if best is None else "gave_up", best)
        centre = await choose(job, proposals, "centre")
        if centre is None:
            job.avoid += proposals
            continue
        box = await give_box(job, centre)
        if box is None:
            job.avoid.append(centre)
            continue
        fate, box = await refine(job, box)
        if fate == "accepted":
            return _end(job, "found", box, await choose_points(job, box))
        if fate == "exhausted":
            best = box
        job.avoid.append(centre)
    return _end(job, "gave_up", best)


async def ground_area(job: Job) -> GroundedTarget:
    """Points proposed several times, and one chosen."""
    for _ in range(1 + job.session.config.bounds.new_centres):
        proposals = await propose(job, "place")
        if not proposals:
            return _end(job, "absent", None)
        point = await choose(job, proposals, "place")
        if point is not None:
            return _end(job, "found", None, {role: point for role in job.target.roles})
        job.avoid += proposals
    return _end(job, "gave_up", None)


async def read_scene(jobs: Sequence[Job]) -> tuple[SceneReading, Provenance]:
    """`lean`, first round: boxes and points of all targets in one answer."""
    session, scene = jobs[0].session, jobs[0].scene
    targets = tuple(job.target for job in jobs)
    view = scene.labelled if session.config.axes else scene.views[0]
    question = ReadScene(targets, jobs[0].plan, view, scene.views[1:], scene.examples(targets, session.config.axes))
    answer = await session.ask_whole(question, stage="ground")
    return answer.value, answer.provenance


async def settle_reading(
    jobs: Sequence[Job], reading: SceneReading, provenance: Provenance
) -> dict[str, GroundedTarget]:
    """`lean`, second round: judge every box that was read; those that fail go through the paper's loop."""
    grounded = await together([_settle_one(job, reading, provenance) for job in jobs])
    return _by_id(jobs, grounded)


async def _settle_one(job: Job, reading: SceneReading, provenance: Provenance) -> GroundedTarget:
    item = next(entry for entry in reading.targets if entry.id == job.target.id)
    if not item.found or item.box is None:
        job.tell("absent", "the Manager says it is not in the picture", provenance=provenance)
        return _end(job, "absent", None)
    frame = job.scene.views[0].frame
    first = frame.box_to_view(item.box.as_box)
    points: dict[str, Point] = {entry.role: frame.point_to_view(entry.point.as_tuple) for entry in item.points}
    job.tell("box", "Manager's first box and points", first, tuple(points.values()), provenance)
    fate, box = await refine(job, first)
    if fate != "accepted":
        job.avoid.append(first.centre)
        return await _ground_one(job)
    if _moved(first, box) or not all(_near(box, point) for point in points.values()):
        points = await choose_points(job, box)
    grounded = _end(job, "found", box, points)
    _remember(job, grounded)
    return grounded


async def ground_by_supervisor(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """Grounding team switched off: the Supervisor gives one point per target on the labelled view."""

    async def one(job: Job) -> GroundedTarget:
        view = job.scene.labelled
        question = LocatePoints(job.target, "centre", job.plan, view, job.scene.views[1:], job.examples, count=1)
        answer: Points = await job.session.ask(question, stage="ground", branch=job.target.id, role="supervisor")
        if not answer.points:
            job.tell("absent", "the Supervisor says it is not in the picture")
            return _end(job, "absent", None)
        point = view.frame.point_to_view(answer.points[0].as_tuple)
        job.tell("point", "the Supervisor's point", points=(point,))
        return _end(job, "found", None, {role: point for role in job.target.roles})

    return _by_id(jobs, await together([one(job) for job in jobs]))


def _end(job: Job, status: Fate, box: Box | None, points: Mapping[str, Point] | None = None) -> GroundedTarget:
    return GroundedTarget(job.target, status, job.scene.view.id, box, points or {}, tuple(job.history))


def _remember(job: Job, grounded: GroundedTarget) -> None:
    said = job.history[-1].text if job.history else ""
    job.session.remember(
        "manager",
        "ground",
        f"Where is {job.target.id}: {job.target.words}?",
        f"{job.target.id} {grounded.status}: {said}",
        target=job.number,
        branch=job.target.id,
    )


def _by_id(jobs: Sequence[Job], grounded: Sequence[GroundedTarget]) -> dict[str, GroundedTarget]:
    return {job.target.id: item for job, item in zip(jobs, grounded, strict=True)}


def _moved(first: Box, box: Box) -> bool:
    (x0, y0), (x1, y1) = first.centre, box.centre
    return abs(x1 - x0) > MOVED_SHARE * box.width or abs(y1 - y0) > MOVED_SHARE * box.height


def _near(box: Box, point: Point) -> bool:
    """Whether a point lies in the box or close beside it (push points lie beside)."""
    return box.scaled(2.0).contains(point)
