"""DraftPlan: write a plan of qualitative subgoals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from wonderful_team.contracts.plans import GoalDraft, PlainPlan, PlanDraft, PlanWithoutTargets, settle_plan
from wonderful_team.contracts.shown import AnswerModel, Question, ShownTask
from wonderful_team.core.later import later
from wonderful_team.errors import NotUnderstoodError


@dataclass(frozen=True, eq=False)
class DraftPlan(Question):
    """Asked of the Supervisor; plain, of a planner who works alone.

    Attributes:
        step_kinds: What the robot can do; the plan must be possible with these alone.
        with_targets: Targets are written with the draft (`lean`); else the lists stay empty (`paper`).
        advice: What went wrong before: from the Replanner, or targets that were not found.
        functions: Helper functions that were accepted earlier in the trial, a line each.
        plain: Subgoals and targets are all that is asked for: no moves, no helper functions, nothing for somebody who checks.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    step_kinds: tuple[str, ...]
    with_targets: bool
    advice: tuple[str, ...] = ()
    functions: tuple[str, ...] = later(())
    plain: bool = later(False)

    def output(self) -> type[AnswerModel]:
        written = PlanDraft if self.with_targets else PlanWithoutTargets
        return PlainPlan if self.plain else written

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        return settle_plan(answer, self.task.slots, self.with_targets)

    def in_form(self, draft: PlanDraft) -> PlanDraft | PlainPlan:
        """A plan in the form that is asked for: for models that plan by other means.

        Raises:
            NotUnderstoodError: It asks back what is meant, and there is no form for that.
        """
        if not self.plain:
            return draft
        if draft.clarification is not None:
            raise NotUnderstoodError(draft.clarification.question)
        fields = GoalDraft.model_fields
        goals = [GoalDraft(**{name: getattr(goal, name) for name in fields}) for goal in draft.subgoals]
        return PlainPlan(reasoning=draft.reasoning, subgoals=goals, targets=draft.targets)
