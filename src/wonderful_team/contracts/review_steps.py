"""ReviewSteps: approve the steps, or raise one doubt about one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from wonderful_team.contracts.review_plan import PlanReview, WalkedReview, check_review, check_walk, walked
from wonderful_team.contracts.shown import AnswerModel, Question, ShownTask
from wonderful_team.core.actions import Step
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal, Target


@dataclass(frozen=True, eq=False)
class ReviewSteps(Question):
    """Asked of Verification. A doubt's `about` is the number of the step, from 1; a target's id for its point or box.

    Attributes:
        overview: The main view with every target's box and label, and the steps as numbered arrows.
        checked: What was asked before, of the plan and of the steps, and how it was settled, one line each.
        numbers: What code computed for the steps: heights and clearances in words, one line each.
        plan_checked: The plan itself was approved before. Else it is checked now too, with a walk through its subgoals, and a
            doubt may be about a subgoal or "plan".
        step_kinds: What the robot can do; shown where the plan is checked too.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    steps: tuple[Step, ...]
    overview: Picture
    checked: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()
    plan_checked: bool = True
    step_kinds: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return PlanReview if self.plan_checked else WalkedReview

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        numbers = [str(number) for number in range(1, len(self.steps) + 1)]
        ids = [subgoal.id for subgoal in self.subgoals]
        whole = [] if self.plan_checked else [*ids, "plan"]
        what = "step or subgoal" if whole else "step"
        check_review(answer, [*numbers, *whole], what, [target.id for target in self.targets])
        if not self.plan_checked:
            check_walk(answer, ids)
        return answer, ()

    def in_form(self, review: PlanReview) -> PlanReview | WalkedReview:
        """A review in the form that is asked for: for models that judge by other means."""
        return review if self.plan_checked else walked(self.subgoals, review)
