"""Grounding without the grounding team: by points of the Supervisor, by one model call, or by a detector. Checker and Mover are asked nothing.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094: settings 6 and 7 remove the grounding team ("the Supervisor handled all steps");
its comparison on VIMA-Bench replaces it "with a single VLLM for inferring object coordinates directly" and with "a separate
vision-language model, OWL-ViT" (its appendix speaks of LangSAM too). Planning, Verification, steps and memory are the team's.

What the paper leaves open, and what is done here:

- How many questions the single model is asked. One: boxes and points of all targets in one answer (the Manager's ReadScene), which
  stands as it is.
- What a detector is told. Everything that the plan says of a thing in words, as one phrase: its part, its words, and where it
  is ("handle of red mug, left of the bowl"). A detector is asked once for all things of a plan.
- Which of several boxes is taken. The surest; things in the same words get different ones (less than half in common).
- Where to act in a box. `detectors.act_at`: on the mask for picking, the middle of the box for placing, beside it for pushing.
- Places ("the free space left of the bowl", the place where a picture shows a thing). They have no outline, and a detector cannot
  find them: they are asked of the model in one call, and the story says so.
- Words that a detector refuses (the classical one, for a noun that it does not know). That target ends as given up, and goes back
  to the Supervisor as any that was not found; where it refuses all of them, planning ends as not understood.
- Things that only a picture of the instruction shows. A detector reads words: such a target ends as not found, and says why.
- What happens when Verification doubts a point or a box. The detector's next best box without a rejected point in it; one more
  question for one point where a model grounds. (Bounds: `regrounds`.)
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import Literal

from wonderful_team.contracts import LocatePoints, Points, SceneTarget
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.together import together
from wonderful_team.core.values import Detection, GroundedTarget, PointRole, Provenance, Target, View
from wonderful_team.detectors import act_at, name_of
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.planning.config import Grounding
from wonderful_team.planning.jobs import ENDS, Job, read_scene
from wonderful_team.planning.session import AgentSession

SAME_BOX = 0.5
"""Two boxes are one thing from this intersection over union on."""


async def ground_otherwise(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """All targets, by whoever takes the place of the grounding team."""
    return await _WAYS[jobs[0].session.config.grounded_by](jobs)


async def ground_again_otherwise(job: Job) -> GroundedTarget:
    """One target anew; what was wrong with it stands in the job."""
    way = job.session.config.grounded_by
    if way == "detector" and job.target.kind == "object":
        return (await ground_by_detector([job]))[job.target.id]
    return await _ask_point(job, "supervisor" if way == "supervisor" else "manager")


async def ground_by_supervisor(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """One point for each target on the labelled view, by the Supervisor."""
    grounded = await together([_ask_point(job, "supervisor") for job in jobs])
    return {item.target.id: item for item in grounded}


async def _ask_point(job: Job, role: Literal["supervisor", "manager"]) -> GroundedTarget:
    view, said = job.with_rejected(job.scene.labelled)
    purpose: Literal["centre", "place"] = "place" if job.target.kind == "area" else "centre"
    question = LocatePoints(
        job.target, purpose, job.plan, view, job.scene.views[1:], job.examples, 1, said, job.instruction
    )
    answer: Points = await job.session.ask(question, stage="ground", branch=job.target.id, role=role)
    named = role.capitalize()
    if not answer.points:
        job.tell("absent", f"the {named} says it is not in the picture")
        return job.end("absent", None)
    point = view.frame.point_to_view(answer.points[0].as_tuple)
    job.tell("point", f"the {named}'s point", points=(point,))
    return job.end("found", None, {role: point for role in job.target.roles})


async def ground_in_one_call(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """What one answer says of all targets, as it is."""
    reading, provenance = await read_scene(jobs)
    by_id = {item.id: item for item in reading.targets}
    return {job.target.id: _as_read(job, by_id[job.target.id], provenance) for job in jobs}


def _as_read(job: Job, item: SceneTarget, provenance: Provenance) -> GroundedTarget:
    frame = job.scene.views[0].frame
    if not item.found or item.box is None:
        job.tell("absent", "the one call says it is not in the picture", provenance=provenance)
        return job.end("absent", None)
    box = frame.box_to_view(item.box.as_box)
    points = {entry.role: frame.point_to_view(entry.point.as_tuple) for entry in item.points}
    job.tell("box", "box and points of the one call", box, tuple(points.values()), provenance)
    return job.end("found", box, points)


def phrase_of(target: Target) -> str:
    """What a detector is asked for: all that the plan says of a thing in words."""
    part = f"{target.part} of " if target.part else ""
    return f"{part}{target.words}{f', {target.where}' if target.where else ''}"


async def ground_by_detector(jobs: Sequence[Job]) -> dict[str, GroundedTarget]:
    """The surest box for each thing; places are asked of the model in one call."""
    session, view = jobs[0].session, jobs[0].scene.view
    places = [job for job in jobs if job.target.kind == "area"]
    pictured = [job for job in jobs if job.target.kind == "object" and "{" in phrase_of(job.target)]
    named = [job for job in jobs if job not in places and job not in pictured]
    found, refused = await _looked(session, view, [phrase_of(job.target) for job in named])
    if places:
        ids = ", ".join(job.target.id for job in places)
        session.stage("places", f"{ids}: a detector finds things, not places; asked of the model in one call")
    grounded = await ground_in_one_call(places) if places else {}
    ends = {
        key: next((item.points[role] for role in ENDS if role in item.points), None) for key, item in grounded.items()
    }
    taken: dict[str, list[Box]] = {}
    # What is pushed comes last: the side it is pushed from depends on where the others are.
    for job in sorted(named, key=lambda one: one.goal is not None):
        if phrase_of(job.target) in refused:
            job.tell("absent", refused[phrase_of(job.target)], provenance="detector")
            grounded[job.target.id] = job.end("gave_up", None)
            continue
        one = _surest(job, found, taken)
        job.towards = ends.get(job.goal or "") or job.towards
        grounded[job.target.id] = _detected(job, one, found)
        ends[job.target.id] = None if one is None else act_at(one, "place")
    for job in pictured:
        job.tell("absent", f"{phrase_of(job.target)!r} points to a picture, and a detector reads words alone")
        grounded[job.target.id] = job.end("absent", None)
    return {job.target.id: grounded[job.target.id] for job in jobs}


async def _looked(
    session: AgentSession, view: View, phrases: Sequence[str]
) -> tuple[tuple[Detection, ...], dict[str, str]]:
    """What is found of these, and why some could not be asked for.

    Raises:
        NotUnderstoodError: None could be.
    """
    if not phrases:
        return (), {}
    asked = tuple(dict.fromkeys(phrases))
    try:
        return await session.look(view, asked), {}
    except NotUnderstoodError as error:
        first = error
        if len(asked) == 1:
            raise
    found, refused = list[Detection](), dict[str, str]()
    for phrase in asked:
        try:
            found += await session.look(view, [phrase])
        except NotUnderstoodError as error:
            refused[phrase] = str(error)
    if len(refused) == len(asked):
        raise first
    return tuple(found), refused


def _surest(job: Job, found: Sequence[Detection], taken: dict[str, list[Box]]) -> Detection | None:
    """The surest box that no other target in these words has, and in which nothing was rejected."""
    phrase = phrase_of(job.target)
    others = taken.setdefault(phrase, [])
    for one in found:
        if one.words != phrase or any(one.box.iou(box) > SAME_BOX for box in others):
            continue
        if not any(one.box.contains(item.point) for item in job.avoid):
            others.append(one.box)
            return one
    return None


def _detected(job: Job, one: Detection | None, found: Sequence[Detection]) -> GroundedTarget:
    phrase = phrase_of(job.target)
    count = sum(item.words == phrase for item in found)
    name = "" if job.session.detector is None else name_of(job.session.detector)
    if one is None:
        why = f"{count} found, all of them rejected or another target's" if count else "nothing found"
        job.tell("absent", f"{name}: {phrase!r}: {why}", provenance="detector")
        return job.end("absent", None)
    points: Mapping[PointRole, Point] = {role: act_at(one, role, job.towards) for role in job.target.roles}
    said = f"{name}: {phrase!r} with score {one.score:.2f}, of {count} found"
    job.tell("box", said, one.box, tuple(points.values()), "detector")
    return job.end("found", one.box, points)


_WAYS: dict[Grounding, Callable[[Sequence[Job]], Awaitable[dict[str, GroundedTarget]]]] = {
    "supervisor": ground_by_supervisor,
    "one_call": ground_in_one_call,
    "detector": ground_by_detector,
}
