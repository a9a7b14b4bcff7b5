"""ListObjects: name everything in the main view with its position, and say in words what the instruction's pictures show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.shown import (
    AnswerModel,
    PointPx,
    Question,
    Reasoning,
    ShownSlot,
    fits,
    known,
    settle_point,
    unique,
)
from wonderful_team.core.pictures import Picture


class NamedPoint(AnswerModel):
    """One thing in the main view."""

    name: str = Field(description="What it is: colour, pattern, shape.", min_length=1)
    point: PointPx = Field(
        description="Its middle; of a ring or a letter, where the middle may be a hole, a point on its material; of what other things go into "
        "(a frame, a pan, a box) the middle of its inside."
    )


class SlotDescription(AnswerModel):
    """What one of the instruction's pictures shows."""

    picture: str = Field(description="Its name, without braces.")
    words: str = Field(description="What it shows, in words alone; of a whole scene, what stands where.", min_length=1)


class ObjectList(AnswerModel):
    """The scene and the instruction's pictures in words."""

    reasoning: str = Reasoning
    objects: list[NamedPoint]
    pictures: list[SlotDescription] = Field(description="Each picture of the instruction once.")


@dataclass(frozen=True, eq=False)
class ListObjects(Question):
    """Asked of a method that plans from a list.

    Attributes:
        view: The whole main view that positions refer to.
        slots: The instruction's pictures.
    """

    view: Picture
    slots: tuple[ShownSlot, ...] = ()

    def output(self) -> type[AnswerModel]:
        return ObjectList

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        fits(targets=len(answer.objects))
        objects, repairs = [], list[str]()
        for item in answer.objects:
            point, texts = settle_point(item.point, self.view)
            objects.append(item.model_copy(update={"point": point}))
            repairs += texts
        pictures = settle_descriptions(answer.pictures, self.slots)
        return answer.model_copy(update={"objects": objects, "pictures": pictures}), tuple(repairs)


def settle_descriptions(given: Sequence[SlotDescription], slots: Sequence[ShownSlot]) -> list[SlotDescription]:
    """Descriptions with their pictures' names as the instruction has them.

    Raises:
        ValueError: A picture is not described, described twice, or none of the instruction's.
    """
    names = [item.picture.strip().strip("{}") for item in given]
    wanted = [slot.name for slot in slots]
    known(names, wanted, "picture")
    unique(names, "pictures")
    missing = [name for name in wanted if name not in names]
    if missing:
        raise ValueError(f"every picture must be described; missing: {', '.join(missing)}")
    return [item.model_copy(update={"picture": name}) for item, name in zip(given, names, strict=True)]
