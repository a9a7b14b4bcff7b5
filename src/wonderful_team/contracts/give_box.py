"""GiveBox: draw a box round a target whose centre is marked on the whole view."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, BoxPx, Question, Reasoning, ShownSlot, settle_box
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Target


class BoxAnswer(AnswerModel):
    """A box, or that the target is not there."""

    reasoning: str = Reasoning
    box: BoxPx | None = Field(description="Tight round the target; null when it is not in the picture.")


@dataclass(frozen=True, eq=False)
class GiveBox(Question):
    """Asked of the Grounding Manager.

    Attributes:
        view: The whole main view with labelled axes and the chosen centre as a PointMark.
        rejected: What was said of the points that are marked as rejected, one line each.
        instruction: What the user wants, in words.
    """

    target: Target
    plan: tuple[str, ...]
    view: Picture
    examples: tuple[ShownSlot, ...] = ()
    rejected: tuple[str, ...] = ()
    instruction: str = ""

    def output(self) -> type[AnswerModel]:
        return BoxAnswer

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        if answer.box is None:
            return answer, ()
        box, repairs = settle_box(answer.box, self.view)
        return answer.model_copy(update={"box": box}), repairs
