"""ListSubtasks and ChooseMotion: subtasks named for a detector, and their motions by the marks nearest to what is seen."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from wonderful_team.contracts import (
    ChooseMotion,
    DraftPlan,
    ListSubtasks,
    MotionMarks,
    PlanDraft,
    Question,
    SubtaskDraft,
    SubtaskList,
    WriteSteps,
)
from wonderful_team.core.actions import At, OriginOf, PickPlaceStep
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import Target
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.eyes import Eyes, eyes_of, eyes_of_task, target_description, unique_words
from wonderful_team.offline.language import describe, understand
from wonderful_team.offline.vision import Thing

OTHERWISE = (
    "model 'offline' chooses marks for what is carried onto another thing, or turned where it stands; not for this"
)


def answer_list_subtasks(question: ListSubtasks, answer: Callable[[Question], Any]) -> SubtaskList:
    """The plan that it would draft, its things named as a detector finds them.

    Args:
        question: What is asked.
        answer: Answers DraftPlan and WriteSteps.

    Raises:
        NotUnderstoodError: It asks back what is meant, or a step needs a place that is no thing.
    """
    draft: PlanDraft = answer(DraftPlan(question.task, question.step_kinds, True, question.advice))
    if draft.clarification is not None:
        raise NotUnderstoodError(draft.clarification.question)
    subgoals, targets = draft.to_subgoals(), draft.to_targets()
    if not subgoals:
        return SubtaskList(reasoning=draft.reasoning, subtasks=[])
    steps = answer(WriteSteps(question.task, question.step_kinds, subgoals, targets)).to_steps()
    eyes, by_id, moved = eyes_of_task(question.task), {target.id: target for target in targets}, set[str]()
    subtasks = []
    for step in steps:
        if not isinstance(step, PickPlaceStep):
            raise NotUnderstoodError(f"{OTHERWISE}: {step.kind}")
        stays = step.place in (OriginOf(step.pick), At(step.pick)) and step.pick not in moved
        other = "" if stays else _named(by_id[step.place.target], eyes)
        held, moved = _named(by_id[step.pick], eyes), moved | {step.pick}
        if not other and not stays or not stays and not isinstance(step.place, At):
            raise NotUnderstoodError(f"{OTHERWISE}: {next(goal.text for goal in subgoals if goal.id == step.subgoal)}")
        way = "counterclockwise" if step.rotate_deg < 0 else "clockwise"
        said = (
            f"rotate the {held} by {abs(step.rotate_deg):g} degrees {way}"
            if stays
            else f"put the {held} onto the {other}"
        )
        subtasks.append(
            SubtaskDraft(instruction=said, object_grasped=held, object_unattached=other, motion_direction="")
        )
    return SubtaskList(reasoning=draft.reasoning, subtasks=subtasks)


def _named(target: Target, eyes: Eyes) -> str:
    """Words for a thing; "" for a place that is no thing."""
    if target.kind == "area" and not target.like and "area" not in target.words:
        target = replace(target, kind="object")
    thing = _thing(eyes, target_description(target))
    return "" if thing is None else unique_words(eyes, thing, "object").text


def _thing(eyes: Eyes, description: Any) -> Thing | None:
    best = eyes.best(description)
    return None if best is None else best.thing


def answer_choose_motion(question: ChooseMotion) -> MotionMarks:
    """The keypoints nearest to where it would hold the one thing, and to the middle of the other."""
    eyes = eyes_of(question.view, ())
    held = _thing(eyes, describe(question.object_grasped)) if question.object_grasped else None
    if held is None:
        raise NotUnderstoodError(f"{OTHERWISE}: {question.instruction}")
    target = ""
    if question.object_unattached:
        other = _thing(eyes, describe(question.object_unattached))
        points = question.keypoints("Q").points
        target = _nearest("Q", points, points[0] if other is None else other.box.centre)
    turns = [command.rotate_deg for command in understand(question.instruction).commands if command.kind == "rotate"]
    return MotionMarks(
        reasoning="the nearest keypoints",
        grasp_keypoint=_nearest("P", question.keypoints("P").points, held.steady_point()),
        function_keypoint="",
        target_keypoint=target,
        pre_contact_tile="",
        post_contact_tile="",
        pre_contact_height="",
        post_contact_height="",
        target_angle=turns[0] if turns else 0.0,
    )


def _nearest(letter: str, points: tuple[Point, ...], point: Point) -> str:
    best = min(range(len(points)), key=lambda k: math.dist(points[k], point))
    return f"{letter}{best + 1}"
