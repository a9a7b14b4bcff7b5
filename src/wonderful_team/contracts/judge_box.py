"""JudgeBox: is this box good, improvable, or on the wrong thing, and do the points on it serve their uses?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownSlot, known, unique
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import PointRole, Target


class WrongPoint(AnswerModel):
    """A point at which its use would fail."""

    use: PointRole = Field(description="The use that stands at the point on the crop.")
    why: str = Field(description="What is wrong, and where the point should be, in one sentence.", min_length=1)


class BoxVerdict(AnswerModel):
    """The Checker's word on one box and the points that go with it."""

    reasoning: str = Reasoning
    decision: Literal["accept", "revise", "reject"] = Field(
        description="accept: good as it is, every edge within the limits where some are told; revise: on the target, but not so; reject: elsewhere."
    )
    problem: str = Field(description="What should change about the box, in one sentence; empty when accepted.")
    wrong_points: list[WrongPoint] = Field(
        default_factory=list, description="Points that would not serve their use; empty for none."
    )


class OutlineVerdict(BoxVerdict):
    """The Checker's word on a box on which no points are drawn."""

    wrong_points: SkipJsonSchema[list[WrongPoint]] = Field(default_factory=list)


@dataclass(frozen=True, eq=False)
class JudgeBox(Question):
    """Asked of the Checker.

    Attributes:
        crop: The neighbourhood of the box, enlarged, with the box as a BoxMark, the action points that were chosen
            with it as PointMarks labelled by their use, and labelled axes.
        uses: Uses of the points that are drawn; none where points are chosen later.
        whole: The whole main view with the box, where only its surroundings tell the target from others like it.
        alike: Another thing of the same description, whose box was accepted, cut from the main view.
        goal: The same part of the instruction's scene, with the same box, where that scene defines the target.
    """

    any_size: ClassVar[bool] = True
    target: Target
    crop: Picture
    examples: tuple[ShownSlot, ...] = ()
    uses: tuple[PointRole, ...] = ()
    whole: Picture | None = None
    alike: Picture | None = None
    goal: Picture | None = None

    def output(self) -> type[AnswerModel]:
        return BoxVerdict if self.uses else OutlineVerdict

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        wrong = [item.use for item in answer.wrong_points]
        known(wrong, self.uses, "use of a point on the crop")
        unique(wrong, "wrong_points")
        return answer, ()
