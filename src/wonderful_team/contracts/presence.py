"""Presence: does the target reach into the strips just inside and just outside each edge of a box?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field

from wonderful_team.contracts.shown import EDGES, AnswerModel, Edge, Question, Reasoning, ShownSlot
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Target


@dataclass(frozen=True, eq=False)
class Strip:
    """A thin picture along one edge of the box, the right way up, inside or outside of it."""

    edge: Edge
    side: Literal["inside", "outside"]
    picture: Picture


class EdgePresence(AnswerModel):
    """What one edge's two strips show."""

    edge: Edge
    inside: bool = Field(description="Some of the target shows in the strip just inside this edge.")
    outside: bool = Field(description="Some of the target shows in the strip just outside this edge.")


class PresenceAnswer(AnswerModel):
    """All four edges, each once."""

    reasoning: str = Reasoning
    edges: list[EdgePresence]


@dataclass(frozen=True, eq=False)
class Presence(Question):
    """Asked of the Grounding Manager beside the first JudgeBox (`paper`). A strip that would lie outside the
    view is left out, and its side is then answered false.
    """

    any_size: ClassVar[bool] = True
    target: Target
    strips: tuple[Strip, ...]
    examples: tuple[ShownSlot, ...] = ()

    def output(self) -> type[AnswerModel]:
        return PresenceAnswer

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if sorted(item.edge for item in answer.edges) != sorted(EDGES):
            raise ValueError(f"edges must hold each of {', '.join(EDGES)} once")
        return answer, ()
