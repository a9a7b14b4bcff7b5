"""WriteSteps: write the steps of a plan, naming targets by id."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from wonderful_team.contracts.shown import AnswerModel, Question, ShownTask
from wonderful_team.contracts.steps import check_steps, step_list_type
from wonderful_team.core.values import Subgoal, Target


@dataclass(frozen=True, eq=False)
class WriteSteps(Question):
    """Asked of the Supervisor.

    Attributes:
        functions: Ids of subgoals for which a helper function gives a path.
        doubt: What Verification asked about the last version, or "".
    """

    task: ShownTask
    step_kinds: tuple[str, ...]
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    functions: tuple[str, ...] = ()
    doubt: str = ""

    def output(self) -> type[AnswerModel]:
        return step_list_type(self.step_kinds)

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        check_steps(
            answer.to_steps(), [s.id for s in self.subgoals], [target.id for target in self.targets], self.functions
        )
        return answer, ()
