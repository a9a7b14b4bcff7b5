"""MoveBox: move or resize a box: direction, amount, and which edges still cut the target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field, FiniteFloat

from wonderful_team.contracts.presence import Strip
from wonderful_team.contracts.shown import AnswerModel, Edge, Question, Reasoning, ShownSlot
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Picture
from wonderful_team.core.values import Target


class BoxMove(AnswerModel):
    """A revision of a box, in pixels of the crop."""

    reasoning: str = Reasoning
    action: Literal["move", "resize", "stop"] = Field(
        description="move: shift the whole box; resize: move single edges; stop: it is right (only where offered)."
    )
    right_px: FiniteFloat = Field(description="move: how far right (negative: left). Else 0.")
    down_px: FiniteFloat = Field(description="move: how far down (negative: up). Else 0.")
    grow_left_px: FiniteFloat = Field(description="resize: how far the left edge goes outward (negative: inward).")
    grow_top_px: FiniteFloat
    grow_right_px: FiniteFloat
    grow_bottom_px: FiniteFloat
    cut_edges: list[Edge] = Field(description="Edges at which the target still reaches past the box as it was.")

    def apply(self, box: Box) -> Box:
        """The revised box, in the same pixels. Raises ValueError when nothing would be left of it."""
        match self.action:
            case "move":
                return box.shifted(self.right_px, self.down_px)
            case "resize":
                return box.grown(self.grow_left_px, self.grow_top_px, self.grow_right_px, self.grow_bottom_px)
            case "stop":
                return box


@dataclass(frozen=True, eq=False)
class MoveBox(Question):
    """Asked of the Mover.

    Attributes:
        crop: The neighbourhood with the current box as a BoxMark, and labelled axes in crop pixels.
        strips: Inside and outside strips of the four edges.
        problem: What the Checker found wrong.
        history: Earlier revisions of this box and what became of them, one line each.
        may_stop: The Mover decides itself when it is done (Checker switched off).
    """

    target: Target
    crop: Picture
    strips: tuple[Strip, ...]
    problem: str = ""
    history: tuple[str, ...] = ()
    may_stop: bool = False
    examples: tuple[ShownSlot, ...] = ()

    @property
    def box(self) -> Box:
        """The current box in crop pixels."""
        return next(mark.box for mark in self.crop.marks if isinstance(mark, BoxMark))

    def output(self) -> type[AnswerModel]:
        return BoxMove

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.action == "stop":
            if not self.may_stop:
                raise ValueError("action 'stop' is not offered here: propose a move or a resize")
            return answer, ()
        revised = answer.apply(self.box)
        if revised.as_tuple == self.box.as_tuple:
            raise ValueError("the revision changes nothing: amounts must not all be 0")
        if revised.intersection(self.crop.frame.valid) is None:
            raise ValueError(f"the revised box {tuple(round(v) for v in revised.as_tuple)} lies outside the picture")
        return answer, ()
