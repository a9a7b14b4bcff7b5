"""LocatePoints: point at a target (or at a spot in an area) on the whole view."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, PointPx, Question, Reasoning, ShownSlot, settle_point
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Target


class Points(AnswerModel):
    """Where the target is, or that it is not there."""

    reasoning: str = Reasoning
    found: bool = Field(description="false when the target is not in the picture.")
    points: list[PointPx]


@dataclass(frozen=True, eq=False)
class LocatePoints(Question):
    """Asked of the Grounding Manager; with the grounding team switched off, of the Supervisor.

    Attributes:
        purpose: centre (of an object) or place (a free, suitable spot in an area).
        plan: The plan's subgoals, one line each.
        view: The whole main view with labelled axes; points that were tried and rejected are marked on it.
        context: Other views, for understanding only.
        examples: The instruction's pictures of this target.
        count: How many points are asked for at most.
        rejected: What was said of the points that are marked as rejected, one line each.
        instruction: What the user wants, in words.
    """

    target: Target
    purpose: Literal["centre", "place"]
    plan: tuple[str, ...]
    view: Picture
    context: tuple[Picture, ...] = ()
    examples: tuple[ShownSlot, ...] = ()
    count: int = 1
    rejected: tuple[str, ...] = ()
    instruction: str = ""

    def output(self) -> type[AnswerModel]:
        return Points

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.found != bool(answer.points):
            raise ValueError("points must be given exactly when found is true")
        if len(answer.points) > self.count:
            raise ValueError(f"{len(answer.points)} points given; at most {self.count} asked for")
        settled = [settle_point(point, self.view) for point in answer.points]
        repairs = tuple(text for _, texts in settled for text in texts)
        return answer.model_copy(update={"points": [point for point, _ in settled]}), repairs
