"""PlanFromList: a whole plan with coordinates, from a list of objects in words; pictures may be shown beside it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from pydantic import Field, FiniteFloat, create_model

from wonderful_team.contracts.plan_directly import steps_annotation
from wonderful_team.contracts.plans import GoalDraft, check_subgoals
from wonderful_team.contracts.shown import OVERSHOOT, AnswerModel, Question, ShownSlot, fits, unique
from wonderful_team.contracts.steps import check_steps
from wonderful_team.core.actions import Step
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.values import PointRole, Target


@dataclass(frozen=True)
class ListedObject:
    """One line of the list: a name and a position, in the unit that the list states."""

    name: str
    x: int
    y: int


@dataclass(frozen=True)
class SlotWords:
    """What one of the instruction's pictures shows, in words."""

    slot: str
    words: str


class ListedPoint(AnswerModel):
    """A coordinate in the unit of the list; no picture is looked at for it."""

    use: PointRole
    x: FiniteFloat
    y: FiniteFloat


class ListedTarget(AnswerModel):
    """A thing or a spot that the steps name, with its coordinates."""

    id: str = Field(description="T1, T2, ... in order of use.")
    kind: Literal["object", "area"] = Field(description="object: a line of the list; area: a spot beside them.")
    words: str = Field(min_length=1)
    points: list[ListedPoint] = Field(description="One for each use, in the unit of the list.", min_length=1)

    def to_target(self) -> Target:
        """As plans hold it."""
        return Target(self.id, self.kind, self.words, use=tuple(point.use for point in self.points))


class ListedPlan(AnswerModel):
    """A whole plan; the concrete type allows only steps that the world can run."""

    subgoals: list[GoalDraft] = Field(description="Empty only when the instruction is already fulfilled.")
    targets: list[ListedTarget]
    steps: list[Any]

    def to_steps(self) -> tuple[Step, ...]:
        return tuple(step.to_step() for step in self.steps)


class Thoughts(AnswerModel):
    """What is thought through first."""

    thoughts: str = Field(description="Think step by step, before you write the plan.", min_length=1)


class ThoughtPlan(ListedPlan, Thoughts):
    """A whole plan after a chain of thought."""


@dataclass(frozen=True, eq=False)
class PlanFromList(Question):
    """Asked of a planner to whom the scene is told.

    Attributes:
        instruction: Its words; names in braces stand for pictures.
        objects: Everything on the table.
        slot_words: What the instruction's pictures show.
        picture, size_px: The picture whose pixels the list's positions are, by name and size.
        thoughts: A chain of thought comes first.
        example: One task with its list and its answer, as text.
        facts: What is known of the robot and its place.
        advice: What went wrong before.
        views, slots: Pictures shown beside the list; none in rows that are text alone.
        example_view: The example's scene, where pictures are shown.
    """

    instruction: str
    objects: tuple[ListedObject, ...]
    slot_words: tuple[SlotWords, ...]
    picture: str
    size_px: tuple[int, int]
    step_kinds: tuple[str, ...]
    thoughts: bool
    example: str
    facts: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()
    views: tuple[Picture, ...] = ()
    slots: tuple[ShownSlot, ...] = ()
    example_view: Picture | None = None

    def output(self) -> type[AnswerModel]:
        return listed_plan_type(self.step_kinds, self.thoughts)

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        fits(subgoals=len(answer.subgoals), targets=len(answer.targets))
        ids = [target.id for target in answer.targets]
        unique(ids, "target ids")
        check_subgoals(answer.subgoals, ids)
        check_steps(answer.to_steps(), [goal.id for goal in answer.subgoals], ids, ())
        targets, repairs = [], []
        for target in answer.targets:
            unique([point.use for point in target.points], f"uses of the points of {target.id}")
            points = [self._settled(point, target.id) for point in target.points]
            if points != target.points:
                repairs.append(f"a point of {target.id} was moved to the edge of the view")
            targets.append(target.model_copy(update={"points": points}))
        return answer.model_copy(update={"targets": targets}), tuple(repairs)

    def _settled(self, point: ListedPoint, name: str) -> ListedPoint:
        """A point inside the view. Raises ValueError where it lies well outside."""
        inside = {}
        for axis, side in zip(("x", "y"), self.size_px, strict=True):
            value = getattr(point, axis)
            if not -OVERSHOOT * side <= value <= (1 + OVERSHOOT) * side:
                raise ValueError(f"{axis} = {value:g} of {name} lies outside the view, which spans 0 to {side}")
            inside[axis] = min(max(value, 0.0), float(side))
        return point.model_copy(update=inside)


@cache
def listed_plan_type(step_kinds: tuple[str, ...], thoughts: bool) -> type[ListedPlan]:
    """The answer type for a vocabulary, with a chain of thought before the plan or without."""
    base = ThoughtPlan if thoughts else ListedPlan
    return create_model("ListedPlan", __base__=base, steps=(steps_annotation(step_kinds, outlines=False), ...))


def listed_plan(question: PlanFromList, parts: dict[str, Any], points: dict[str, dict[str, Point]]) -> ListedPlan:
    """A plan in the form that is asked for, from the fields of a direct plan and the points of its targets.

    Args:
        question: What is asked.
        parts: As `in_parts` gives them.
        points: By target id, then by use [unit of the list].
    """
    targets = [
        {
            "id": draft["id"],
            "kind": draft["kind"],
            "words": draft["words"],
            "points": [{"use": use, "x": x, "y": y} for use, (x, y) in points[draft["id"]].items()],
        }
        for draft in parts["targets"]
    ]
    said = {"thoughts": parts["reasoning"] or "One step follows from the other."} if question.thoughts else {}
    kept = {name: parts[name] for name in ("subgoals", "steps")}
    return question_type(question).model_validate({**said, **kept, "targets": targets})


def question_type(question: PlanFromList) -> type[ListedPlan]:
    """The concrete type of a right answer."""
    return listed_plan_type(question.step_kinds, question.thoughts)
