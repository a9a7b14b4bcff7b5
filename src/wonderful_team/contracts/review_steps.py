"""ReviewSteps: approve the steps, or raise one doubt about one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from wonderful_team.contracts.review_plan import PlanReview, check_review
from wonderful_team.contracts.shown import AnswerModel, Question, ShownTask
from wonderful_team.core.actions import Step
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal, Target


@dataclass(frozen=True, eq=False)
class ReviewSteps(Question):
    """Asked of Verification. A doubt's `about` is the number of the step, from 1.

    Attributes:
        overview: The main view with every target's box and label, and the steps as numbered arrows.
        plan_checked: The plan itself was approved before. Else it is checked now too, and a doubt may be about a subgoal.
        step_kinds: What the robot can do; shown where the plan is checked too.
    """

    task: ShownTask
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    steps: tuple[Step, ...]
    overview: Picture
    checked: tuple[str, ...] = ()
    plan_checked: bool = True
    step_kinds: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return PlanReview

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        numbers = [str(number) for number in range(1, len(self.steps) + 1)]
        whole = [] if self.plan_checked else [subgoal.id for subgoal in self.subgoals]
        check_review(answer, [*numbers, *whole], "step or subgoal" if whole else "step")
        return answer, ()
