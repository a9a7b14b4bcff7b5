"""Two pictures of one camera compared: what changed, what came and what left."""

from __future__ import annotations

import math

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.images.colours import to_lab
from wonderful_team.offline.vision import Thing, likeness, see

SURE = 0.55
"""Likeness from which two pictures show the same thing beyond doubt (0 to 1)."""
STAYED = 0.35
"""A thing that lies nearer to its place than this many of its radii is there."""
CHANGED = 9.0
"""CIELAB distance from which a pixel differs between two pictures of one camera."""
LEFT = 0.5
"""Share of a thing's former place that must show table once it has left."""


def gap_px(one: Point, other: Point) -> float:
    return math.dist(one, other)


def moved_between(before: Picture, after: Picture) -> tuple[Thing, Thing] | None:
    """The thing that both pictures show, in two places, as each of them shows it; None when no one thing stands out.

    What only came to light, since something was taken from above it, was nowhere to be seen before.
    """
    first, second = see(before).things, see(after).things

    def apart(was: Thing, now: Thing) -> float:
        there = before.frame.point_to_view(was.centre)
        here = after.frame.point_to_view(now.centre)
        return gap_px(there, here) * after.frame.scale / now.radius_px

    rated = [(likeness(was, now), apart(was, now), was, now) for was in first for now in second]
    stayed = {now.number for alike, far, _, now in rated if far < STAYED and alike > SURE}
    moved = [(alike, was, now) for alike, far, was, now in rated if far >= STAYED and now.number not in stayed]
    remain = {was.number for alike, far, was, _ in rated if far < STAYED and alike > SURE}
    moved = sorted((item for item in moved if item[1].number not in remain), key=lambda item: -item[0])
    if not moved or moved[0][0] < SURE:
        return None
    return moved[0][1], moved[0][2]


def difference(before: Picture, after: Picture) -> Array:
    """Pixels of the later picture that differ from the earlier one, bool, shape (H, W); noise is left out."""
    first = cv2.resize(np.ascontiguousarray(before.rgb), after.size_px, interpolation=cv2.INTER_AREA)
    gap = np.sqrt(((to_lab(first) - to_lab(np.asarray(after.rgb))) ** 2).sum(axis=-1))
    return np.asarray(cv2.morphologyEx((gap > CHANGED).astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) > 0)


def came_to(before: Picture, after: Picture) -> Box | None:
    """Where something stands in the later picture that was not there before [px of the later picture]; None when nothing is."""
    pair = moved_between(before, after)
    if pair is not None:
        return pair[1].box
    changed = difference(before, after)
    scene = see(after)
    shown = cv2.resize(scene.occupied.astype(np.uint8), after.size_px, interpolation=cv2.INTER_NEAREST) > 0
    new = cv2.morphologyEx((changed & shown).astype(np.uint8), cv2.MORPH_CLOSE, np.ones((9, 9), np.uint8))
    count, _, stats, _ = cv2.connectedComponentsWithStats(new, connectivity=8)
    if count <= 1:
        return None
    biggest = 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
    x, y, width, height, area = (int(v) for v in stats[biggest])
    if area < 0.0004 * new.size:
        return None
    return Box(x, y, x + width, y + height)
