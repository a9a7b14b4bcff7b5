"""Several things that go to one place: each gets a part of it of its own."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from wonderful_team.core.actions import (
    At,
    CloseStep,
    MoveStep,
    OpenStep,
    PickPlaceStep,
    Place,
    RotateGripperStep,
    Step,
)
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
FARTHER = (1.0, 1.2, 1.4, 1.6, 1.8, 2.0)
"""The same where something stands in the middle, between them."""
AMID = 1.3
"""The same under a lid: so far apart that one may fall a little askew beside the other, and no farther, since no wall is seen."""
GRID = 8
"""So many points along each side of a place say how high its floor usually is."""
TURNS = 24
"""Directions in which a group of things is tried."""
WAY_PX = 2.0
"""Least distance of the pixels at which the floor of a free area is followed from its point."""
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


@dataclass(frozen=True)
class _Stay:
    """A thing that is brought to a place.

    Attributes:
        steps: Numbers of the steps that bring it there, from 1.
        until: Number of the step at which it is taken away again.
    """

    thing: str
    place: str
    yaw_rad: float
    steps: tuple[int, ...]
    until: int


def shared_places(steps: Sequence[Step]) -> dict[int, Share]:
    """For each step, by its number from 1, that puts a thing where others lie at the same time: its share."""
    stays: dict[str, list[_Stay]] = {}
    carries = _carries(steps)
    for k, one in enumerate(carries):
        until = next((other.steps[0] for other in carries[k + 1 :] if other.thing == one.thing), len(steps) + 1)
        if one.place not in ("", one.thing):
            stays.setdefault(one.place, []).append(replace(one, until=until))
    shares: dict[int, Share] = {}
    for group in (group for there in stays.values() for group in _together(there)):
        things, yaws = tuple(stay.thing for stay in group), tuple(stay.yaw_rad for stay in group)
        shares |= {number: Share(things, yaws, k) for k, stay in enumerate(group) for number in stay.steps}
    return shares


def _carries(steps: Sequence[Step]) -> list[_Stay]:
    """Everything that is carried, in order; the place is "" where it is not a target's own."""
    found: list[_Stay] = []
    over, held, moves, yaw = "", "", list[tuple[int, str]](), 0.0
    for number, step in enumerate(steps, start=1):
        match step:
            case PickPlaceStep(pick=pick, place=place, rotate_deg=turn):
                found.append(_Stay(pick, _target(place), yaw_of(turn), (number,), 0))
            case MoveStep(to=to, height=height):
                over = to.target if height == "at" and isinstance(to, At) else ""
                moves.append((number, _target(to)))
            case CloseStep() if not held:
                held, moves, yaw = over, [], 0.0
            case RotateGripperStep(rotate_deg=turn):
                yaw += yaw_of(turn)
            case OpenStep() if held:
                end = moves[-1][1] if moves else ""
                bring = tuple(at for at, target in moves if target == end)
                found.append(_Stay(held, end, yaw, bring or (number,), 0))
                held = ""
    return found


def _target(place: Place) -> str:
    return place.target if isinstance(place, At) else ""


def _together(stays: list[_Stay]) -> list[list[_Stay]]:
    """Stays, in order of arrival, that overlap in time; only groups of two or more."""
    groups: list[list[_Stay]] = []
    end = 0
    for stay in stays:
        if groups and stay.steps[0] < end:
            groups[-1].append(stay)
        else:
            groups.append([stay])
        end = max(end, stay.until)
    return [group for group in groups if len(group) > 1]


def parts_of(
    place: GroundedTarget,
    centre: Point,
    sizes: Sequence[tuple[float, float]],
    lift: Deprojector,
    uncovered: bool = False,
) -> list[Point]:
    """A point for each thing on a place, clear of the others; the one point for all where there is no room.

    Args:
        place: Where they go. A free area has no outline: there the floor that is seen at its point is the place.
        centre: Its chosen point [px].
        sizes: Half width and height of each thing [px].
        lift: The view.
        uncovered: What shows at that point, such as a lid, will have left it: the floor is not seen.
    """
    if place.box is None and lift.view.depth_m is None:
        return [centre] * len(sizes)
    reach = [(half_x + half_y) / 2 for half_x, half_y in sizes]
    pairs = [one + other for one, other in zip(reach, [*reach[1:], reach[0]], strict=True)]
    ring = (max(pairs) + LEAST_GAP_PX) / (2 * math.sin(math.pi / len(sizes)))
    heights: dict[Point, float] = {}
    floors = _floors(place.box, centre, lift)
    if floors == [None] and place.box is None:
        return [centre] * len(sizes)
    tries: list[tuple[float | None, tuple[float, ...]]] = [*zip(floors, (CLOSER, FARTHER, FARTHER), strict=False)]
    if uncovered and place.box is not None:
        # A lid is wider than the opening under it, and its handle keeps nothing from the middle.
        tries = [(None, (AMID, *CLOSER))]
    for floor_m, shares in tries:
        for share in shares:
            found = []
            for turn in range(TURNS):
                angles = [2 * math.pi * (turn / TURNS + k / len(sizes)) for k in range(len(sizes))]
                offsets = [(share * ring * math.cos(angle), share * ring * math.sin(angle)) for angle in angles]
                # Round the point; of a free area, which may end at a wall just beside its point, also with the first of them on it.
                middles = [(0.0, 0.0), *([] if place.box is not None else [offsets[0]])]
                for dx, dy in middles:
                    points = [(centre[0] + x - dx, centre[1] + y - dy) for x, y in offsets]
                    discs = list(zip(points, reach, strict=True))
                    if not all(_rests(point, radius, place.box, floor_m, lift, heights) for point, radius in discs):
                        continue
                    if place.box is not None or all(_no_wall(centre, *disc, lift, heights) for disc in discs):
                        found.append(points)
            if found:
                return max(found, key=lambda points: _off_the_edge_px(points, place.box))
    return [centre] * len(sizes)


def _off_the_edge_px(points: Sequence[Point], box: Box | None) -> int:
    """How far from the edge of their place points lie at least, in whole pixels: what shows as its floor may be as wide as its walls."""
    if box is None:
        return 0
    return round(min(min(x - box.x0, box.x1 - x, y - box.y0, box.y1 - y) for x, y in points))


def _floors(box: Box | None, centre: Point, lift: Deprojector) -> list[float | None]:
    """Heights that a place's floor may have [m]: what shows at its point, or, where something stands there, round it."""
    seen = lift.surface(centre, "floor").position_m
    if seen is None or lift.view.depth_m is None:
        return [None]
    if box is None:
        return [float(seen[2])]
    shares = [(k + 0.5) / GRID for k in range(GRID)]
    spots = [(box.x0 + box.width * a, box.y0 + box.height * b) for a in shares for b in shares]
    heights = [
        float(at[2]) for px in spots if lift.inside(px) and (at := lift.surface(px, "floor").position_m) is not None
    ]
    if not heights:
        return [float(seen[2])]
    # A box round a thing that lies askew shows much beside it: its median may be the edge of the thing, and what most of it shows its floor.
    level = np.array(heights)
    most = float(level[np.argmax((np.abs(level[:, None] - level) <= LEVEL_M).sum(axis=1))])
    lower = [one for one in dict.fromkeys((float(np.median(level)), most)) if one < float(seen[2]) - LEVEL_M]
    return [float(seen[2]), *lower]


def _rests(
    point: Point,
    radius_px: float,
    box: Box | None,
    floor_m: float | None,
    lift: Deprojector,
    heights: dict[Point, float],
) -> bool:
    """Whether a disc lies wholly on the floor of a place: at one height where that is seen, else within its outline.

    `heights` keeps what was looked up [m]; most discs are out at their first spots, and the others are then not looked up.
    """
    spots = [point, *((point[0] + radius_px * x, point[1] + radius_px * y) for x, y in ROUND)]
    if not all(lift.inside(spot) and (box is None or box.contains(spot)) for spot in spots):
        return False
    if floor_m is not None:
        return all(abs(_height_m(spot, lift, heights) - floor_m) <= LEVEL_M for spot in spots)
    assert box is not None  # an area has a floor that is seen
    half = np.array([box.width, box.height]) / 2 * WITHIN
    return all(np.hypot(*((np.array(spot) - box.centre) / half)) <= 1 for spot in spots)


def _no_wall(centre: Point, point: Point, radius_px: float, lift: Deprojector, heights: dict[Point, float]) -> bool:
    """Whether a disc is reached from an area's point over its floor alone: beyond a box's wall may lie a table that is as high."""
    floor_m = _height_m(centre, lift, heights)
    for x, y in ROUND:
        end = (point[0] + radius_px * x, point[1] + radius_px * y)
        count = 1 + int(math.dist(centre, end) / WAY_PX)
        way = [
            (centre[0] + (end[0] - centre[0]) * k / count, centre[1] + (end[1] - centre[1]) * k / count)
            for k in range(1, count)
        ]
        if not all(abs(_height_m(spot, lift, heights) - floor_m) <= LEVEL_M for spot in way):
            return False
    return True


def _height_m(spot: Point, lift: Deprojector, heights: dict[Point, float]) -> float:
    if spot not in heights:
        position_m = lift.surface(spot, "floor").position_m
        assert position_m is not None  # there is a camera
        heights[spot] = position_m[2]
    return heights[spot]


def share_px(
    share: Share,
    place: GroundedTarget,
    boxes: Sequence[Box | None],
    centre: Point,
    lift: Deprojector,
    uncovered: bool,
) -> Point:
    """Where the centre of one of several things goes that share a place [px]; arguments as for `parts_of`."""
    sizes = [half_extents(box, yaw) for box, yaw in zip(boxes, share.yaws_rad, strict=True)]
    with _lock:
        known = _parts.setdefault(lift.view, {})
    key = (None if place.box is None else place.box.as_tuple, centre, tuple(sizes), uncovered)
    if key not in known:
        known[key] = tuple(parts_of(place, centre, sizes, lift, uncovered))
    return known[key][share.index]
