"""ChoosePoint: choose an action point among numbered candidates inside and beside a box."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import Field

from wonderful_team.contracts.choose_mark import candidates_of
from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownSlot
from wonderful_team.core.pictures import Candidates, Picture
from wonderful_team.core.values import PointRole, Target


class PointChoice(AnswerModel):
    """The number of the best candidate."""

    reasoning: str = Reasoning
    number: int = Field(description="Number of the best candidate.")


@dataclass(frozen=True, eq=False)
class ChoosePoint(Question):
    """Asked of the Grounding Manager, once coarse and once fine.

    Attributes:
        crop: The neighbourhood with the final box as a BoxMark and exactly one Candidates mark; for the start of a push
            with an arrow towards where the thing goes, where that is known.
        fine: Second round: the candidates lie close round the first choice.
        rejected: What was said of the points that are marked as rejected, one line each.
        whole: The whole main view with the box, for a push, and an arrow to where the thing goes, where that is known.
        instruction: What the user wants, in words.
    """

    any_size: ClassVar[bool] = True
    target: Target
    role: PointRole
    plan: tuple[str, ...]
    crop: Picture
    fine: bool = False
    examples: tuple[ShownSlot, ...] = ()
    rejected: tuple[str, ...] = ()
    whole: Picture | None = None
    instruction: str = ""

    @property
    def candidates(self) -> Candidates:
        return candidates_of(self.crop)

    def output(self) -> type[AnswerModel]:
        return PointChoice

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        self.candidates.at(answer.number)
        return answer, ()
