"""The errors of one request: drawn from the profile and the request alone."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from wonderful_team.contracts import (
    BoxAnswer,
    BoxPx,
    BoxVerdict,
    BoxVerdicts,
    DirectPlan,
    MarkChoice,
    MarkSelection,
    ObjectList,
    Outcome,
    PointChoice,
    PointPx,
    Points,
    RevisionVerdict,
    RolePoint,
    SceneReading,
    TurnChoice,
)
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Request
from wonderful_team.simulated.profiles import Profile

T = TypeVar("T")
LEAST_SIDE_PX = 2.0


class ErrorSampler:
    """Draws errors."""

    def __init__(self, profile: Profile, request: Request) -> None:
        self.profile = profile
        seen = request.pictures[0].hash if request.pictures else ""
        self._key = f"{request.id}|{request.sample}|{request.attempt}|{seen}"

    def draws(self, rate: float, what: str) -> bool:
        """Whether an error of this rate happens here."""
        return rate > 0.0 and bool(self._rng(what).random() < rate)

    def other(self, right: T, among: Sequence[T], what: str) -> T:
        """Another one than the right one, where there is any."""
        others = [one for one in among if one != right]
        return others[int(self._rng(what).integers(len(others)))] if others else right

    def _rng(self, what: str) -> np.random.Generator:
        return np.random.default_rng([self.profile.seed, zlib.crc32(f"{self._key}|{what}".encode())])

    def perturb(self, value: Any, request: Request) -> Any:
        """A right answer with the profile's errors in its numbers, choices and verdicts."""
        question = request.question
        match value:
            case Points():
                points = [self.point(point, question.view, f"point {k}") for k, point in enumerate(value.points)]
                return value.model_copy(update={"points": points})
            case BoxAnswer():
                return value.model_copy(update={"box": self.box(value.box, question.view, "box")})
            case SceneReading() | DirectPlan():
                return value.model_copy(
                    update={"targets": [self._target(item, question.view) for item in value.targets]}
                )
            case MarkChoice() | PointChoice():
                return self._choice(value, len(question.candidates.points))
            case ObjectList():
                objects = [
                    item.model_copy(update={"point": self.point(item.point, question.view, f"{k} {item.name}")})
                    for k, item in enumerate(value.objects)
                ]
                return value.model_copy(update={"objects": objects})
            case MarkSelection():
                return self._selection(value, len(question.candidates.points))
            case TurnChoice():
                return self._choice(value, len(question.turns))
            case BoxVerdict():
                return self._verdict(value)
            case BoxVerdicts():
                boxes = [
                    item.model_copy(update={"verdict": self._verdict(item.verdict, f" {item.target}")})
                    for item in value.boxes
                ]
                return value.model_copy(update={"boxes": boxes})
            case RevisionVerdict():
                return self._revision(value)
            case Outcome():
                return self._outcome(value)
        return value

    def point(self, point: PointPx, picture: Picture, what: str) -> PointPx:
        """A point beside the right one, kept inside the picture."""
        profile, rng = self.profile, self._rng(what)
        moved = [
            float(np.clip(at + side * rng.normal(bias, spread), 0.0, side))
            for at, side, bias, spread in zip(
                point.as_tuple, picture.size_px, profile.bias, profile.spread, strict=True
            )
        ]
        return PointPx(x=moved[0], y=moved[1])

    def box(self, box: BoxPx | None, picture: Picture, what: str) -> BoxPx | None:
        """A box whose edges lie off, kept inside the picture and in order."""
        if box is None or not self.profile.edge:
            return box
        off = self._rng(what).normal(0.0, self.profile.edge, 4)
        wide, high = box.x1 - box.x0, box.y1 - box.y0
        width, height = picture.size_px
        x0, x1 = np.clip((box.x0 + off[0] * wide, box.x1 + off[2] * wide), 0.0, width)
        y0, y1 = np.clip((box.y0 + off[1] * high, box.y1 + off[3] * high), 0.0, height)
        if x1 - x0 < LEAST_SIDE_PX or y1 - y0 < LEAST_SIDE_PX:
            return box
        return BoxPx(x0=float(x0), y0=float(y0), x1=float(x1), y1=float(y1))

    def _target(self, item: Any, picture: Picture) -> Any:
        points = [
            RolePoint(role=one.role, point=self.point(one.point, picture, f"{item.id} {one.role}"))
            for one in item.points
        ]
        return item.model_copy(update={"box": self.box(item.box, picture, item.id), "points": points})

    def _choice(self, value: Any, count: int) -> Any:
        if value.number is None or not self.draws(self.profile.wrong_choice, "choice"):
            return value
        return value.model_copy(update={"number": self.other(value.number, range(1, count + 1), "other")})

    def _selection(self, value: MarkSelection, count: int) -> MarkSelection:
        if not value.numbers or not self.draws(self.profile.wrong_choice, "choice"):
            return value
        order = self._rng("other").permutation(count) + 1
        return value.model_copy(update={"numbers": [int(number) for number in order[: len(value.numbers)]]})

    def _verdict(self, value: BoxVerdict, of: str = "") -> BoxVerdict:
        if value.wrong_points and self.draws(self.profile.accepts_wrong, f"accepts the points{of}"):
            value = value.model_copy(update={"wrong_points": []})
        if value.decision == "accept" and self.draws(self.profile.refuses_right, f"refuses{of}"):
            return value.model_copy(update={"decision": "revise", "problem": "the box looks loose"})
        if value.decision != "accept" and self.draws(self.profile.accepts_wrong, f"accepts{of}"):
            return value.model_copy(update={"decision": "accept", "problem": ""})
        return value

    def _revision(self, value: RevisionVerdict) -> RevisionVerdict:
        if value.decision == "take_after_stop" and self.draws(self.profile.refuses_right, "refuses"):
            return value.model_copy(update={"decision": "take_after_go_on"})
        if value.decision == "keep_before" and self.draws(self.profile.accepts_wrong, "accepts"):
            return value.model_copy(update={"decision": "take_after_stop"})
        return value

    def _outcome(self, value: Outcome) -> Outcome:
        turned = {"done": "not_done", "not_done": "done"}
        verdicts = [
            item.model_copy(update={"status": turned.get(item.status, item.status)})
            if self.draws(self.profile.overlooks, f"outcome {item.subgoal}")
            else item
            for item in value.verdicts
        ]
        return value.model_copy(update={"verdicts": verdicts})
