"""ExtractTargets: list what an approved plan needs to find in the picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import Field

from wonderful_team.contracts.plans import TargetDraft, settle_targets
from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask, fits, known
from wonderful_team.core.values import Subgoal


class SubgoalTargets(AnswerModel):
    """Which targets one subgoal needs."""

    subgoal: str
    targets: list[str] = Field(min_length=1)


class TargetList(AnswerModel):
    """Every target once, and who needs it."""

    reasoning: str = Reasoning
    targets: list[TargetDraft]
    needs: list[SubgoalTargets]


@dataclass(frozen=True, eq=False)
class ExtractTargets(Question):
    """Asked of the Supervisor once the plan is approved (`paper`)."""

    any_size: ClassVar[bool] = True
    task: ShownTask
    subgoals: tuple[Subgoal, ...]

    def output(self) -> type[AnswerModel]:
        return TargetList

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        fits(targets=len(answer.targets))
        targets, repairs = settle_targets(answer.targets, self.task.slots)
        ids = [target.id for target in answer.targets]
        wanted = [subgoal.id for subgoal in self.subgoals]
        known([need.subgoal for need in answer.needs], wanted, "subgoal")
        for need in answer.needs:
            known(need.targets, ids, f"target of subgoal {need.subgoal}")
        missing = set(wanted) - {need.subgoal for need in answer.needs}
        if missing:
            raise ValueError(f"needs must list every subgoal; missing: {', '.join(sorted(missing))}")
        return answer.model_copy(update={"targets": targets}), repairs
