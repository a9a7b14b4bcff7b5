"""JudgeSubgoal: while a plan is being carried out, what became of the subgoal that ran last, and does the rest still hold?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal, Target, Verdict


class SubgoalOutcome(AnswerModel):
    """One subgoal's fate, and whether the plan goes on."""

    reasoning: str = Reasoning
    status: Literal["done", "not_done", "unclear"] = Field(description="What became of this subgoal.")
    evidence: str = Field(description="What in the pictures or measurements shows it.")
    cause: str | None = Field(description="Why it was not reached, or null.")
    rest_holds: bool = Field(
        description="Whether what the later subgoals use, and what earlier ones reached, is still as the plan has it."
    )
    what_changed: str = Field(description="What is not as the plan has it, in one sentence; empty when the rest holds.")

    def to_verdict(self, subgoal: str) -> Verdict:
        return Verdict(subgoal, self.status, self.cause, self.evidence)

    @property
    def stop(self) -> str:
        """Why the rest of the plan must not run; "" to go on. What the pictures do not show is left to a later look."""
        missed = f"it was not reached: {self.cause or self.evidence}" if self.status == "not_done" else ""
        return "; ".join(text for text in (missed, self.what_changed if not self.rest_holds else "") if text)


@dataclass(frozen=True, eq=False)
class JudgeSubgoal(Question):
    """Asked of the Replanner after one subgoal, while others are still to run.

    Attributes:
        task: The instruction; its views are those from before this subgoal, what it and the later ones use boxed and labelled.
        subgoal: The one that ran last.
        subgoals: The whole plan.
        steps: Those of this subgoal.
        after: The views now, with the same boxes; the first is the main one.
        measured: What the robot reported, one line per action.
        doubts: What a comparison of the pictures shows that the plan does not expect, one line each.
    """

    any_size: ClassVar[bool] = True
    task: ShownTask
    subgoal: Subgoal
    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    steps: tuple[str, ...]
    after: tuple[Picture, ...]
    measured: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return SubgoalOutcome

    @property
    def later(self) -> tuple[Subgoal, ...]:
        """Those that are still to run."""
        names = [subgoal.id for subgoal in self.subgoals]
        return self.subgoals[names.index(self.subgoal.id) + 1 :] if self.subgoal.id in names else ()

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.rest_holds == bool(answer.what_changed.strip()):
            raise ValueError("what_changed must be empty exactly when rest_holds is true")
        return answer, ()
