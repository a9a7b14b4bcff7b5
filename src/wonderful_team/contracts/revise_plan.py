"""RevisePlan: answer a doubt: change the plan, or say why it stands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.plans import PlanDraft, PlanWithoutTargets, settle_plan
from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask
from wonderful_team.core.later import later
from wonderful_team.core.values import Critique, Subgoal, Target


class PlanRevision(AnswerModel):
    """The Supervisor's reply to a doubt."""

    reasoning: str = Reasoning
    decision: Literal["revise", "keep"]
    answer: str = Field(description="One or two sentences for Verification.", min_length=1)
    plan: PlanDraft | None = Field(description="The whole new plan when the decision is revise; else null.")


class RevisionWithoutTargets(PlanRevision):
    """The Supervisor's reply to a doubt about a plan whose targets are listed later."""

    plan: PlanWithoutTargets | None = Field(description="The whole new plan when the decision is revise; else null.")


@dataclass(frozen=True, eq=False)
class RevisePlan(Question):
    """Asked of the Supervisor after a doubt.

    Attributes:
        functions: Helper functions that were accepted earlier in the trial, a line each.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    step_kinds: tuple[str, ...]
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    doubt: Critique
    with_targets: bool
    functions: tuple[str, ...] = later(())

    def output(self) -> type[AnswerModel]:
        return PlanRevision if self.with_targets else RevisionWithoutTargets

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if (answer.decision == "revise") != (answer.plan is not None):
            raise ValueError("plan must be given exactly when the decision is revise")
        if answer.plan is None:
            return answer, ()
        plan, repairs = settle_plan(answer.plan, self.task.slots, self.with_targets)
        return answer.model_copy(update={"plan": plan}), repairs
