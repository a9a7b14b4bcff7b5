"""JudgeBox: is this box good, improvable, or on the wrong thing?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownSlot
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Target


class BoxVerdict(AnswerModel):
    """The Checker's word on one box."""

    reasoning: str = Reasoning
    decision: Literal["accept", "revise", "reject"] = Field(
        description="accept: tight on the target; revise: on the target but loose or cut; reject: elsewhere."
    )
    problem: str = Field(description="What should change, in one sentence; empty when accepted.")


@dataclass(frozen=True, eq=False)
class JudgeBox(Question):
    """Asked of the Checker.

    Attributes:
        crop: The neighbourhood of the box, enlarged, with the box as a BoxMark and labelled axes.
    """

    target: Target
    crop: Picture
    examples: tuple[ShownSlot, ...] = ()

    def output(self) -> type[AnswerModel]:
        return BoxVerdict
