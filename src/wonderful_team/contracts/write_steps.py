"""WriteSteps: write the steps of a plan, naming targets by id."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from wonderful_team.contracts.shown import AnswerModel, Question, ShownTask
from wonderful_team.contracts.steps import check_steps, step_list_type
from wonderful_team.core.later import later
from wonderful_team.core.values import Subgoal, Target


@dataclass(frozen=True, eq=False)
class WriteSteps(Question):
    """Asked of the Supervisor.

    Attributes:
        functions: Ids of subgoals for which a helper function gives a path.
        doubt: What Verification asked about the last version, or "".
        outlines: More is found of targets than points, so that steps can put things beside them.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    step_kinds: tuple[str, ...]
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    functions: tuple[str, ...] = ()
    doubt: str = ""
    outlines: bool = later(True)

    def output(self) -> type[AnswerModel]:
        return step_list_type(self.step_kinds, self.outlines)

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        check_steps(
            answer.to_steps(), [s.id for s in self.subgoals], [target.id for target in self.targets], self.functions
        )
        return answer, ()
