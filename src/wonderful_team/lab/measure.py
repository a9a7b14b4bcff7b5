"""How far and how often a model errs at pointing, at giving boxes, and at judging them: counted on scenes whose truth is known."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wonderful_team.agents import build_request
from wonderful_team.contracts import BoxVerdict, JudgeBox, ReadScene, SceneReading
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Picture, Point
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Target, View
from wonderful_team.errors import BudgetReached, ConfigError, ModelOutputError, ModelUnavailableError
from wonderful_team.images import crop, whole
from wonderful_team.images.cut import MARKED_SIDE_PX
from wonderful_team.lab.asking import Bench
from wonderful_team.lab.fit import WILD
from wonderful_team.lab.marks import marked_scene
from wonderful_team.lab.statistics import counted, distributed
from wonderful_team.models.error_profile import (
    STATES,
    WORDS,
    Boxes,
    BoxState,
    BoxWord,
    Confusion,
    Detection,
    ErrorProfile,
    Pointing,
    SceneKind,
)

SIZES = ((640, 480), (960, 540), (512, 683), (800, 600))
ABSENT = 2
"""Things asked for in every drawn scene that are not there."""
JUDGED = 3
"""Targets of each scene whose boxes are judged, each in one state."""


@dataclass(frozen=True)
class LabTarget:
    """One thing that is in a scene: what it is called, its true box and a point on it [view px]."""

    words: str
    box: Box
    point: Point


@dataclass(frozen=True, eq=False)
class LabScene:
    """A view whose truth is known.

    Attributes:
        absent: Words for things that are not there.
        kind: synthetic, or where it was rendered.
    """

    view: View
    targets: tuple[LabTarget, ...]
    absent: tuple[str, ...] = ()
    kind: str = "synthetic"
    seed: int = 0


@dataclass
class _Tally:
    """What was counted so far."""

    radial: list[float] = field(default_factory=list)
    offsets: list[tuple[float, float]] = field(default_factory=list)
    wild_points: int = 0
    points: int = 0
    overlaps: list[float] = field(default_factory=list)
    edges: list[float] = field(default_factory=list)
    wild_boxes: int = 0
    boxes: int = 0
    missed: int = 0
    present: int = 0
    imagined: int = 0
    absent: int = 0
    verdicts: dict[BoxState, dict[BoxWord, int]] = field(
        default_factory=lambda: {state: dict.fromkeys(WORDS, 0) for state in STATES}
    )
    failed: int = 0
    requests: int = 0


def synthetic_scenes(count: int, seed: int) -> list[LabScene]:
    """Drawn scenes in sizes as users send them, each with things that are not there."""
    scenes = []
    for k in range(count):
        drawn = marked_scene(seed + k, SIZES[k % len(SIZES)], absent=ABSENT)
        view = View("scene", "scene", 0.0, drawn.picture.rgb)
        targets = tuple(LabTarget(mark.words, mark.box, mark.centre) for mark in drawn.marks)
        scenes.append(LabScene(view, targets, drawn.absent, "synthetic", seed + k))
    return scenes


async def measure_errors(
    bench: Bench,
    model: Model,
    synthetic: int,
    scenes: Sequence[LabScene] = (),
    *,
    seed: int = 1000,
    labelled: bool = False,
    tell: Callable[[str], None] = lambda line: None,
) -> ErrorProfile:
    """Ask about every scene as the team would, and count.

    Args:
        bench: Where it is asked.
        model: Who is asked.
        synthetic: How many scenes to draw.
        scenes: Further ones, such as rendered ones.
        seed: Of the first drawn scene.
        labelled: Whole views carry labelled axes.
        tell: Given a line after every batch of scenes.

    Raises:
        BudgetReached: A cap was met; nothing is kept then, since half a profile would look like a whole one.
    """
    everything = [*synthetic_scenes(synthetic, seed), *scenes]
    if not everything:
        raise ConfigError("to measure errors at least one scene is needed")
    tally = _Tally()
    for start in range(0, len(everything), bench.concurrency):
        batch = everything[start : start + bench.concurrency]
        await asyncio.gather(*(_measure(bench, model, scene, labelled, tally) for scene in batch))
        tell(f"errors: {min(start + bench.concurrency, len(everything))} of {len(everything)} scenes")
    return _profile(tally, everything, seed)


async def _measure(bench: Bench, model: Model, scene: LabScene, labelled: bool, tally: _Tally) -> None:
    await asyncio.gather(_find(bench, model, scene, labelled, tally), _judge(bench, model, scene, tally))


async def _answer(bench: Bench, model: Model, question: Any, name: str, tally: _Tally) -> Any | None:
    """The valid answer's value, or None when there was none."""
    tally.requests += 1
    try:
        return (await bench.ask(model, build_request(question, id=f"probe/{name}", stage="other"))).value
    except BudgetReached:
        raise
    except (ModelOutputError, ModelUnavailableError):
        tally.failed += 1
        return None


async def _find(bench: Bench, model: Model, scene: LabScene, labelled: bool, tally: _Tally) -> None:
    """One ReadScene for all targets and the absent things."""
    words = [target.words for target in scene.targets] + list(scene.absent)
    order = np.random.default_rng(scene.seed).permutation(len(words))
    targets = tuple(Target(f"T{k}", "object", words[i], use=("pick",)) for k, i in enumerate(order, start=1))
    picture = _shown(scene).marked(*((Axes(),) if labelled else ()))
    reading: SceneReading | None = await _answer(bench, model, ReadScene(targets, (), picture), "find", tally)
    if reading is None:
        return
    by_id = {item.id: item for item in reading.targets}
    diagonal = float(np.hypot(*scene.view.size_px))
    for k, i in enumerate(order, start=1):
        item = by_id.get(f"T{k}")
        found = item is not None and item.found
        if i >= len(scene.targets):
            tally.absent += 1
            tally.imagined += found
            continue
        tally.present += 1
        if item is None or not item.found:
            tally.missed += 1
            continue
        truth = scene.targets[i]
        if item.points:
            _count_point(tally, picture.frame.point_to_view(item.points[0].point.as_tuple), truth, scene, diagonal)
        if item.box is not None:
            _count_box(tally, picture.frame.box_to_view(item.box.as_box), truth.box)


def _shown(scene: LabScene) -> Picture:
    """The scene as large as the team is shown its main view."""
    return whole(scene.view, "scene", long_side_px=MARKED_SIDE_PX)


def _count_point(tally: _Tally, point: Point, truth: LabTarget, scene: LabScene, diagonal: float) -> None:
    tally.points += 1
    dx, dy = point[0] - truth.point[0], point[1] - truth.point[1]
    share = float(np.hypot(dx, dy)) / diagonal
    if share > WILD and not truth.box.contains(point):
        tally.wild_points += 1
        return
    width, height = scene.view.size_px
    tally.radial.append(share)
    tally.offsets.append((dx / width, dy / height))


def _count_box(tally: _Tally, box: Box, truth: Box) -> None:
    tally.boxes += 1
    overlap = box.iou(truth)
    tally.overlaps.append(overlap)
    if overlap <= 0:
        tally.wild_boxes += 1
        return
    tally.edges += [abs(box.x0 - truth.x0) / truth.width, abs(box.x1 - truth.x1) / truth.width]
    tally.edges += [abs(box.y0 - truth.y0) / truth.height, abs(box.y1 - truth.y1) / truth.height]


async def _judge(bench: Bench, model: Model, scene: LabScene, tally: _Tally) -> None:
    """Boxes in known states, judged by the Checker's question."""
    rng = np.random.default_rng([scene.seed, 7])
    chosen = rng.permutation(len(scene.targets))[:JUDGED]
    for turn, i in enumerate(chosen):
        state = STATES[(scene.seed + turn * 2) % len(STATES)]
        box = perturbed(scene, int(i), state, rng)
        if box is None:
            continue
        truth = scene.targets[i]
        shown = crop(scene.view, box, "crop", also=(truth.box,) if state != "elsewhere" else ())
        view_axes = Axes(_shown(scene).frame)
        marked = shown.marked(view_axes, BoxMark(shown.frame.box_to_picture(box)))
        question = JudgeBox(Target("T1", "object", truth.words, use=("pick",)), marked)
        verdict: BoxVerdict | None = await _answer(bench, model, question, "judge", tally)
        tally.verdicts[state]["no answer" if verdict is None else verdict.decision] += 1


def perturbed(scene: LabScene, index: int, state: BoxState, rng: np.random.Generator) -> Box | None:
    """The true box of a target, brought into a state; None where that cannot be done in this scene."""
    width, height = scene.view.size_px
    box = scene.targets[index].box
    dx, dy = 0.0, 0.0
    if state == "loose":
        grow = 0.45
        box = box.grown(grow * box.width, grow * box.height, grow * box.width, grow * box.height)
    elif state == "cut":
        side = int(rng.integers(4))
        cuts = [-0.35 * (box.width if k % 2 == 0 else box.height) if k == side else 0.0 for k in range(4)]
        box = box.grown(*cuts)
    elif state == "shifted":
        angle = float(rng.uniform(0, 2 * np.pi))
        dx, dy = 0.5 * box.width * float(np.cos(angle)), 0.5 * box.height * float(np.sin(angle))
        box = box.shifted(dx, dy)
    elif state == "elsewhere":
        others = [target.box for k, target in enumerate(scene.targets) if k != index and target.box.iou(box) == 0]
        if not others:
            return None
        box = others[int(rng.integers(len(others)))]
    held = box.intersection(Box(0, 0, width, height))
    return held if held is not None and min(held.width, held.height) >= 2 else None


def _profile(tally: _Tally, scenes: Sequence[LabScene], seed: int) -> ErrorProfile:
    offsets = np.asarray(tally.offsets, dtype=float).reshape(-1, 2)
    bias = offsets.mean(axis=0) if len(offsets) else np.zeros(2)
    spread = offsets.std(axis=0, ddof=1) if len(offsets) > 1 else np.zeros(2)
    good: dict[BoxWord, int] = tally.verdicts["tight"]
    bad = [tally.verdicts[state] for state in STATES if state != "tight"]
    judged_bad = [sum(row[word] for row in bad) for word in WORDS]
    kinds = list(dict.fromkeys(scene.kind for scene in scenes))
    return ErrorProfile(
        scenes=[
            SceneKind(
                kind=kind,
                seeds=[scene.seed for scene in scenes if scene.kind == kind],
                targets=sum(len(scene.targets) for scene in scenes if scene.kind == kind),
            )
            for kind in kinds
        ],
        detection=Detection(
            missed=counted(tally.missed, tally.present), imagined=counted(tally.imagined, tally.absent)
        ),
        pointing=Pointing(
            radial=distributed(tally.radial, seed),
            bias=(round(float(bias[0]), 6), round(float(bias[1]), 6)),
            spread=(round(float(spread[0]), 6), round(float(spread[1]), 6)),
            wild=counted(tally.wild_points, tally.points),
            wild_beyond=WILD,
        ),
        boxes=Boxes(
            iou=distributed(tally.overlaps, seed),
            edge=distributed(tally.edges, seed),
            wild=counted(tally.wild_boxes, tally.boxes),
        ),
        judgement=Confusion(
            counts=tally.verdicts,
            wrongly_accepted=counted(judged_bad[0], sum(judged_bad[:3])),
            wrongly_refused=counted(good["revise"] + good["reject"], good["accept"] + good["revise"] + good["reject"]),
        ),
        failed_requests=counted(tally.failed, tally.requests),
    )


__all__ = ["LabScene", "LabTarget", "measure_errors", "perturbed", "synthetic_scenes"]
