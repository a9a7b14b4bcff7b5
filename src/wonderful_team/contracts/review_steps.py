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
    """Asked of Verification. A doubt's `about` is the number of the step, from 1; a target's id for its point or box.

    Attributes:
        overview: The main view with every target's box and label, and the steps as numbered arrows.
        checked: What was asked before, of the plan and of the steps, and how it was settled, one line each.
        numbers: What code computed for the steps: heights and clearances in words, one line each.
    """

    task: ShownTask
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    steps: tuple[Step, ...]
    overview: Picture
    checked: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return PlanReview

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        numbers = [str(number) for number in range(1, len(self.steps) + 1)]
        check_review(answer, numbers, "step", [target.id for target in self.targets])
        return answer, ()
