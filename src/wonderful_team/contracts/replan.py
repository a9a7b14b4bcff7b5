"""Replan: after verdicts, say whether to stop, and what the next plan should do differently."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask
from wonderful_team.core.later import later
from wonderful_team.core.values import Subgoal, Verdict


class Advice(AnswerModel):
    """The Replanner's advice to the Supervisor."""

    reasoning: str = Reasoning
    decision: Literal["done", "replan", "give_up"]
    cause: str = Field(description="What went wrong, in one sentence; empty when done.")
    advice: str = Field(description="What the next plan should do differently; empty unless replan.")


@dataclass(frozen=True, eq=False)
class Replan(Question):
    """Asked of the Replanner when a subgoal is not done. The task's views are those of now.

    Attributes:
        functions: Helper functions that were accepted in the trial so far, a line each.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    subgoals: tuple[Subgoal, ...]
    verdicts: tuple[Verdict, ...]
    measured: tuple[str, ...]
    replans_left: int
    functions: tuple[str, ...] = later(())

    def output(self) -> type[AnswerModel]:
        return Advice

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if (answer.decision == "replan") != bool(answer.advice):
            raise ValueError("advice must be given exactly when the decision is replan")
        return answer, ()
