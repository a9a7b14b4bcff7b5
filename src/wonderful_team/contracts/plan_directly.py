"""PlanDirectly: subgoals, targets with their points, and steps, all in one answer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from pydantic import Field, create_model

from wonderful_team.contracts.draft_plan import DraftPlan
from wonderful_team.contracts.plans import GoalDraft, PlanDraft, TargetDraft, check_subgoals, settle_targets
from wonderful_team.contracts.read_scene import ReadScene, RolePoint
from wonderful_team.contracts.shown import (
    AnswerModel,
    BoxPx,
    Question,
    Reasoning,
    ShownSlot,
    ShownTask,
    fits,
    known,
    settle_box,
    settle_point,
    unique,
)
from wonderful_team.contracts.steps import StepList, check_steps, step_list_type
from wonderful_team.contracts.write_steps import WriteSteps
from wonderful_team.core.pictures import Picture
from wonderful_team.errors import NotUnderstoodError


class PointedTarget(TargetDraft):
    """A target, and where the robot acts on it."""

    box: BoxPx | None = Field(
        description="Tight round all of a thing; null for a spot without an outline, or when absent."
    )
    points: list[RolePoint] = Field(description="One for each use, in pixels of the main view; none when absent.")


class Pointed(AnswerModel):
    """What is to be done, and where things are: thought of before the steps, so that steps name what was found."""

    reasoning: str = Reasoning
    subgoals: list[GoalDraft] = Field(description="Empty only when the instruction is already fulfilled.")
    targets: list[PointedTarget]
    absent: list[str] = Field(description="Ids of targets that are not in the main view.")


class DirectPlan(StepList, Pointed):
    """A whole plan; the concrete type allows only steps that the world can run."""


@dataclass(frozen=True, eq=False)
class PlanDirectly(Question):
    """Asked of a planner that works alone.

    Attributes:
        task: Its first view is the one that points refer to.
        step_kinds: What the robot can do; paths of helper functions are not among it.
        advice: What went wrong before, or was doubted, a line each.
    """

    task: ShownTask
    step_kinds: tuple[str, ...]
    advice: tuple[str, ...] = ()

    @property
    def view(self) -> Picture:
        """The picture that points refer to."""
        return self.task.main

    def output(self) -> type[AnswerModel]:
        return direct_plan_type(self.step_kinds)

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        return settle_direct_plan(answer, self.view, self.task.slots)


def settle_direct_plan(
    answer: DirectPlan, view: Picture, slots: Sequence[ShownSlot]
) -> tuple[DirectPlan, tuple[str, ...]]:
    """A whole plan with its targets and points settled, and what was changed, in words.

    Raises:
        ValueError: The plan does not hang together, or a point that is needed is missing or outside the view.
    """
    fits(subgoals=len(answer.subgoals), targets=len(answer.targets))
    drafts, texts = settle_targets(answer.targets, slots)
    ids, repairs = [draft.id for draft in drafts], list(texts)
    check_subgoals(answer.subgoals, ids)
    check_steps(answer.to_steps(), [goal.id for goal in answer.subgoals], ids, ())
    known(answer.absent, ids, "target in 'absent'")
    targets = []
    for draft, given in zip(drafts, answer.targets, strict=True):
        placed, texts = _settle_target(given, given.id in answer.absent, view)
        targets.append(draft.model_copy(update=placed))
        repairs += texts
    return answer.model_copy(update={"targets": targets}), tuple(repairs)


def _settle_target(target: PointedTarget, absent: bool, view: Picture) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Box and points of a target within the view, and what was changed."""
    if absent:
        if target.points or target.box is not None:
            raise ValueError(f"{target.id} is said not to be there, yet has a box or points")
        return {}, ()
    roles = [entry.role for entry in target.points]
    unique(roles, f"uses of the points of {target.id}")
    missing = set(target.to_target().roles) - set(roles)
    if missing:
        raise ValueError(f"{target.id} needs a point for: {', '.join(sorted(missing))}")
    box, repairs = (None, ()) if target.box is None else settle_box(target.box, view)
    points = []
    for entry in target.points:
        point, texts = settle_point(entry.point, view)
        repairs += texts
        points.append(entry.model_copy(update={"point": point}))
    return {"box": box, "points": points}, repairs


@cache
def direct_plan_type(step_kinds: tuple[str, ...]) -> type[DirectPlan]:
    """The answer type for a vocabulary: a DirectPlan whose steps may be of these kinds only."""
    return create_model("DirectPlan", __base__=DirectPlan, steps=(steps_annotation(step_kinds), ...))


def steps_annotation(step_kinds: tuple[str, ...], outlines: bool = True) -> Any:
    """The type of a list of steps of these kinds, but for paths of functions, which nobody writes here."""
    kinds = tuple(kind for kind in step_kinds if kind != "follow") or step_kinds
    return step_list_type(kinds, outlines).model_fields["steps"].annotation


def in_parts(
    task: ShownTask, step_kinds: tuple[str, ...], advice: tuple[str, ...], answer: Callable[[Question], Any]
) -> dict[str, Any]:
    """The fields of a DirectPlan, from a model that plans, points and writes steps one after the other.

    Args:
        task: Shown to the question for a plan and to the one for steps; its first view is the one that is pointed in.
        step_kinds: What the robot can do.
        advice: What went wrong before.
        answer: Answers DraftPlan, ReadScene and WriteSteps.

    Raises:
        NotUnderstoodError: The model asks back what is meant.
    """
    draft: PlanDraft = answer(DraftPlan(task, step_kinds, True, advice))
    if draft.clarification is not None:
        raise NotUnderstoodError(draft.clarification.question)
    subgoals, targets = draft.to_subgoals(), draft.to_targets()
    liked = {name for target in targets for name in target.like}
    examples = tuple(slot for slot in task.slots if slot.name in liked)
    lines = tuple(f"{subgoal.id}: {subgoal.text}" for subgoal in subgoals)
    asked = ReadScene(targets, lines, task.main, task.views[1:], examples, task.instruction)
    read = answer(asked).targets if targets else []
    places: Mapping[str, Any] = {item.id: item.model_dump(include={"box", "points"}) for item in read}
    kinds = tuple(kind for kind in step_kinds if kind != "follow") or step_kinds
    steps = answer(WriteSteps(task, kinds, subgoals, targets)).steps if subgoals else []
    return {
        "reasoning": draft.reasoning,
        "subgoals": [{name: getattr(goal, name) for name in GoalDraft.model_fields} for goal in draft.subgoals],
        "targets": [{**item.model_dump(), **places[item.id]} for item in draft.targets],
        "absent": [item.id for item in read if not item.found],
        "steps": [item.model_dump() for item in steps],
    }
