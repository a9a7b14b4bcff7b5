"""By how much a thing was turned between two pictures, from its pixels."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.vision import Thing

SIDE_PX = 96
STEP_DEG = 3.0
CLEARLY = 0.05
"""A turn is told from another when it fits better by this much (0 to 1)."""


def turned_deg(before: Picture, was: Thing, after: Picture, now: Thing, asked_deg: float) -> float | None:
    """Clockwise turn [degrees, 0 to 360) that fits best; the one asked for where it fits as well as the best.

    None when every turn fits about equally, as for a plain disc.
    """
    first, second = _patch(before, was), _patch(after, now)
    best = common_turn_deg([(before, was, after, now)])
    if best is None:
        return None
    asked, most = (_fit(_rotated(first, turn), second) for turn in (asked_deg, best))
    return asked_deg % 360 if asked >= most - CLEARLY * 0.5 else best


def common_turn_deg(pairs: Sequence[tuple[Picture, Thing, Picture, Thing]]) -> float | None:
    """The clockwise turn [degrees, 0 to 360) that fits all pairs (before, thing, after, thing) best; None when all fit alike."""
    turns = np.arange(0.0, 360.0, STEP_DEG)
    fits = np.zeros(len(turns))
    for before, was, after, now in pairs:
        first, second = _patch(before, was), _patch(after, now)
        fits += np.array([_fit(_rotated(first, turn), second) for turn in turns])
    if fits.max() - fits.min() < CLEARLY:
        return None
    return float(turns[int(fits.argmax())])


def _patch(picture: Picture, thing: Thing) -> Array:
    """The thing alone, centred and scaled to a fixed size, shape (SIDE, SIDE, 4): RGB 0..1 and its mask."""
    reach = 0.75 * float(np.hypot(thing.box.width, thing.box.height))
    cx, cy = thing.centre
    scale = SIDE_PX / (2 * reach)
    move = np.array([[scale, 0, SIDE_PX / 2 - scale * cx], [0, scale, SIDE_PX / 2 - scale * cy]])
    rgb = cv2.warpAffine(np.ascontiguousarray(picture.rgb), move, (SIDE_PX, SIDE_PX)).astype(np.float32) / 255
    zoom = thing.zoom
    offset = np.array([[zoom, 0, thing.offset[0] * zoom], [0, zoom, thing.offset[1] * zoom], [0, 0, 1.0]])
    mask = cv2.warpAffine(thing.mask.astype(np.float32), (move @ offset)[:2], (SIDE_PX, SIDE_PX))
    return np.dstack([rgb, mask])


def _rotated(patch: Array, clockwise_deg: float) -> Array:
    turn = cv2.getRotationMatrix2D((SIDE_PX / 2, SIDE_PX / 2), -clockwise_deg, 1.0)
    return np.asarray(cv2.warpAffine(patch, turn, (SIDE_PX, SIDE_PX)))


def _fit(one: Array, other: Array) -> float:
    """How well two patches agree, 0 to 1: outlines over their union, colours where both show."""
    both = np.minimum(one[..., 3], other[..., 3])
    union = np.maximum(one[..., 3], other[..., 3]).sum()
    if union <= 0:
        return 0.0
    outline = float(both.sum() / union)
    apart = np.abs(one[..., :3] - other[..., :3]).mean(axis=2)
    colour = float(1 - (apart * both).sum() / max(float(both.sum()), 1e-6))
    return 0.5 * outline + 0.5 * colour
