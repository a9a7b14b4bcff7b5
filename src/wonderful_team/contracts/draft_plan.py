"""DraftPlan: write a plan of qualitative subgoals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from wonderful_team.contracts.plans import PlanDraft, settle_plan
from wonderful_team.contracts.shown import AnswerModel, Question, ShownTask
from wonderful_team.core.later import later


@dataclass(frozen=True, eq=False)
class DraftPlan(Question):
    """Asked of the Supervisor.

    Attributes:
        step_kinds: What the robot can do; the plan must be possible with these alone.
        with_targets: Targets are written with the draft (`lean`); else the lists stay empty (`paper`).
        advice: What went wrong before: from the Replanner, or targets that were not found.
        functions: Helper functions that were accepted earlier in the trial, a line each.
    """

    task: ShownTask
    step_kinds: tuple[str, ...]
    with_targets: bool
    advice: tuple[str, ...] = ()
    functions: tuple[str, ...] = later(())

    def output(self) -> type[AnswerModel]:
        return PlanDraft

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        return settle_plan(answer, self.task.slots, self.with_targets)
