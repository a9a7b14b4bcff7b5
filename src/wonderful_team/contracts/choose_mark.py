"""ChooseMark: choose one of several numbered marks on the whole view."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownSlot
from wonderful_team.core.pictures import Candidates, Picture
from wonderful_team.core.values import Target


class MarkChoice(AnswerModel):
    """The number of the best mark."""

    reasoning: str = Reasoning
    number: int | None = Field(description="Number of the best mark; null when no mark is on the target.")


@dataclass(frozen=True, eq=False)
class ChooseMark(Question):
    """Asked of the Grounding Manager, after independent proposals.

    Attributes:
        view: The whole main view, with exactly one Candidates mark.
        instruction: What the user wants, in words.
    """

    any_size: ClassVar[bool] = True
    target: Target
    purpose: Literal["centre", "place"]
    plan: tuple[str, ...]
    view: Picture
    examples: tuple[ShownSlot, ...] = ()
    instruction: str = ""

    def output(self) -> type[AnswerModel]:
        return MarkChoice

    @property
    def candidates(self) -> Candidates:
        return candidates_of(self.view)

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.number is not None:
            self.candidates.at(answer.number)
        return answer, ()


def candidates_of(picture: Picture) -> Candidates:
    """The one Candidates mark of a picture."""
    marks = [mark for mark in picture.marks if isinstance(mark, Candidates)]
    if len(marks) != 1:
        raise ValueError(f"picture {picture.name!r} must carry exactly one set of candidates, it has {len(marks)}")
    return marks[0]
