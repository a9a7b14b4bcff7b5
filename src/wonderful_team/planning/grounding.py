"""Coordinate-level grounding: every target at once, each through its own loop.

`paper`: proposals and a choice, a box, Checker and Mover, two rounds of points; for areas proposals and a choice.
`lean`: all boxes and points in one answer, one judgement per crop, and the paper's loop only for boxes that fail.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Algorithm 2.
"""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.agents.scene import SceneShown, plan_lines
from wonderful_team.contracts import SceneReading, SceneTarget
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.together import batches, both, together
from wonderful_team.core.values import Critique, GroundedTarget, PointRole, Provenance, Subgoal, Target
from wonderful_team.planning.boxes import BoxFate, judge_together, refine
from wonderful_team.planning.centres import choose, give_box, propose
from wonderful_team.planning.jobs import ENDS, Job, read_scene
from wonderful_team.planning.judged import said_of
from wonderful_team.planning.notes import one_line
from wonderful_team.planning.points import choose_points
from wonderful_team.planning.replaced import ground_again_otherwise, ground_otherwise
from wonderful_team.planning.session import AgentSession
from wonderful_team.planning.spending import target_reason

REFUSED = ("Checker: reject", "not settled")
"""How the lines of a target's story begin that tell of a box that was given up."""
MOVED_SHARE = 0.15
"""When refining moved a box's centre by more than this share of its size, a point read with the old box is stale."""


def make_jobs(
    session: AgentSession, scene: SceneShown, targets: Sequence[Target], subgoals: Sequence[Subgoal]
) -> list[Job]:
    """One job per target."""
    lines, accepted = plan_lines(subgoals), dict[str, tuple[Target, Box]]()
    return [
        Job(
            session,
            scene,
            target,
            number,
            lines,
            scene.examples([target]),
            _goal_of(target, targets, subgoals),
            accepted,
            outlined=any(subgoal.function is not None and target.id in subgoal.targets for subgoal in subgoals),
        )
        for number, target in enumerate(targets)
    ]


def _goal_of(target: Target, targets: Sequence[Target], subgoals: Sequence[Subgoal]) -> str | None:
    """Where a target is pushed to: what the same subgoal ends at."""
    if "push_start" not in target.roles:
        return None
    beside = {name for subgoal in subgoals if target.id in subgoal.targets for name in subgoal.targets} - {target.id}
    return next((one.id for one in targets if one.id in beside and set(one.roles) & set(ENDS)), None)


async def ground_paper(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """All targets by the paper's loops, at once."""
    grounded = await together([_ground_one(job) for job in jobs])
    return _by_id(jobs, grounded)


async def _ground_one(job: Job) -> GroundedTarget:
    points_alone = job.target.kind == "area" and not job.outlined
    grounded = await (ground_area(job) if points_alone else ground_object(job))
    _remember(job, grounded)
    return grounded


async def ground_object(job: Job) -> GroundedTarget:
    """Centres, choice, box, Checker and Mover; fresh centres when a box is rejected."""
    best: Box | None = None
    for _ in range(1 + job.session.config.bounds.new_centres):
        proposals = await propose(job, "centre")
        if not proposals:
            return job.end("absent" if best is None else "gave_up", best)
        centre = await choose(job, proposals, "centre")
        if centre is None:
            job.reject(proposals, "it is not on the target")
            continue
        box = await give_box(job, centre)
        if box is None:
            job.reject([centre], "nothing was found at it")
            continue
        fate, box = await refine(job, box)
        if fate == "accepted":
            return job.end("found", box, await choose_points(job, box))
        if fate == "exhausted":
            best = box
        job.reject([centre], rejection(job, fate))
    return job.end("gave_up", best)


async def ground_area(job: Job) -> GroundedTarget:
    """Points proposed several times, and one chosen."""
    for _ in range(1 + job.session.config.bounds.new_centres):
        proposals = await propose(job, "place")
        if not proposals:
            return job.end("absent", None)
        point = await choose(job, proposals, "place")
        if point is not None:
            return job.end("found", None, {role: point for role in job.target.roles})
        job.reject(proposals, "it is not a suitable place")
    return job.end("gave_up", None)


async def ground(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """All targets, by whoever says where they are."""
    config = jobs[0].session.config
    if config.grounded_by != "team":
        return await ground_otherwise(jobs)
    return await (settle_reading(jobs, *await read_scene(jobs)) if config.mode == "lean" else ground_paper(jobs))


def rejection(job: Job, fate: BoxFate) -> str:
    """Why the box at a centre was given up, as the Manager is told."""
    said = f": {job.problem}" if job.problem else ""
    return f"the Checker refused the box there{said}" if fate == "rejected" else f"no box there became right{said}"


async def settle_reading(
    jobs: Sequence[Job], reading: SceneReading, provenance: Provenance
) -> dict[str, GroundedTarget]:
    """`lean`, second round: judge every box that was read; those that fail go through the paper's loop.

    Plain targets are judged in one question, each of the others by itself.
    """
    for job in jobs:
        _note_reading(job, reading)
    plain = _plain(jobs, reading)
    if len(plain) < 2:
        plain = []
    alone = [job for job in jobs if job not in plain]

    async def together_first() -> list[GroundedTarget]:
        if plain:
            session = plain[0].session
            fit = session.client.picture_limit("checker")
            # A model of one picture sees them on a sheet, however many they are.
            most = min(session.config.bounds.targets, fit if fit is not None and fit > 1 else len(plain))
            await together([judge_together(part) for part in batches(plain, most)])
            named = ", ".join(job.target.id for job in plain)
            plain[0].session.skip(
                "JudgeBox", f"{named} {'in one question' if len(plain) <= most else f'up to {most} in one question'}"
            )
        return await together([_settle_one(job, provenance) for job in plain])

    async def one_by_one() -> list[GroundedTarget]:
        return await together([_settle_one(job, provenance) for job in alone])

    judged, others = await both(together_first(), one_by_one())
    found = {item.target.id: item for item in (*judged, *others)}
    return {job.target.id: found[job.target.id] for job in jobs}


def _plain(jobs: Sequence[Job], reading: SceneReading) -> list[Job]:
    """The jobs whose boxes can be judged together: found, and nothing about them in doubt."""
    session = jobs[0].session
    if not (session.config.sparing and session.members.checker):
        return []
    size = jobs[0].scene.view.size_px
    return [
        job
        for job in jobs
        if job.first_box is not None and not target_reason(job.target, _read_of(job, reading), job.first_box, size)
    ]


def _read_of(job: Job, reading: SceneReading) -> SceneTarget:
    return next(entry for entry in reading.targets if entry.id == job.target.id)


def _note_reading(job: Job, reading: SceneReading) -> None:
    """What was read of a target, and of what it is pushed to, in view pixels."""
    item, frame = _read_of(job, reading), job.scene.views[0].frame
    goal = next((entry for entry in reading.targets if entry.id == job.goal), None)
    ends = [entry.point for entry in goal.points if entry.role in ENDS] if goal is not None else []
    job.towards = frame.point_to_view(ends[0].as_tuple) if ends else None
    job.unsure = item.unsure
    if item.found and item.box is not None:
        job.first_box = frame.box_to_view(item.box.as_box)
        job.first_points = {entry.role: frame.point_to_view(entry.point.as_tuple) for entry in item.points}


async def _settle_one(job: Job, provenance: Provenance) -> GroundedTarget:
    if job.first_box is None:
        job.tell("absent", "the Manager says it is not in the picture", provenance=provenance)
        return job.end("absent", None)
    first, points = job.first_box, dict(job.first_points)
    job.tell("box", "Manager's first box and points", first, tuple(points.values()), provenance)
    fate, box = await refine(job, first, points)
    if fate != "accepted":
        job.reject([first.centre], rejection(job, fate))
        return await _ground_one(job)
    stale = [role for role, point in points.items() if _moved(first, box) or not _near(box, role, point)]
    for wrong in job.wrong_points:
        job.reject([points[wrong.use]], f"as the {said_of(wrong.use)} point, by the Checker: {wrong.why}")
    again = [role for role in points if role in stale or role in {wrong.use for wrong in job.wrong_points}]
    if again:
        points |= await choose_points(job, box, again)
    grounded = job.end("found", box, points)
    _remember(job, grounded)
    return grounded


async def ground_again(job: Job, before: GroundedTarget, doubt: Critique) -> GroundedTarget:
    """A target whose point or box Verification doubts: the point is chosen anew in its box, or the target looked for anew.

    What was doubted is marked as rejected, and the Manager is told what was said of it.

    Args:
        job: The target's, with its story so far.
        before: Where it was found.
        doubt: Of kind wrong_point or wrong_box.
    """
    points = tuple(before.points.values())
    what = "point" if doubt.kind == "wrong_point" else "box"
    job.tell("verdict", f"Verification: reject the {what} - {doubt.question}", before.box, points, doubt.provenance)
    in_box = before.box is not None and job.session.members.manager and doubt.kind == "wrong_point"
    centre = () if before.box is None else (before.box.centre,)
    job.reject(points if doubt.kind == "wrong_point" else centre or points, f"by Verification: {doubt.question}")
    if job.session.config.grounded_by != "team":
        return await ground_again_otherwise(job)
    if in_box and before.box is not None:
        return job.end("found", before.box, await choose_points(job, before.box))
    return await _ground_one(job)


def _remember(job: Job, grounded: GroundedTarget) -> None:
    """Let Memory keep what the plan does not show of a target: what was taken for it and rejected, and which look-alike it is."""
    refused = [event.text for event in job.history if event.what == "verdict" and event.text.startswith(REFUSED)]
    if not job.session.members.checker:
        # Nobody has refused anything: the last box stands.
        refused = []
    if not refused and not (job.unsure and grounded.status == "found"):
        return
    where = f" ({job.target.where})" if job.target.where else ""
    story = [*refused, *([f"It was not clear which one it is: {job.unsure}"] if job.unsure else [])]
    end = {"found": "found", "absent": "not in the picture", "gave_up": "given up"}[grounded.status]
    job.session.remember(
        "manager",
        "ground",
        f"Which thing is {job.target.id}, {job.target.words}{where}?",
        one_line(f"{'; '.join(story)}. In the end: {end}."),
        target=job.number,
        branch=job.target.id,
    )


def _by_id(jobs: Sequence[Job], grounded: Sequence[GroundedTarget]) -> dict[str, GroundedTarget]:
    return {job.target.id: item for job, item in zip(jobs, grounded, strict=True)}


def _moved(first: Box, box: Box) -> bool:
    (x0, y0), (x1, y1) = first.centre, box.centre
    return abs(x1 - x0) > MOVED_SHARE * box.width or abs(y1 - y0) > MOVED_SHARE * box.height


def _near(box: Box, role: PointRole, point: Point) -> bool:
    """Whether a point goes with a box: it lies in it or close beside it; a push begins beside it and may end anywhere."""
    reach = max(box.width, box.height) * (2.0 if role == "push_start" else 0.5)
    return role == "push_end" or box.grown(reach, reach, reach, reach).contains(point)
