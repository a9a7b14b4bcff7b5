"""An answer that could not be read as one: it stands as the value, and the client sends the problem back to the model."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Unreadable:
    """What a model said, when it was no answer.

    Attributes:
        problem: What is wrong with it and what would be valid, in words for the model.
        raw: What it said.
    """

    problem: str
    raw: str
