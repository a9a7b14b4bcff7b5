"""JudgeBoxes: the boxes of several targets, each on a crop of its own, judged in one answer (`lean`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import Field

from wonderful_team.contracts.judge_box import BoxVerdict, JudgeBox
from wonderful_team.contracts.shown import AnswerModel, Question, known, unique
from wonderful_team.core.values import Target


class TargetVerdict(AnswerModel):
    """The Checker's word on the box of one target."""

    target: str = Field(description="Id of the target.")
    verdict: BoxVerdict


class BoxVerdicts(AnswerModel):
    """A word on every box, each once."""

    boxes: list[TargetVerdict]

    def of(self, name: str) -> BoxVerdict:
        """The verdict on the box of that target."""
        return next(item.verdict for item in self.boxes if item.target == name)


@dataclass(frozen=True, eq=False)
class JudgeBoxes(Question):
    """Asked of the Checker, for boxes of which none is in doubt.

    Attributes:
        boxes: What would be asked of each box alone.
    """

    any_size: ClassVar[bool] = True
    boxes: tuple[JudgeBox, ...]

    @property
    def targets(self) -> tuple[Target, ...]:
        """The targets, in order."""
        return tuple(item.target for item in self.boxes)

    def output(self) -> type[AnswerModel]:
        return BoxVerdicts

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        by_id = {item.target.id: item for item in self.boxes}
        ids = [item.target for item in answer.boxes]
        unique(ids, "target ids")
        known(ids, list(by_id), "target")
        missing = [name for name in by_id if name not in ids]
        if missing:
            raise ValueError(f"every box must be judged; missing: {', '.join(missing)}")
        settled: list[TargetVerdict] = []
        repairs: list[str] = []
        for item in answer.boxes:
            verdict, texts = by_id[item.target].validate(item.verdict)
            settled.append(item.model_copy(update={"verdict": verdict}))
            repairs += texts
        return answer.model_copy(update={"boxes": settled}), tuple(repairs)
