"""Asking a model about pictures with known marks, and getting its own numbers back untouched."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from wonderful_team.agents import build_request
from wonderful_team.contracts import AnswerModel, Question, ReadScene, SceneReading
from wonderful_team.contracts.shown import known, unique
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Answer, Part, Request, Words
from wonderful_team.errors import ModelOutputError
from wonderful_team.lab.fit import Sighting
from wonderful_team.lab.marks import MarkedScene
from wonderful_team.models.around import AroundModel
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import DEADLINE_S, ModelClient, call_model
from wonderful_team.models.conventions import PIXELS, Convention
from wonderful_team.models.profiles import Profile

Thinking = str | None


class MakeModel(Protocol):
    """Makes the model under test, set up by a profile and a thinking level."""

    def __call__(self, profile: Profile | None, thinking: Thinking) -> Model: ...


@dataclass(frozen=True, eq=False)
class Loose(Question):
    """A question whose places are not checked: they are what is measured."""

    inner: ReadScene

    def output(self) -> type[AnswerModel]:
        return SceneReading

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        ids = [item.id for item in answer.targets]
        unique(ids, "target ids")
        known(ids, [target.id for target in self.inner.targets], "target")
        return answer, ()


class Plain(AroundModel):
    """The model under test, asked the question itself; all else that it says of itself stands."""

    async def answer(self, request: Request) -> Any:
        question = request.question
        asked = replace(request, question=question.inner) if isinstance(question, Loose) else request
        return await call_model(self.model, asked)


@dataclass
class Bench:
    """Where a model is asked: one budget for everything, answers kept for what they tell by the way.

    Attributes:
        provider: The model is a service: it has a convention of its own, which a profile sets.
    """

    make: MakeModel
    provider: bool
    budget: Budget
    concurrency: int = 4
    attempts: int = 2
    deadline_s: float = DEADLINE_S
    answers: list[Answer] = field(default_factory=list)
    _asked: int = 0
    _made: list[Model] = field(default_factory=list)

    def model(self, profile: Profile | None = None, thinking: Thinking = None) -> Model:
        """The model under test, set up anew."""
        made = self.make(profile, thinking)
        self._made.append(made)
        return made

    async def aclose(self) -> None:
        """Close the connections of every model that was made."""
        for model in self._made:
            close = getattr(model, "aclose", None)
            if close is not None:
                await close()
        self._made.clear()

    async def ask(self, model: Model, request: Request) -> Answer:
        """One answer through the client: capped, deadlined, its form checked."""
        self._asked += 1
        client = ModelClient(
            Plain(model),
            budget=self.budget,
            attempts=self.attempts,
            concurrency=self.concurrency,
            deadline_s=self.deadline_s,
        )
        answer = await client.ask(replace(request, id=f"{request.id}/{self._asked}"))
        self.answers.append(answer)
        return answer


@dataclass(frozen=True, eq=False)
class Seen:
    """What a model said of one scene, in pixels of the picture as its set-up reads them.

    Attributes:
        points_px: Shape (N, 2); NaN where it gave none.
        boxes: None where it gave none, or one whose edges are in the wrong order.
        answer: None when no valid answer came; `problem` says why.
    """

    scene: MarkedScene
    points_px: Array
    boxes: tuple[Box | None, ...]
    answer: Answer | None
    problem: str = ""

    @property
    def answered(self) -> bool:
        """It points at anything at all."""
        return bool(np.isfinite(self.points_px).any())

    def sighting(self, asked: Convention) -> Sighting:
        """The numbers as the model wrote them, when it was asked in the convention `asked`."""
        said = self.points_px.copy()
        there = np.isfinite(said).all(axis=1)
        if there.any():
            said[there] = asked.to_model(said[there], self.scene.picture.size_px)
        return Sighting(self.scene.picture.size_px, true_points(self.scene), said)

    @property
    def errors_px(self) -> Array:
        """Distance of each point to its mark [px], shape (N,); NaN where there is none."""
        return np.asarray(np.linalg.norm(self.points_px - true_points(self.scene), axis=1))

    @property
    def overlaps(self) -> Array:
        """Overlap of each box with the true one (intersection over union), 0 without a box; shape (N,)."""
        pairs = zip(self.boxes, self.scene.marks, strict=True)
        return np.array([0.0 if box is None else box.iou(mark.box) for box, mark in pairs])


def true_points(scene: MarkedScene) -> Array:
    """The marks' middles [picture px], shape (N, 2)."""
    return np.array([mark.centre for mark in scene.marks], dtype=float).reshape(-1, 2)


async def look(
    bench: Bench,
    model: Model,
    scene: MarkedScene,
    *,
    labelled: bool = False,
    also: Sequence[Picture] = (),
    last: bool = False,
) -> Seen:
    """Ask where the marks of a scene are. Answers outside the picture are taken as they are.

    Args:
        bench: Where it is asked.
        model: Who is asked.
        scene: What is shown.
        labelled: Draw labelled axes.
        also: Further pictures in the same request.
        last: The scene's picture comes after them, not before.
    """
    picture = scene.picture.marked(Axes()) if labelled else scene.picture
    question = ReadScene(scene.targets(), (), picture, context=tuple(also))
    request = build_request(question, id=f"probe/synthetic{scene.seed}", stage="other")
    if last:
        request = replace(request, parts=_moved_back(request.parts, picture))
    try:
        answer = await bench.ask(model, replace(request, question=Loose(question)))
    except ModelOutputError as error:
        nothing = np.full((len(scene.marks), 2), np.nan)
        return Seen(scene, nothing, (None,) * len(scene.marks), None, str(error))
    return _read(scene, answer)


def convention_of(model: Model) -> Convention:
    """The convention that a model's answers were read in."""
    held = getattr(model, "convention", PIXELS)
    return held if isinstance(held, Convention) else PIXELS


def _read(scene: MarkedScene, answer: Answer) -> Seen:
    reading: SceneReading = answer.value
    by_id = {item.id: item for item in reading.targets}
    points = np.full((len(scene.marks), 2), np.nan)
    boxes: list[Box | None] = []
    for k, target in enumerate(scene.targets()):
        item = by_id.get(target.id)
        if item is not None and item.found and item.points:
            points[k] = item.points[0].point.as_tuple
        box = None
        if item is not None and item.found and item.box is not None:
            given = item.box
            if given.x0 < given.x1 and given.y0 < given.y1:
                box = given.as_box
        boxes.append(box)
    return Seen(scene, points, tuple(boxes), answer)


def _moved_back(parts: Sequence[Part], picture: Picture) -> tuple[Part, ...]:
    """The parts with a picture and its caption after all other pictures."""
    own = [part for part in parts if part is picture or (isinstance(part, Words) and part.says == "caption" and part.picture is picture)]  # fmt: skip
    others = [part for part in parts if all(part is not mine for mine in own)]
    end = max((k for k, part in enumerate(others) if isinstance(part, Picture)), default=-1) + 1
    return (*others[:end], *own, *others[end:])


__all__ = ["Bench", "Loose", "MakeModel", "Seen", "Thinking", "convention_of", "look", "true_points"]
