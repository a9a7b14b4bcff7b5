"""SelectMarks: select the numbered marks that are best placed for one point of a target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.choose_mark import candidates_of
from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownSlot, unique
from wonderful_team.core.pictures import Candidates, Picture
from wonderful_team.core.values import PointRole, Target


class MarkSelection(AnswerModel):
    """The numbers of the best marks."""

    reasoning: str = Reasoning
    numbers: list[int] = Field(description="Best first; none only when the target is not in the picture at all.")


@dataclass(frozen=True, eq=False)
class SelectMarks(Question):
    """Asked of a method that finds a point by narrowing a cloud of marks.

    Attributes:
        role: What the point is for.
        view: The whole main view, with exactly one Candidates mark.
        most: How many marks may be selected.
    """

    target: Target
    role: PointRole
    view: Picture
    most: int
    examples: tuple[ShownSlot, ...] = ()

    def output(self) -> type[AnswerModel]:
        return MarkSelection

    @property
    def candidates(self) -> Candidates:
        """What there is to select from."""
        return candidates_of(self.view)

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if len(answer.numbers) > self.most:
            raise ValueError(f"{len(answer.numbers)} marks selected; at most {self.most} asked for")
        unique([str(number) for number in answer.numbers], "numbers")
        for number in answer.numbers:
            self.candidates.at(number)
        return answer, ()
