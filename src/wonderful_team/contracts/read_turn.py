"""ReadTurn: by which of several turns does a thing come to lie as a picture shows it?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning
from wonderful_team.core.pictures import Picture, Tiles
from wonderful_team.core.values import Target


class TurnChoice(AnswerModel):
    """The number of the cut-out that lies as the goal does."""

    reasoning: str = Reasoning
    number: int | None = Field(
        description="Number of the cut-out that lies most nearly as the goal; null when none does."
    )


@dataclass(frozen=True, eq=False)
class ReadTurn(Question):
    """Asked of the Grounding Manager where an angle is shown by pictures alone: once coarse, once fine.

    Attributes:
        target: What is to be turned.
        strip: One picture: how the thing lies in the end, as a BoxMark labelled "goal" (its frame shows that part of the
            goal's view), and beside it the thing cut out and turned, as Tiles; without Tiles, as it lies now.
        turns: Turn of each tile, in order [degrees, clockwise].
        shows: Where the pictures come from.
        fine: Second round: the turns lie close round the first choice.
    """

    target: Target
    strip: Picture
    turns: tuple[float, ...]
    shows: str
    fine: bool = False

    @property
    def tiles(self) -> Tiles:
        """The numbered cut-outs."""
        return next(mark for mark in self.strip.marks if isinstance(mark, Tiles))

    def output(self) -> type[AnswerModel]:
        return TurnChoice

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.number is not None and not 1 <= answer.number <= len(self.turns):
            raise ValueError(f"number {answer.number}: valid are 1 to {len(self.turns)}")
        return answer, ()
