"""The errors of one request: drawn from the profile and the request alone."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from typing import Any, Literal, TypeVar

import numpy as np

from wonderful_team.contracts import (
    BoxAnswer,
    BoxMove,
    BoxPx,
    BoxVerdict,
    ChooseMotion,
    DirectPlan,
    MarkChoice,
    MarkSelection,
    MotionMarks,
    MoveBox,
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
from wonderful_team.simulated.profile import Judged, Profile, Rates

T = TypeVar("T")
LEAST_SIDE_PX = 2.0
VERDICTS: tuple[Literal["accept", "revise", "reject"], ...] = ("accept", "revise", "reject")
"""In the order of Rates."""


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
            case MotionMarks():
                return self._marks(value, question)
            case TurnChoice():
                return self._choice(value, len(question.turns))
            case BoxMove():
                return self._move(value, question)
            case RevisionVerdict():
                return self._revision(value)
            case Outcome():
                return self._outcome(value)
        return value

    def point(self, point: PointPx, picture: Picture, what: str) -> PointPx:
        """A point beside the right one, kept inside the picture."""
        off = self._off(picture, what)
        x, y = (
            float(np.clip(a + b, 0.0, side)) for a, b, side in zip(point.as_tuple, off, picture.size_px, strict=True)
        )
        return PointPx(x=x, y=y)

    def _off(self, picture: Picture, what: str) -> tuple[float, float]:
        """By how much a point lies off [px]."""
        profile, rng = self.profile, self._rng(what)
        width, height = picture.size_px
        if not profile.radial:
            dx, dy = rng.normal(profile.bias, profile.spread)
            return float(dx * width), float(dy * height)
        distance = ring_distance(profile.radial, rng.random()) * math.hypot(width, height)
        angle = 2.0 * math.pi * rng.random()
        return distance * math.cos(angle), distance * math.sin(angle)

    def box(self, box: BoxPx | None, picture: Picture, what: str) -> BoxPx | None:
        """A box that lies off, with edges that lie off, kept inside the picture and in order."""
        if box is None or not (self.profile.edge or self.profile.shifts_boxes):
            return box
        dx, dy = self._off(picture, what) if self.profile.shifts_boxes else (0.0, 0.0)
        off = self._rng(f"{what} edges").normal(0.0, self.profile.edge, 4)
        wide, high = box.x1 - box.x0, box.y1 - box.y0
        width, height = picture.size_px
        x0, x1 = np.clip((box.x0 + dx + off[0] * wide, box.x1 + dx + off[2] * wide), 0.0, width)
        y0, y1 = np.clip((box.y0 + dy + off[1] * high, box.y1 + dy + off[3] * high), 0.0, height)
        if x1 - x0 < LEAST_SIDE_PX or y1 - y0 < LEAST_SIDE_PX:
            return box
        return BoxPx(x0=float(x0), y0=float(y0), x1=float(x1), y1=float(y1))

    def _target(self, item: Any, picture: Picture) -> Any:
        # One look tells where a thing is: a box that is shifted takes its points along.
        whole = self.profile.shifts_boxes
        points = [
            RolePoint(
                role=one.role,
                point=self.point(one.point, picture, item.id if whole else f"{item.id} {one.role}"),
            )
            for one in item.points
        ]
        return item.model_copy(update={"box": self.box(item.box, picture, item.id), "points": points})

    def _move(self, value: BoxMove, question: MoveBox) -> BoxMove:
        """A revision by too much or too little; the right one where that would leave no box in the picture."""
        if not self.profile.correction:
            return value
        names = ("right_px", "down_px", "grow_left_px", "grow_top_px", "grow_right_px", "grow_bottom_px")
        shares = self._rng("correction").normal(1.0, self.profile.correction, len(names))
        moved = {name: getattr(value, name) * float(share) for name, share in zip(names, shares, strict=True)}
        revised = value.model_copy(update=moved)
        try:
            question.validate(revised)
        except ValueError:
            return value
        return revised

    def _selection(self, value: MarkSelection, count: int) -> MarkSelection:
        if not value.numbers or not self.draws(self.profile.wrong_choice, "choice"):
            return value
        order = self._rng("other").permutation(count) + 1
        return value.model_copy(update={"numbers": [int(number) for number in order[: len(value.numbers)]]})

    def _marks(self, value: MotionMarks, question: ChooseMotion) -> MotionMarks:
        """Every mark that is chosen may be another of its kind."""
        changed = {}
        for name, letter in (("grasp_keypoint", "P"), ("function_keypoint", "P"), ("target_keypoint", "Q")):
            said, count = getattr(value, name), len(question.keypoints(letter).points)
            if said and self.draws(self.profile.wrong_choice, name):
                changed[name] = self.other(said, [f"{letter}{k}" for k in range(1, count + 1)], f"other {name}")
        for name in ("pre_contact_tile", "post_contact_tile"):
            said = getattr(value, name)
            if said and self.draws(self.profile.wrong_choice, name):
                changed[name] = self.other(said, question.grid.names, f"other {name}")
        return value.model_copy(update=changed)

    def _choice(self, value: Any, count: int) -> Any:
        if value.number is None or not self.draws(self.profile.wrong_choice, "choice"):
            return value
        return value.model_copy(update={"number": self.other(value.number, range(1, count + 1), "other")})

    def verdict(self, right: BoxVerdict, state: Judged, of: str) -> BoxVerdict:
        """What is said of a box in that state, instead of what is right."""
        rates: Rates = getattr(self.profile.judgement, state)
        accepts_wrong = self.profile.judgement.off[0]
        if right.wrong_points and self.draws(accepts_wrong, f"accepts the points {of}"):
            right = right.model_copy(update={"wrong_points": []})
        decision = VERDICTS[min(int(np.searchsorted(np.cumsum(rates), self._rng(f"judges {of}").random())), 2)]
        if decision == right.decision:
            return right
        problem = "" if decision == "accept" else right.problem or "the box looks loose"
        return right.model_copy(update={"decision": decision, "problem": problem})

    def _revision(self, value: RevisionVerdict) -> RevisionVerdict:
        judged = self.profile.judgement
        if value.decision == "take_after_stop" and self.draws(1.0 - judged.tight[0], "refuses"):
            return value.model_copy(update={"decision": "take_after_go_on"})
        if value.decision == "keep_before" and self.draws(judged.off[0], "accepts"):
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


def ring_distance(radial: Sequence[tuple[float, float]], share: float) -> float:
    """The distance that this share of points is nearer than; between two entries points are even over the ring's area."""
    distances, shares = zip((0.0, 0.0), *radial, strict=True)
    return float(np.sqrt(np.interp(share, shares, np.square(distances))))
