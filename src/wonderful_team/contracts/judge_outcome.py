"""JudgeOutcome: compare before and after, and say for each subgoal what became of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal, Target, Verdict


class VerdictDraft(AnswerModel):
    """One subgoal's fate."""

    subgoal: str
    status: Literal["done", "not_done", "undone", "unclear"] = Field(
        description="undone: it was reached and later lost."
    )
    cause: str | None = Field(description="Why it was not reached, or null.")
    evidence: str = Field(description="What in the pictures or measurements shows it.")

    def to_verdict(self) -> Verdict:
        return Verdict(self.subgoal, self.status, self.cause, self.evidence)


class Outcome(AnswerModel):
    """Every subgoal, each once."""

    reasoning: str = Reasoning
    verdicts: list[VerdictDraft]

    def to_verdicts(self) -> tuple[Verdict, ...]:
        return tuple(draft.to_verdict() for draft in self.verdicts)


@dataclass(frozen=True, eq=False)
class JudgeOutcome(Question):
    """Asked of the Replanner after execution.

    Attributes:
        task: The instruction; its views are those from before anything moved, targets boxed and labelled.
        after: The views now; the first is the main one.
        measured: What the robot reported, one line per action.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    steps: tuple[str, ...]
    after: tuple[Picture, ...]
    measured: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return Outcome

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        wanted = sorted(subgoal.id for subgoal in self.subgoals)
        if sorted(item.subgoal for item in answer.verdicts) != wanted:
            raise ValueError(f"verdicts must hold each subgoal once: {', '.join(wanted)}")
        return answer, ()
