"""ReviewPlan: approve a plan (or one subgoal of it), or raise one doubt about one subgoal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask, known
from wonderful_team.core.values import Subgoal, Target

GROUNDING_KINDS = ("wrong_point", "wrong_box")
"""Kinds of doubt about where a target was found; they name the target, which is then looked for again."""


class CritiqueDraft(AnswerModel):
    """One question about one subgoal or step, or about where a target was found."""

    about: str = Field(
        description="Id of the subgoal (or number of the step) in doubt; of the target for wrong_point and wrong_box."
    )
    kind: Literal[
        "collision", "physical_constraint", "missing_prerequisite", "ambiguity", "needless_step", "wrong_target",
        "wrong_point", "wrong_box",
    ]  # fmt: skip
    question: str = Field(min_length=1)


class PlanReview(AnswerModel):
    """Verification's word."""

    reasoning: str = Reasoning
    approved: bool
    doubt: CritiqueDraft | None = Field(description="Null exactly when approved.")


@dataclass(frozen=True, eq=False)
class ReviewPlan(Question):
    """Asked of Verification.

    Attributes:
        under_check: Id of the subgoal to check now (`full`), or None for the whole plan (`one_step`).
        checked: What was checked or asked before, one line each, so that nothing is asked twice.
    """

    task: ShownTask
    step_kinds: tuple[str, ...]
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    under_check: str | None = None
    checked: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return PlanReview

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        check_review(answer, [subgoal.id for subgoal in self.subgoals] or ["plan"], "subgoal")
        return answer, ()


def check_review(answer: PlanReview, ids: list[str], what: str, drawn: Sequence[str] = ()) -> None:
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
