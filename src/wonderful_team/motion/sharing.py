"""Several things that go to one place: each gets a part of it of its own."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from wonderful_team.core.actions import At, PickPlaceStep, Step
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import GroundedTarget, View
from wonderful_team.motion.beside import LEAST_GAP_PX, half_extents
from wonderful_team.motion.deprojector import Deprojector
from wonderful_team.motion.turns import yaw_of

LEVEL_M = 0.006
"""A floor may rise or fall by this much under what is put on it [m]."""
WITHIN = 0.95
"""Without depth, things are kept within this share of the ellipse in a place's box: its walls lie outside."""
CLOSER = (1.0, 0.9, 0.8, 0.7, 0.6)
"""Shares of the distance at which the discs of things would not touch; things are mostly smaller than their discs."""
TURNS = 24
"""Directions in which a group of things is tried."""
ROUND = tuple((math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in range(8))
_lock = threading.Lock()
_parts: WeakKeyDictionary[View, dict[Any, tuple[Point, ...]]] = WeakKeyDictionary()
"""Of each view that still lives: every thing of a group asks for the parts of all, and so does every check of its steps."""


@dataclass(frozen=True)
class Share:
    """One thing's part of a place.

    Attributes:
        things: All that lie there together, by target id, in the order in which they come.
        yaws_rad: How far each is turned on its way.
        index: Which of them this is, from 0.
    """

    things: tuple[str, ...]
    yaws_rad: tuple[float, ...]
    index: int


def shared_places(steps: Sequence[Step]) -> dict[int, Share]:
    """For each step, by its number from 1, that puts a thing where others lie at the same time: its share."""
    stays: dict[str, list[tuple[int, int, str, float]]] = {}
    for number, step in enumerate(steps, start=1):
        if isinstance(step, PickPlaceStep) and isinstance(step.place, At) and step.place.target != step.pick:
            later = (
                k for k, other in enumerate(steps[number:], start=number + 1)
                if isinstance(other, PickPlaceStep) and other.pick == step.pick
            )  # fmt: skip
            stay = (number, next(later, len(steps) + 1), step.pick, yaw_of(step.rotate_deg))
            stays.setdefault(step.place.target, []).append(stay)
    shares: dict[int, Share] = {}
    for group in (group for there in stays.values() for group in _together(there)):
        things, yaws = tuple(stay[2] for stay in group), tuple(stay[3] for stay in group)
        shares |= {stay[0]: Share(things, yaws, k) for k, stay in enumerate(group)}
    return shares


def _together(stays: list[tuple[int, int, str, float]]) -> list[list[tuple[int, int, str, float]]]:
    """Stays, in order of arrival, that overlap in time; only groups of two or more."""
    groups: list[list[tuple[int, int, str, float]]] = []
    end = 0
    for stay in stays:
        if groups and stay[0] < end:
            groups[-1].append(stay)
        else:
            groups.append([stay])
        end = max(end, stay[1])
    return [group for group in groups if len(group) > 1]


def parts_of(
    place: GroundedTarget, centre: Point, sizes: Sequence[tuple[float, float]], lift: Deprojector
) -> list[Point]:
    """A point for each thing on a place, clear of the others; the one point for all where there is no room.

    Args:
        place: Where they go.
        centre: Its chosen point [px].
        sizes: Half width and height of each thing [px].
        lift: The view.
    """
    if place.box is None:
        return [centre] * len(sizes)
    reach = [(half_x + half_y) / 2 for half_x, half_y in sizes]
    pairs = [one + other for one, other in zip(reach, [*reach[1:], reach[0]], strict=True)]
    ring = (max(pairs) + LEAST_GAP_PX) / (2 * math.sin(math.pi / len(sizes)))
    heights: dict[Point, float] = {}
    for share in CLOSER:
        for turn in range(TURNS):
            angles = [2 * math.pi * (turn / TURNS + k / len(sizes)) for k in range(len(sizes))]
            points = [
                (centre[0] + share * ring * math.cos(angle), centre[1] + share * ring * math.sin(angle))
                for angle in angles
            ]
            discs = zip(points, reach, strict=True)
            if all(_rests(point, radius, place.box, centre, lift, heights) for point, radius in discs):
                return points
    return [centre] * len(sizes)


def _rests(
    point: Point, radius_px: float, box: Box, centre: Point, lift: Deprojector, heights: dict[Point, float]
) -> bool:
    """Whether a disc lies wholly on the floor of a place: at one height where that is seen, else within its outline.

    `heights` keeps what was looked up [m]; most discs are out at their first spots, and the others are then not looked up.
    """
    spots = [point, *((point[0] + radius_px * x, point[1] + radius_px * y) for x, y in ROUND)]
    if not all(lift.inside(spot) and box.contains(spot) for spot in spots):
        return False
    if lift.camera is not None and lift.view.depth_m is not None:
        floor_m = _height_m(centre, lift, heights)
        return all(abs(_height_m(spot, lift, heights) - floor_m) <= LEVEL_M for spot in spots)
    half = np.array([box.width, box.height]) / 2 * WITHIN
    return all(np.hypot(*((np.array(spot) - box.centre) / half)) <= 1 for spot in spots)


def _height_m(spot: Point, lift: Deprojector, heights: dict[Point, float]) -> float:
    if spot not in heights:
        position_m = lift.surface(spot, "floor").position_m
        assert position_m is not None  # there is a camera
        heights[spot] = position_m[2]
    return heights[spot]


def share_px(
    share: Share, place: GroundedTarget, boxes: Sequence[Box | None], centre: Point, lift: Deprojector
) -> Point:
    """Where the centre of one of several things goes that share a place [px]."""
    sizes = [half_extents(box, yaw) for box, yaw in zip(boxes, share.yaws_rad, strict=True)]
    with _lock:
        known = _parts.setdefault(lift.view, {})
    key = (None if place.box is None else place.box.as_tuple, centre, tuple(sizes))
    if key not in known:
        known[key] = tuple(parts_of(place, centre, sizes, lift))
    return known[key][share.index]
