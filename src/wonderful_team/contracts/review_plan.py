"""ReviewPlan: approve a plan (or one subgoal of it), or raise one doubt about one subgoal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeAlias, get_args

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask, known, unique
from wonderful_team.core.values import Subgoal, Target

PlanDoubt: TypeAlias = Literal[
    "collision", "physical_constraint", "missing_prerequisite", "missing_subgoal", "ambiguity", "needless_step", "wrong_target"
]  # fmt: skip
"""Kinds of doubt about a plan."""
GroundingDoubt: TypeAlias = Literal["wrong_point", "wrong_box"]
"""Kinds of doubt about where a target was found; they name the target, which is then looked for again."""
GROUNDING_KINDS: tuple[str, ...] = get_args(GroundingDoubt)


class CritiqueDraft(AnswerModel):
    """One question about one subgoal or step, or about where a target was found."""

    about: str = Field(
        description="Id of the subgoal (or number of the step) in doubt; of the target for wrong_point and wrong_box."
    )
    kind: Literal[PlanDoubt, GroundingDoubt]
    question: str = Field(min_length=1)


class PlanDoubtDraft(CritiqueDraft):
    """One question about one subgoal."""

    about: str = Field(description='Id of the subgoal in doubt; "plan" for a missing one.')
    # No boxes and points are drawn yet: what is for these is not offered, and refused with the reason.
    kind: PlanDoubt | SkipJsonSchema[GroundingDoubt]


CLAUSE = 300
"""Most characters of one clause of a walk."""


class SubgoalCheck(AnswerModel):
    """One subgoal, imagined as it is carried out in its turn. One short clause in each field."""

    subgoal: str = Field(description="Id of the subgoal.")
    before: str = Field(
        description="What must be true before it, and what provides it: the picture, an earlier subgoal, or nothing.",
        max_length=CLAUSE,
    )
    doable: str = Field(description="Can the listed actions do it?", max_length=CLAUSE)
    after: str = Field(description="What is hit, covered or wrong after it.", max_length=CLAUSE)
    asked: str = Field(
        description="Is it the thing, the place, the angle and the order that was asked for?", max_length=CLAUSE
    )
    verdict: Literal["fine", "wrong", "cannot_tell"] = Field(
        description="cannot_tell: the pictures do not show it, and it matters."
    )


class PlanReview(AnswerModel):
    """Whether the plan may run as it is."""

    reasoning: str = Reasoning
    approved: bool
    doubt: CritiqueDraft | None = Field(description="Null exactly when approved.")


class WalkedReview(AnswerModel):
    """Verification's word on a plan: first a walk through the subgoals, then what follows from it."""

    # Answers of earlier releases have a reasoning in the place of the walk; models are asked for the walk alone.
    reasoning: SkipJsonSchema[str | None] = None
    walk: list[SubgoalCheck] | SkipJsonSchema[None] = Field(
        None, description="Every subgoal that is to be checked now, in the plan's order; empty for a plan without any."
    )
    approved: bool = Field(
        description="true exactly when every verdict of the walk is fine, no subgoal is missing, and nothing else is in doubt."
    )
    doubt: CritiqueDraft | None = Field(description="Null exactly when approved.")


class WalkedPlanReview(WalkedReview):
    """Verification's word on a plan of which nothing is drawn yet."""

    doubt: PlanDoubtDraft | None = Field(description="Null exactly when approved.")


@dataclass(frozen=True, eq=False)
class ReviewPlan(Question):
    """Asked of Verification.

    Attributes:
        under_check: Id of the subgoal to check now (`full`), or None for the whole plan (`one_step`).
        checked: What was checked or asked before, one line each, so that nothing is asked twice.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    step_kinds: tuple[str, ...]
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    under_check: str | None = None
    checked: tuple[str, ...] = ()

    @property
    def to_walk(self) -> tuple[str, ...]:
        """Ids of the subgoals that are to be checked now."""
        return tuple(item.id for item in self.subgoals) if self.under_check is None else (self.under_check,)

    @property
    def unused(self) -> tuple[Target, ...]:
        """Targets that no subgoal names; none while the subgoals' targets are not listed yet."""
        named = {name for subgoal in self.subgoals for name in subgoal.targets}
        return tuple(target for target in self.targets if named and target.id not in named)

    def output(self) -> type[AnswerModel]:
        return WalkedPlanReview

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        check_review(answer, [*(subgoal.id for subgoal in self.subgoals), "plan"], "subgoal")
        check_walk(answer, self.to_walk)
        return answer, ()

    def walked(self, review: PlanReview) -> WalkedReview:
        """A review with a walk that says no more than the review: for models that judge the plan by other means."""
        said = walked([item for item in self.subgoals if item.id in self.to_walk], review)
        return WalkedPlanReview.model_validate(said.model_dump(exclude_unset=True))


def check_walk(answer: WalkedReview, to_walk: Sequence[str]) -> None:
    """Raise ValueError when a walk leaves a subgoal out, or speaks against what follows from it."""
    if answer.reasoning is not None:
        return
    walk = answer.walk or []
    names = [item.subgoal for item in walk]
    known(names, to_walk, "subgoal in the walk")
    unique(names, "subgoals of the walk")
    missing = [name for name in to_walk if name not in names]
    if missing:
        raise ValueError(f"the walk must hold every subgoal that is to be checked; missing: {', '.join(missing)}")
    amiss = [f"{item.subgoal} {item.verdict}" for item in walk if item.verdict != "fine"]
    if answer.approved and amiss:
        raise ValueError(
            f"approved, yet the walk says {', '.join(amiss)}: raise it as the doubt, or correct the verdict where the "
            "pictures or an earlier answer settle it"
        )


def walked(subgoals: Sequence[Subgoal], review: PlanReview) -> WalkedReview:
    """A review with a walk through these subgoals that says no more than the review."""
    walk = [_said(item, review.doubt) for item in subgoals]
    return WalkedReview(walk=walk, approved=review.approved, doubt=review.doubt)


def _said(subgoal: Subgoal, doubt: CritiqueDraft | None) -> SubgoalCheck:
    said = {
        "before": f"after {', '.join(subgoal.after)}" if subgoal.after else "as the picture shows it",
        "doable": "yes",
        "after": "nothing",
        "asked": "yes",
    }
    if doubt is None or doubt.about != subgoal.id:
        return SubgoalCheck(subgoal=subgoal.id, **said, verdict="fine")
    field = {"missing_prerequisite": "before", "physical_constraint": "doable", "collision": "after"}
    said[field.get(doubt.kind, "asked")] = doubt.question[:CLAUSE]
    return SubgoalCheck(subgoal=subgoal.id, **said, verdict="wrong")


def check_review(answer: PlanReview | WalkedReview, ids: list[str], what: str, drawn: Sequence[str] = ()) -> None:
    """Raise ValueError when approval and doubt contradict each other, or the doubt is about nothing.

    Args:
        answer: What Verification said.
        ids: What a doubt may be about.
        what: What these are.
        drawn: Targets whose boxes and points are drawn: what a doubt about a point or box may be about.
    """
    if answer.approved == (answer.doubt is not None):
        raise ValueError("doubt must be null exactly when approved is true")
    if answer.doubt is None:
        return
    if answer.doubt.kind not in GROUNDING_KINDS:
        known([answer.doubt.about], ids, what)
    elif drawn:
        known([answer.doubt.about], drawn, f"target for a doubt of kind {answer.doubt.kind}")
    else:
        raise ValueError(f"{answer.doubt.kind} is for drawn points and boxes; none are drawn yet: use wrong_target")
