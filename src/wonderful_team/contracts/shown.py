"""What questions share: the task as it is shown, and the typed pieces that answers are made of.

A question holds nothing that is not shown: an agent renders every field into words or pictures.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Picture, Point
from wonderful_team.core.values import SlotKind, size_problem

OVERSHOOT = 0.02
"""How far past a picture's side a coordinate may lie and still be clamped (share of that side)."""

INWARD_SHARE, INWARD_PX = 0.05, 1.5
"""How much of a target an edge of its box may cut off: this share of the box's shorter side, at least so many view pixels.

A cut of 4 % changes neither what is found nor where it is held.
"""
OUTWARD_SHARE, OUTWARD_PX = 0.10, 2.5
"""How far an edge may stand away from the target, likewise."""

Edge: TypeAlias = Literal["left", "top", "right", "bottom"]
EDGES: tuple[Edge, ...] = ("left", "top", "right", "bottom")


def _as_asked(schema: dict[str, Any], answer: type[BaseModel]) -> None:
    """A model is asked for every field; a default is for answers that were given before the field was there.

    What a class is for stands in its docstring, for readers of the code; a model is told what its fields are.
    """
    if not getattr(answer, "told", False):
        schema.pop("description", None)
    schema["required"] = list(schema.get("properties", {}))
    for field in schema.get("properties", {}).values():
        field.pop("default", None)


class AnswerModel(BaseModel):
    """Base of every answer: unknown fields are refused.

    Attributes:
        told: The class's docstring stands in the schema.
    """

    told: ClassVar[bool] = False
    # A run needs a few of them: each is built when it is first used.
    model_config = ConfigDict(extra="forbid", frozen=True, json_schema_extra=_as_asked, defer_build=True)


class PointPx(AnswerModel):
    """A point in pixels of the picture shown: x right, y down, from its top-left corner."""

    x: FiniteFloat
    y: FiniteFloat

    @classmethod
    def of(cls, point: Point, picture: Picture) -> Self:
        """A point as an answer, kept inside the picture."""
        width, height = picture.size_px
        return cls(x=min(max(point[0], 0.0), float(width)), y=min(max(point[1], 0.0), float(height)))

    @property
    def as_tuple(self) -> Point:
        return self.x, self.y


class BoxPx(AnswerModel):
    """A box in pixels of the picture shown: left, top, right, bottom edge."""

    x0: FiniteFloat
    y0: FiniteFloat
    x1: FiniteFloat
    y1: FiniteFloat

    @classmethod
    def of(cls, box: Box, picture: Picture) -> Self:
        """A box as an answer, cut at the picture's edges."""
        inside = box.intersection(picture.frame.whole_box) or box
        return cls(x0=inside.x0, y0=inside.y0, x1=inside.x1, y1=inside.y1)

    @property
    def as_box(self) -> Box:
        """Raises ValueError when the edges are in the wrong order."""
        return Box(self.x0, self.y0, self.x1, self.y1)


@dataclass(frozen=True, eq=False)
class ShownSlot:
    """One of the instruction's pictures, as shown.

    Attributes:
        times: How many times as large as in the main view's picture its things are shown; None where that is not known,
            as of a picture that another camera took.
    """

    name: str
    kind: SlotKind
    pictures: tuple[Picture, ...]
    index: int | None = None
    times: float | None = None

    @property
    def whole_scene(self) -> bool:
        """It shows where things are, not what one thing looks like."""
        return self.kind != "object"


@dataclass(frozen=True, eq=False)
class ShownTask:
    """The instruction with its pictures, and the views of the scene; the first view is the main one.

    Attributes:
        facts: What is known of the robot and its place, one fact a line.
        said: What the user said beside the instruction.
        done: What was carried out since the instruction was given, as planned; the views are newer than it.
    """

    instruction: str
    views: tuple[Picture, ...]
    slots: tuple[ShownSlot, ...] = ()
    facts: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    done: tuple[str, ...] = ()

    @property
    def main(self) -> Picture:
        return self.views[0]

    @property
    def slot_names(self) -> tuple[str, ...]:
        return tuple(slot.name for slot in self.slots)


@dataclass(frozen=True)
class Tolerance:
    """How exact an edge of a box has to be, in pixels of the picture that shows it; the edge is the middle of the line.

    Attributes:
        inward_px: The edge may cut off this much of the target.
        outward_px: The edge may stand this far away from the target.
    """

    inward_px: int
    outward_px: int

    @classmethod
    def on(cls, picture: Picture) -> Self:
        """For the box that is drawn on a picture.

        Raises:
            ValueError: None is drawn.
        """
        box = next((mark.box for mark in picture.marks if isinstance(mark, BoxMark)), None)
        if box is None:
            raise ValueError(f"picture {picture.name!r} carries no box to judge")
        side, scale = min(box.width, box.height), picture.frame.scale
        inward, outward = max(INWARD_PX * scale, INWARD_SHARE * side), max(OUTWARD_PX * scale, OUTWARD_SHARE * side)
        return cls(max(1, round(inward)), max(1, round(outward)))

    def words(self, line_px: int) -> str:
        """What the Checker is told; the box's whole line, with its rims, is `line_px` wide."""
        return (
            f"Good enough on this crop, on which the box's whole line is {line_px} px wide: an edge cuts off at most "
            f"{self.inward_px} px of the target, and stands at most {self.outward_px} px away from it."
        )


class Question:
    """Base of all questions. Subclasses are frozen dataclasses.

    Attributes:
        any_size: Nothing that is said or answered counts pixels of the pictures, but for their captions and the Checker's
            tolerance, which are written anew: they may be sent in another size.
    """

    contract: ClassVar[str]
    any_size: ClassVar[bool] = False

    def __init_subclass__(cls) -> None:
        cls.contract = cls.__name__

    def output(self) -> type[AnswerModel]:
        """The type of a right answer to this very question."""
        raise NotImplementedError

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        """Check what the schema cannot, and clamp small overshoots.

        Returns:
            The answer, perhaps clamped, and what was repaired, in words.

        Raises:
            ValueError: The answer does not fit the question; the text goes back to the model.
        """
        return answer, ()


def settle_point(point: PointPx, picture: Picture) -> tuple[PointPx, tuple[str, ...]]:
    """Clamp an overshoot of at most 2 % of a side; refuse more."""
    x, y = (
        _clamp(value, side, name, picture.name)
        for value, side, name in zip(point.as_tuple, picture.size_px, ("x", "y"), strict=True)
    )
    if (x, y) == point.as_tuple:
        return point, ()
    return PointPx(x=x, y=y), (f"point {point.as_tuple} clamped to ({x:.0f}, {y:.0f}) in {picture.name}",)


def settle_box(box: BoxPx, picture: Picture) -> tuple[BoxPx, tuple[str, ...]]:
    """Like settle_point, for the four edges; the edges must be in order and enclose something."""
    width, height = picture.size_px
    values = (
        _clamp(box.x0, width, "x0", picture.name),
        _clamp(box.y0, height, "y0", picture.name),
        _clamp(box.x1, width, "x1", picture.name),
        _clamp(box.y1, height, "y1", picture.name),
    )
    settled = BoxPx(x0=values[0], y0=values[1], x1=values[2], y1=values[3])
    if settled.x0 >= settled.x1 or settled.y0 >= settled.y1:
        raise ValueError(f"box {values}: x0 must be less than x1 and y0 less than y1")
    if settled == box:
        return box, ()
    return settled, (f"box clamped to {tuple(round(v) for v in values)} in {picture.name}",)


def _clamp(value: float, side: int, name: str, where: str) -> float:
    slack = OVERSHOOT * side
    if not -slack <= value <= side + slack:
        raise ValueError(f"{name} = {value:g} lies outside {where}, which spans 0 to {side} px")
    return min(max(value, 0.0), float(side))


def known(names: Iterable[str], allowed: Sequence[str], what: str) -> None:
    """Raise ValueError for names that do not exist, listing those that do."""
    wrong = [name for name in names if name not in allowed]
    if wrong:
        raise ValueError(f"unknown {what} {', '.join(map(repr, wrong))}; valid: {', '.join(allowed) or 'none'}")


def fits(**parts: int) -> None:
    """Raise ValueError when a plan has too many subgoals, targets or actions."""
    problem = size_problem(**parts)
    if problem:
        raise ValueError(f"the plan has {problem}")


def unique(names: Sequence[str], what: str) -> None:
    """Raise ValueError when a name occurs twice."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError(f"{what} must be unique; these occur twice: {', '.join(twice)}")


Reasoning = Field(description="Short: what decides this.")
Unsure: str = Field("", description="What you are not sure of, in one sentence; empty when nothing is in doubt.")
