"""ReviewPath: does the drawn path do what the subgoal asks?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning
from wonderful_team.core.later import later
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal


class PathReview(AnswerModel):
    """A word on a path."""

    reasoning: str = Reasoning
    accepted: bool
    problem: str = Field(description="What is wrong, in one sentence; empty when accepted.")


@dataclass(frozen=True, eq=False)
class ReviewPath(Question):
    """Asked of the Supervisor after a helper function ran.

    Attributes:
        view: Carries the path as a PathMark.
        up_m: How far over the height at which things are carried each point lies [m]; () for a path that does not rise.
        sides: Other views that carry it too, where it rises.
    """

    any_size: ClassVar[bool] = True
    subgoal: Subgoal
    view: Picture
    up_m: tuple[float, ...] = later(())
    sides: tuple[Picture, ...] = later(())

    def output(self) -> type[AnswerModel]:
        return PathReview

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.accepted == bool(answer.problem):
            raise ValueError("problem must be empty exactly when accepted is true")
        return answer, ()
