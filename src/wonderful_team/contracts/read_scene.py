"""ReadScene: boxes and points of all targets in one answer, in the model's own format (`lean`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.shown import (
    AnswerModel,
    BoxPx,
    PointPx,
    Question,
    Reasoning,
    ShownSlot,
    Unsure,
    known,
    settle_box,
    settle_point,
    unique,
)
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import PointRole, Target


class RolePoint(AnswerModel):
    """One action point of a target."""

    role: PointRole
    point: PointPx


class SceneTarget(AnswerModel):
    """Where one target is."""

    id: str
    found: bool = Field(description="false when it is not in the picture; box is then null and points are empty.")
    box: BoxPx | None = Field(description="Tight round the target, or round the free spot of an area.")
    points: list[RolePoint] = Field(description="One for each use that the target lists.")
    unsure: str = Unsure


class SceneReading(AnswerModel):
    """All targets, each once."""

    reasoning: str = Reasoning
    targets: list[SceneTarget]


@dataclass(frozen=True, eq=False)
class ReadScene(Question):
    """Asked of the Grounding Manager: find every target at once.

    Attributes:
        view: The whole main view that coordinates refer to.
        context: Other views, for understanding only.
        examples: The instruction's pictures, for targets that are like one of them.
        instruction: What the user wants, in words.
    """

    targets: tuple[Target, ...]
    plan: tuple[str, ...]
    view: Picture
    context: tuple[Picture, ...] = ()
    examples: tuple[ShownSlot, ...] = ()
    instruction: str = ""

    def output(self) -> type[AnswerModel]:
        return SceneReading

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        by_id = {target.id: target for target in self.targets}
        ids = [item.id for item in answer.targets]
        unique(ids, "target ids")
        known(ids, list(by_id), "target")
        if len(ids) < len(by_id):
            raise ValueError(f"every target must be answered; missing: {', '.join(sorted(set(by_id) - set(ids)))}")
        items, repairs = [], []
        for item in answer.targets:
            settled, texts = self._settle_item(item, by_id[item.id])
            items.append(settled)
            repairs += texts
        return answer.model_copy(update={"targets": items}), tuple(repairs)

    def _settle_item(self, item: SceneTarget, target: Target) -> tuple[SceneTarget, list[str]]:
        if not item.found:
            if item.box is not None or item.points:
                raise ValueError(f"{item.id} is said not to be there, yet has a box or points")
            return item, []
        if item.box is None:
            raise ValueError(f"{item.id} is said to be found, yet has no box")
        missing = set(target.roles) - {point.role for point in item.points}
        if missing:
            raise ValueError(f"{item.id} needs a point for: {', '.join(sorted(missing))}")
        box, texts = settle_box(item.box, self.view)
        repairs = list(texts)
        points = []
        for entry in item.points:
            point, texts = settle_point(entry.point, self.view)
            repairs += texts
            points.append(RolePoint(role=entry.role, point=point))
        return item.model_copy(update={"box": box, "points": points}), repairs
