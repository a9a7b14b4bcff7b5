"""JudgeFromBoxes: was a task completed? Judged from where a detector found things before and after, without a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.plan_from_list import SlotWords
from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning


@dataclass(frozen=True)
class FoundBox:
    """A thing that a detector found, in pixels of the picture that the question names.

    Attributes:
        name: What was looked for.
        x, y: The middle of its box.
        length, width: Of the tightest turned rectangle round it.
        angle_deg: Of its longer side, clockwise from the x axis, 0 to 179.
    """

    name: str
    x: int
    y: int
    length: int
    width: int
    angle_deg: int


class TaskVerdict(AnswerModel):
    """Whether the task is completed, and for another attempt what went wrong."""

    reasoning: str = Reasoning
    completed: bool
    summary: str = Field(
        description="Where it failed: what was attempted, what went wrong, what to do differently; empty when completed."
    )


@dataclass(frozen=True, eq=False)
class JudgeFromBoxes(Question):
    """Asked after a program's motions ran.

    Attributes:
        instruction: Its words; names in braces stand for pictures.
        slot_words: What these pictures show.
        picture, size_px: The picture whose pixels positions are, by name and size.
        before, after: Everything that was found of the names that the program looked for.
    """

    instruction: str
    slot_words: tuple[SlotWords, ...]
    picture: str
    size_px: tuple[int, int]
    before: tuple[FoundBox, ...]
    after: tuple[FoundBox, ...]

    def output(self) -> type[AnswerModel]:
        return TaskVerdict

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if not answer.completed and not answer.summary.strip():
            raise ValueError("a task that is not completed needs a summary of what went wrong")
        return answer, ()
