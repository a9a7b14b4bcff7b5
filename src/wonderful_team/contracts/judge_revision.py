"""JudgeRevision: keep the box before a revision, or take the one after it, and go on or stop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownSlot
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Target


class RevisionVerdict(AnswerModel):
    """The Checker's word on one revision."""

    reasoning: str = Reasoning
    decision: Literal["keep_before", "take_after_go_on", "take_after_stop"] = Field(
        description="keep_before: the revision is worse; take_after_go_on: better, not yet right; "
        "take_after_stop: every edge is within the limits."
    )
    problem: str = Field("", description="What is still wrong with the kept box, in one sentence; empty after stop.")


@dataclass(frozen=True, eq=False)
class JudgeRevision(Question):
    """Asked of the Checker. Both crops show the same part of the view, each with its own box.

    Attributes:
        before: None where only the box after the revision is shown, to measure what the comparison is worth.
    """

    any_size: ClassVar[bool] = True
    target: Target
    before: Picture | None
    after: Picture
    examples: tuple[ShownSlot, ...] = ()

    def output(self) -> type[AnswerModel]:
        return RevisionVerdict
