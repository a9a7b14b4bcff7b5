"""WriteSteps and ReviewSteps."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from wonderful_team.contracts import StepList, WriteSteps, arm_steps, can_carry
from wonderful_team.core.actions import SIDES, Side
from wonderful_team.core.values import Subgoal, Target
from wonderful_team.errors import NotUnderstoodError, UnsupportedQuestion
from wonderful_team.offline.answers.roles import Task, tasks_of
from wonderful_team.offline.eyes import Eyes, eyes_of_task
from wonderful_team.offline.language import try_understand
from wonderful_team.offline.vision import Thing


def answer_write_steps(question: WriteSteps) -> StepList:
    """Steps in an order that respects `after`, for the kinds that the robot runs."""
    eyes = eyes_of_task(question.task)
    steps: list[dict[str, object]] = []
    for subgoal in _ordered(question.subgoals):
        if subgoal.id in question.functions and "follow" in question.step_kinds and not _handles(subgoal):
            touches = re.search(r"\b(draw|write|wipe|trace|paint|scrub)", f"{subgoal.text} {subgoal.function}".lower())
            contact = "surface" if touches else "air"
            steps.append({"kind": "follow", "subgoal": subgoal.id, "function": subgoal.id, "contact": contact})
            continue
        steps += steps_of_subgoal(subgoal, question.targets, question.step_kinds, eyes)
    kinds = ", ".join(dict.fromkeys(str(step["kind"]) for step in steps)) or "no steps"
    reasoning = f"One task per subgoal in the plan's order, written as {kinds}."
    if question.doubt:
        reasoning += " Written anew from the subgoals after the doubt."
    answer: Any = question.output().model_validate({"reasoning": reasoning, "steps": steps})
    written: StepList = answer
    return written


def _handles(subgoal: Subgoal) -> bool:
    """Whether the words of a subgoal say what its path is for."""
    understood = try_understand(subgoal.text)
    return understood is not None and any(command.figure is not None for command in understood.commands)


def _ordered(subgoals: Sequence[Subgoal]) -> list[Subgoal]:
    """In the plan's order, each after those it names."""
    left, done = list(subgoals), []
    while left:
        ready = next((s for s in left if not set(s.after) & {other.id for other in left}), left[0])
        left.remove(ready)
        done.append(ready)
    return done


def steps_of_subgoal(
    subgoal: Subgoal, targets: Sequence[Target], kinds: Sequence[str], eyes: Eyes
) -> list[dict[str, object]]:
    """The steps that carry out one subgoal.

    Raises:
        NotUnderstoodError: It names no target to move.
        UnsupportedQuestion: The robot has no kinds of step that would do.
    """
    return [step for task in tasks_of(subgoal, targets, eyes) for step in _steps_of(task, subgoal, kinds, eyes)]


def _steps_of(task: Task, subgoal: Subgoal, kinds: Sequence[str], eyes: Eyes) -> list[dict[str, object]]:
    if task.thing is None:
        raise NotUnderstoodError(f"subgoal {subgoal.id} names no target to move: {subgoal.text!r}")
    if task.aim is not None and task.aim.figure is not None and "follow" not in kinds:
        raise UnsupportedQuestion(
            "offline", "WriteSteps", f"{subgoal.text!r} needs a robot that follows paths; offered: {', '.join(kinds)}"
        )
    if task.aim is not None and task.aim.kind == "trace":
        home: list[dict[str, object]] = [{"kind": "home", "subgoal": subgoal.id}] if "home" in kinds else []
        return [{"kind": "follow", "subgoal": subgoal.id, "function": subgoal.id, "contact": "surface"}, *home]
    pushed = task.aim is not None and task.aim.kind == "push"
    if (pushed or "pick_place" not in kinds) and "push" in kinds:
        return _push(task, eyes)
    if "pick_place" in kinds:
        ends = {"pick": task.thing.id, "place": place_of(task, eyes), "rotate_deg": task.rotate_deg}
        return [{"kind": "pick_place", "subgoal": task.subgoal, **ends}]
    if can_carry(kinds):
        return _arm(task, kinds, eyes)
    raise UnsupportedQuestion(
        "offline", "WriteSteps", f"it writes pick_place, push, or move with open and close; offered: {', '.join(kinds)}"
    )


def _push(task: Task, eyes: Eyes) -> list[dict[str, object]]:
    """One push, or one for every stop on the way."""
    if task.aim is not None and task.aim.kind == "rotate":
        why = "a thing cannot be turned by an exact angle by pushing alone"
        raise UnsupportedQuestion("offline", "WriteSteps", why)
    assert task.thing is not None  # checked by the caller
    ends = [*map(_spot, task.stops), place_of(task, eyes)]
    return [{"kind": "push", "subgoal": task.subgoal, "start": _spot(task.thing), "end": end} for end in ends]


def _spot(target: Target, how: str = "at", side: str | None = None) -> dict[str, object]:
    return {"target": target.id, "how": how, "side": side}


def place_of(task: Task, eyes: Eyes) -> dict[str, object]:
    """Where the thing of a task goes, as a PlaceDraft."""
    assert task.thing is not None  # checked by the callers
    if task.place is None or task.how == "origin":
        return _spot(task.place or task.thing, "origin")
    if task.how in SIDES:
        return _spot(task.place, "beside", task.how)
    if task.how == "near" and task.place.kind == "object":
        return _spot(task.place, "beside", freest_side(eyes.thing(task.to_number), eyes))
    return _spot(task.place)


def freest_side(thing: Thing | None, eyes: Eyes) -> Side:
    """The side of a thing with the most room to the next thing or the picture's edge; right when it is not seen."""
    if thing is None:
        return "right"
    width, height = eyes.scene.size_px
    box = thing.box
    room = {"right": width - box.x1, "left": box.x0, "below": height - box.y1, "above": box.y0}
    for other in (item.box for item in eyes.scene.objects if item.number != thing.number):
        if other.y0 < box.y1 and other.y1 > box.y0:
            right = other.centre[0] > box.centre[0]
            side, left = ("right", other.x0 - box.x1) if right else ("left", box.x0 - other.x1)
            room[side] = min(room[side], left)
        if other.x0 < box.x1 and other.x1 > box.x0:
            below = other.centre[1] > box.centre[1]
            side, left = ("below", other.y0 - box.y1) if below else ("above", box.y0 - other.y1)
            room[side] = min(room[side], left)
    return max(SIDES, key=lambda side: room[side])


def _arm(task: Task, kinds: Sequence[str], eyes: Eyes) -> list[dict[str, object]]:
    """Pick and place with an arm."""
    assert task.thing is not None  # checked by the callers
    if task.rotate_deg and "rotate_gripper" not in kinds:
        raise UnsupportedQuestion("offline", "WriteSteps", "turning needs rotate_gripper steps")
    parts = (task.subgoal, task.thing.id, place_of(task, eyes))
    kind = task.aim.kind if task.aim is not None else "put"
    if kind == "twist":
        return arm_steps(*parts, 0.0, kinds, tight=True, twist_deg=task.rotate_deg)
    function = task.subgoal if kind == "shake" else None
    return arm_steps(*parts, task.rotate_deg, kinds, tight=kind == "shake", function=function)
