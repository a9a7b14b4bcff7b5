"""Refining one box: Checker and Mover over crops, until it is accepted, rejected, or the bound is met.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Algorithm 2 (inner loop).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

from wonderful_team.contracts import (
    BoxMove,
    BoxVerdict,
    JudgeBoxes,
    JudgeRevision,
    MoveBox,
    Presence,
    PresenceAnswer,
    RevisionVerdict,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Point
from wonderful_team.core.together import together
from wonderful_team.core.values import Answer, PointRole
from wonderful_team.images import crop
from wonderful_team.planning.jobs import Job
from wonderful_team.planning.judged import judge_box, said_of

BoxFate: TypeAlias = Literal["accepted", "rejected", "exhausted"]


async def first_judgement(
    job: Job, box: Box, points: Mapping[PointRole, Point]
) -> tuple[BoxVerdict, PresenceAnswer | None]:
    """The Checker's first word on a box and its points; in `paper` the edge strips are read at the same time."""
    ask_judge = _judgement(job, box, points)
    presence: PresenceAnswer | None = None
    if job.session.config.mode == "paper":
        ask_strips = job.session.ask_whole(
            Presence(job.target, job.strips(box), job.examples), stage="ground", branch=job.target.id
        )
        judged, strips = await together([ask_judge, ask_strips])
        presence = strips.value
    else:
        judged = await ask_judge
    verdict: BoxVerdict = judged.value
    job.problem, job.wrong_points = verdict.problem, tuple(verdict.wrong_points)
    text = f"Checker: {verdict.decision}" + (f" - {verdict.problem}" if verdict.problem else "")
    job.tell("verdict", text, box, provenance=judged.provenance)
    for wrong in verdict.wrong_points:
        said = f"Checker: reject the {said_of(wrong.use)} point - {wrong.why}"
        job.tell("verdict", said, box, (points[wrong.use],), judged.provenance)
    return verdict, presence


async def _judgement(job: Job, box: Box, points: Mapping[PointRole, Point]) -> Answer:
    """The Checker's first word on a box, which it may have given already."""
    if job.judged is not None:
        judged, job.judged = job.judged, None
        return judged
    return await job.session.ask_whole(judge_box(job, box, points), stage="ground", branch=job.target.id)


async def judge_together(jobs: Sequence[Job]) -> None:
    """Ask about the first boxes of several targets at once; each job then holds the word on its own."""
    question = JudgeBoxes(
        tuple(
            judge_box(job, job.first_box, job.first_points, f"crop of {job.target.id}")
            for job in jobs
            if job.first_box is not None
        )
    )
    answer = await jobs[0].session.ask_whole(question, stage="ground")
    for job in jobs:
        job.judged = replace(answer, value=answer.value.of(job.target.id))


async def refine(job: Job, box: Box, points: Mapping[PointRole, Point] | None = None) -> tuple[BoxFate, Box]:
    """Judge a first box and improve it. Returns its fate and the best box so far, in view pixels.

    Args:
        job: The target.
        box: Its first box [view px].
        points: Those that were chosen together with the box [view px]; which of them are wrong stands in the job then.
    """
    fate, box = await _refine(job, box, points or {})
    if fate == "accepted" and job.session.members.checker:
        job.accepted[job.target.id] = (job.target, box)
    return fate, box


async def _refine(job: Job, box: Box, points: Mapping[PointRole, Point]) -> tuple[BoxFate, Box]:
    members = job.session.members
    problem, presence = "", None
    if members.checker:
        verdict, presence = await first_judgement(job, box, points)
        if verdict.decision != "revise":
            return ("accepted" if verdict.decision == "accept" else "rejected"), box
        problem = verdict.problem
    if not members.mover:
        # Nobody can move it: the first box stands.
        return "accepted", box
    return await _move_until_right(job, box, problem, presence)


async def _move_until_right(job: Job, box: Box, problem: str, presence: PresenceAnswer | None) -> tuple[BoxFate, Box]:
    lines = [_presence_line(presence)] if presence else []
    for _ in range(job.session.config.bounds.refinements):
        move, after = await _propose(job, box, problem, tuple(lines))
        if move.action == "stop":
            job.tell("verdict", "Mover: it is right as it is", box)
            return "accepted", box
        if after is None:
            lines.append(f"{_move_line(move)}: would leave the picture")
            continue
        if not job.session.members.checker:
            box = after
            lines.append(_move_line(move))
            continue
        verdict = await _judge_revision(job, box, after)
        decision = verdict.decision
        lines.append(f"{_move_line(move)}: {decision}")
        if decision != "keep_before":
            # What was wrong with the box before need not be wrong with this one; what the Checker says now is.
            box, problem = after, ""
        problem = verdict.problem or problem
        if decision == "take_after_stop":
            return "accepted", box
    job.tell("verdict", f"not settled after {job.session.config.bounds.refinements} revisions", box)
    # Without a Checker nobody calls the box wrong: the Mover's last one stands.
    return ("exhausted" if job.session.members.checker else "accepted"), box


async def _propose(job: Job, box: Box, problem: str, lines: tuple[str, ...]) -> tuple[BoxMove, Box | None]:
    # The Mover answers in pixels of the crop, so here the axes are labelled in these.
    shown = crop(job.scene.view, box, "crop")
    shown = shown.marked(Axes(), BoxMark(shown.frame.box_to_picture(box)))
    question = MoveBox(
        job.target, shown, job.strips(box), problem, lines, not job.session.members.checker, job.examples
    )
    answer: Answer = await job.session.ask_whole(question, stage="ground", branch=job.target.id)
    move: BoxMove = answer.value
    after = shown.frame.box_to_view(move.apply(question.box)).intersection(job.view_box)
    if move.action != "stop" and after is not None:
        # What is told is in pixels of the view, like every box; the Mover itself is asked in those of its crop.
        said = _move_line(move, float(shown.frame.T_view_picture[0, 0]), float(shown.frame.T_view_picture[1, 1]))
        job.tell("move", f"Mover: {said}", after, provenance=answer.provenance)
    return move, after


async def _judge_revision(job: Job, before: Box, after: Box) -> RevisionVerdict:
    both = Box.bounding([*before.corners, *after.corners])
    shown = job.crop_with("after", both, after, "after")
    question = JudgeRevision(
        job.target,
        job.crop_with("before", both, before, "before"),
        shown,
        job.examples,
    )
    answer = await job.session.ask_whole(question, stage="ground", branch=job.target.id)
    verdict: RevisionVerdict = answer.value
    said = {"keep_before": "keep the box before", "take_after_go_on": "better, go on", "take_after_stop": "right, stop"}
    kept = before if verdict.decision == "keep_before" else after
    text = f"Checker: {said[verdict.decision]}" + (f" - {verdict.problem}" if verdict.problem else "")
    job.tell("verdict", text, kept, provenance=answer.provenance)
    return verdict


def _move_line(move: BoxMove, view_per_x: float = 1.0, view_per_y: float = 1.0) -> str:
    """A revision in words; the factors are how many pixels of the wanted picture one pixel of the crop is."""
    if move.action == "move":
        right, down = move.right_px * view_per_x, move.down_px * view_per_y
        ways = [(right, "right" if right >= 0 else "left"), (down, "down" if down >= 0 else "up")]
        return f"moved {', '.join(f'{abs(by):.0f} px {way}' for by, way in ways if round(by)) or 'by less than 1 px'}"
    grown = {
        "left": move.grow_left_px * view_per_x,
        "top": move.grow_top_px * view_per_y,
        "right": move.grow_right_px * view_per_x,
        "bottom": move.grow_bottom_px * view_per_y,
    }
    parts = [f"{name} {amount:+.0f}" for name, amount in grown.items() if amount]
    return f"edges outward by px: {', '.join(parts)}"


def _presence_line(presence: PresenceAnswer) -> str:
    inside = [item.edge for item in presence.edges if item.inside]
    outside = [item.edge for item in presence.edges if item.outside]
    return (
        f"strips: target shows just inside {', '.join(inside) or 'no edge'}; "
        f"just outside {', '.join(outside) or 'no edge'}"
    )
