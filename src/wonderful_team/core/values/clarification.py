"""A question that only the user can settle, and who asks it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True)
class Clarification:
    """What the user was asked because neither picture nor instruction settles it, and what was answered.

    Attributes:
        choices: Readings that were offered; the answer may be another one.
    """

    question: str
    choices: tuple[str, ...]
    answer: str

    @property
    def words(self) -> str:
        """Question and answer in one line."""
        return f"asked {asked_words(self.question, self.choices)}, the user answered: {self.answer}"


AskUser: TypeAlias = Callable[[str, tuple[str, ...]], str | None]
"""Asks the user a question with its choices; None, or an answer without words, when nobody answers."""


def asked_words(question: str, choices: tuple[str, ...]) -> str:
    """A question with its choices, in one line."""
    return f'"{question}"' + (f" ({' | '.join(choices)})" if choices else "")
