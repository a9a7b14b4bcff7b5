"""Measuring a box against what a crop or an edge strip shows, from that picture's own pixels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.images.colours import COLOURS, memberships, to_lab
from wonderful_team.offline.description import Description
from wonderful_team.offline.vision.resolve import FITS, suits
from wonderful_team.offline.vision.scene import see, shrink, working_zoom
from wonderful_team.offline.vision.table import find_table
from wonderful_team.offline.vision.things import _BINS, Example, Thing

Side: TypeAlias = Literal["left", "top", "right", "bottom"]
SIDES: tuple[Side, ...] = ("left", "top", "right", "bottom")

SURE = FITS
"""Score from which a thing alone in a crop is taken for the target: the same as in a scene, so that what was found there
is not judged absent in its own crop."""

TIGHT = 0.72
"""Intersection over union with the measured outline from which a box is good."""


@dataclass(frozen=True, eq=False)
class BoxFit:
    """How a box stands to what its crop shows; coordinates are pixels of the crop.

    Attributes:
        verdict: tight | loose (on the target, but cutting it or with room) | other (on another thing) |
            empty (on bare table, the target shows elsewhere in the crop) | absent (the target does not show).
        why: In words.
        target: The thing that fits the description best; None when absent.
        best: Its measured outline's box; None when absent.
        iou: Intersection over union of the box and `best`; 0 when absent.
        under: The thing that the box mostly covers, whatever it is; None for bare table.
        cut: Edges past which the target reaches out of the box.
        loose: Edges that leave room round the target.
        score: How well the target fits the description, 0 to 1.
    """

    verdict: Literal["tight", "loose", "other", "empty", "absent"]
    why: str
    target: Thing | None = None
    best: Box | None = None
    iou: float = 0.0
    under: Thing | None = None
    cut: tuple[Side, ...] = ()
    loose: tuple[Side, ...] = ()
    score: float = 0.0


@dataclass(frozen=True)
class StripFit:
    """Whether a target shows in a strip: the share of pixels that fit it, and the decision."""

    shows: bool
    share: float


def fit_box(
    picture: Picture, box: Box, description: Description, examples: Mapping[str, Example], *, tight: float = TIGHT
) -> BoxFit:
    """Judge a box from a crop's own pixels.

    Args:
        picture: The crop.
        box: The box to judge [crop px].
        description: What the box should hold; relations and superlatives are not judged in a crop.
        examples: Studied example pictures by slot name.
        tight: Intersection over union from which the box is good.

    Raises:
        NotSeen: The description is like a picture that is not among the examples.
    """
    scene = see(picture)
    under = _under(scene.things, box)
    rated = [(suits(thing, description, examples, scene.view_scale)[0], thing) for thing in scene.things]
    fitting = [(score, thing) for score, thing in rated if score >= SURE and _whole_enough(thing, box)]
    if not fitting:
        seen = f"the box is on a {under.look.words}" if under is not None else "the box is on bare table"
        return BoxFit("absent", f"nothing in the crop fits; {seen}", under=under)
    top = max(score for score, _ in fitting)
    near = [(score, thing) for score, thing in fitting if score >= 0.8 * top]
    score, target = max(
        near, key=lambda pair: (round(pair[1].box.iou(box), 2), -math.dist(pair[1].box.centre, box.centre), pair[0])
    )
    iou = target.box.iou(box)
    cut, loose = _edges(target.box, box)
    verdict: Literal["tight", "loose", "other", "empty"] = "empty"
    why = "on bare table beside the target"
    if iou >= tight:
        verdict, why = "tight", f"tight on a {target.look.words}"
    elif target.box.intersection(box) is not None and iou >= 0.12 and (under is target or iou >= 0.3):
        cuts = f", cuts it at the {' and '.join(cut)}" if cut else ""
        verdict, why = "loose", f"on a {target.look.words}, overlap {iou:.2f}{cuts}"
    elif under is not None and under is not target:
        verdict, why = "other", f"on a {under.look.words} instead"
    return BoxFit(verdict, why, target, target.box, iou, under, cut, loose, score)


def _under(things: tuple[Thing, ...], box: Box) -> Thing | None:
    """The thing that a box mostly covers."""
    best = max(things, key=lambda thing: thing.box.iou(box), default=None)
    return best if best is not None and best.box.iou(box) > 0.12 else None


def _whole_enough(thing: Thing, box: Box) -> bool:
    """A neighbour cut off by the crop's edge cannot be measured, unless the box itself lies there."""
    return not thing.cut or thing.box.iou(box) > 0.2


def _edges(target: Box, box: Box) -> tuple[tuple[Side, ...], tuple[Side, ...]]:
    """Edges of the box that cut the target, and edges that leave room, beyond a tenth of the target's side."""
    slack_x, slack_y = 0.1 * target.width, 0.1 * target.height
    past = {
        "left": (box.x0 - target.x0) / slack_x,
        "top": (box.y0 - target.y0) / slack_y,
        "right": (target.x1 - box.x1) / slack_x,
        "bottom": (target.y1 - box.y1) / slack_y,
    }
    return tuple(side for side in SIDES if past[side] > 1), tuple(side for side in SIDES if past[side] < -1)


def strip_presence(
    strip: Picture, description: Description, examples: Mapping[str, Example], *, target: Thing | None = None
) -> StripFit:
    """Whether a thin strip along a box's edge shows some of the target, by its colours.

    Args:
        strip: The strip's pixels.
        description: The target in words or like an example.
        examples: Studied example pictures by slot name.
        target: The thing as measured in a crop, when known; its own colours then decide.
    """
    rgb, _, valid = shrink(strip, working_zoom(strip))
    pixels = rgb[valid]
    if len(pixels) == 0:
        return StripFit(False, 0.0)
    histogram = None
    if target is not None:
        histogram = target.look.histogram
    elif description.like is not None and description.like in examples and description.like_only != "shape":
        histogram = examples[description.like].look.histogram
    if histogram is not None:
        share = _histogram_share(to_lab(rgb)[valid], histogram)
    elif description.colours:
        wanted = [COLOURS.index(name) for name in description.colours]
        share = float((memberships(to_lab(rgb)[valid])[:, wanted].sum(axis=1) > 0.6).mean())
    else:
        table = find_table(to_lab(rgb), valid)
        share = float(table.stands_out[valid].mean())
    return StripFit(share > 0.05, float(share))


def _histogram_share(lab: Array, histogram: Array) -> float:
    """Share of pixels (N, 3) whose colour is common in a histogram of square roots."""
    steps = np.array([8.0, 12.0, 12.0])
    index = np.clip(((lab + [0, 102, 102]) / steps).astype(int), 0, np.array(_BINS) - 1)
    mass = histogram[np.ravel_multi_index(tuple(index.T), _BINS)] ** 2
    return float((mass > 0.02).mean())
