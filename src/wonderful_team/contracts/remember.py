"""Remember: keep what matters of another agent's answer, or nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question


class MemoryEntry(AnswerModel):
    """What to keep."""

    keep: bool
    key: str = Field(description="A short name for the entry; empty when nothing is kept.", max_length=60)
    summary: str = Field(description="One or two sentences; empty when nothing is kept.", max_length=600)


@dataclass(frozen=True, eq=False)
class Remember(Question):
    """Asked of Memory after another agent's answer.

    Attributes:
        role, asked, answered: Who was asked what, and what came back, in words.
        known: Keys that the memory already holds.
    """

    instruction: str
    role: str
    asked: str
    answered: str
    known: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return MemoryEntry

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.keep != bool(answer.key and answer.summary):
            raise ValueError("key and summary must be given exactly when keep is true")
        return answer, ()
