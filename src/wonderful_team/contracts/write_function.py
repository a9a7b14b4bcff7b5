"""WriteFunction: write a small Python function that computes a path from boxes and points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning
from wonderful_team.core.geometry import Box
from wonderful_team.core.later import later
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal

MAX_POINTS = 20
"""Most points a helper function may return (DESIGN, bounds)."""


class FunctionCode(AnswerModel):
    """Python source that defines `path(boxes)`."""

    reasoning: str = Reasoning
    code: str = Field(
        description="Defines path(boxes), which returns a list of (x, y) in pixels of the picture, or of (x, y, up) for a path in "
        "the air that rises, up in m; boxes maps a target id to (x0, y0, x1, y1). Only `math` may be imported.",
        min_length=1,
    )


@dataclass(frozen=True, eq=False)
class EarlierFunction:
    """A function that was accepted earlier in the same trial, as shown.

    Attributes:
        name: What new code may call it by.
        purpose: What it computes, as it was asked for.
        takes: Words of the targets that it was written for, by the ids that it knows them by.
        code: Its source, cut where it is long.
        drawn: What it drew for them.
        up_m: How far up each point of that lies [m]; () for a path that does not rise.
    """

    name: str
    purpose: str
    takes: Mapping[str, str]
    code: str
    drawn: Picture
    up_m: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class WriteFunction(Question):
    """Asked of the Supervisor.

    Attributes:
        boxes: Boxes of the subgoal's targets in pixels of `view`, also drawn there.
        error: What went wrong with the last version: an exception, a bound, or what the review saw; "" at first.
        last_code: The last version; "" at first.
        most_up_m: How far a path in the air may rise over the height at which things are carried [m].
        earlier: Functions that were accepted earlier in the trial, which the code may call.
        advice: What went wrong before; told only beside earlier functions, which may be what went wrong.
        facts: What is known of the robot and its place: how wide its tool is, how much of the table the view spans.
    """

    subgoal: Subgoal
    view: Picture
    boxes: Mapping[str, Box] = field(default_factory=dict)
    error: str = ""
    last_code: str = ""
    max_points: int = MAX_POINTS
    most_up_m: float = later(0.0)
    earlier: tuple[EarlierFunction, ...] = later(())
    advice: tuple[str, ...] = later(())
    facts: tuple[str, ...] = later(())

    def output(self) -> type[AnswerModel]:
        return FunctionCode
