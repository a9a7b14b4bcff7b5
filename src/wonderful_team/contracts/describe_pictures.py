"""DescribePictures: say in words what the instruction's pictures show, for a planner that sees none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.list_objects import SlotDescription, settle_descriptions
from wonderful_team.contracts.shown import AnswerModel, Question, ShownSlot


class PictureWords(AnswerModel):
    """The instruction's pictures in words."""

    pictures: list[SlotDescription] = Field(description="Each picture of the instruction once.")


@dataclass(frozen=True, eq=False)
class DescribePictures(Question):
    """Asked for methods whose planner is given text alone. The scene itself is not shown.

    Attributes:
        slots: The instruction's pictures.
    """

    slots: tuple[ShownSlot, ...]

    def output(self) -> type[AnswerModel]:
        return PictureWords

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        return answer.model_copy(update={"pictures": settle_descriptions(answer.pictures, self.slots)}), ()
