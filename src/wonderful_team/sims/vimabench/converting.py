"""Our actions to the benchmark's and back.

Its spatula comes down 2 cm behind the first point that it is told and stops 5 cm before the second; ours starts and
ends with the front of the blade at the points themselves. Measured on four pushes, the front then lies within 7 mm of
where it should be at both ends, which is how exactly its arm moves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Limits

LOW_XY_M, HIGH_XY_M = (0.25, -0.5), (0.75, 0.5)
TOP_M = 0.3
STARTS_BEHIND_M = 0.02
STOPS_BEFORE_M = 0.05
BLADE_M = 0.05
"""Width of its spatula: as the file of Ravens has it, whose arm and tools the benchmark uses; not measured."""
SHORTEST_M = 0.005
"""The shortest push; one without length keeps the benchmark's arm busy for 20 s."""
ROUNDING_M = 1e-4
"""Overshoot that is taken for rounding and clipped."""
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
PICK_LIMITS = Limits((*LOW_XY_M, 0.0), (*HIGH_XY_M, TOP_M))
PUSH_LIMITS = Limits(
    (LOW_XY_M[0] - STARTS_BEHIND_M, LOW_XY_M[1] - STARTS_BEHIND_M, 0.0),
    (HIGH_XY_M[0] + STARTS_BEHIND_M, HIGH_XY_M[1] + STARTS_BEHIND_M, TOP_M),
    blade_m=BLADE_M,
)
"""Of a push: the blade can come down 2 cm behind the table's edge to push a block that lies close to it."""


@dataclass(frozen=True, eq=False)
class Converted:
    """An action as the benchmark takes it; `end_m` is where the blade's front then stops, for a push."""

    arrays: Mapping[str, Array]
    end_m: Array | None = None


def converted(action: PickPlace | Push) -> Converted | str:
    """The benchmark's action, or why the arm cannot do it."""
    return _picked(action) if isinstance(action, PickPlace) else _pushed(action)


def push_of(arrays: Mapping[str, Sequence[float]]) -> Push:
    """The push that becomes this action of the benchmark."""
    first, last = (np.array(arrays[f"pose{k}_position"], dtype=float)[:2] for k in (0, 1))
    way = (last - first) / np.linalg.norm(last - first)
    start, end = first - STARTS_BEHIND_M * way, last - STOPS_BEFORE_M * way
    return Push(np.array([*start, 0.0]), np.array([*end, 0.0]))


def pick_of(arrays: Mapping[str, Sequence[float]]) -> PickPlace:
    """The pick and place that becomes this action of the benchmark."""
    first, last = arrays["pose0_position"], arrays["pose1_position"]
    _, _, z, w = arrays["pose1_rotation"]
    return PickPlace(np.array([*first[:2], 0.0]), np.array([*last[:2], 0.0]), 2 * math.atan2(z, w))


def _picked(action: PickPlace) -> Converted | str:
    for role, point in (("pick", action.pick_m), ("place", action.place_m)):
        if far := _out_of_reach(role, point, PICK_LIMITS):
            return far
    half = action.yaw_rad / 2
    return Converted(_arrays(action.pick_m, action.place_m, (0.0, 0.0, math.sin(half), math.cos(half))))


def _pushed(action: Push) -> Converted | str:
    for role, point in (("start", action.start_m), ("end", action.end_m)):
        if far := _out_of_reach(role, point, PUSH_LIMITS):
            return far
    start, end = action.start_m[:2], action.end_m[:2]
    length = float(np.linalg.norm(end - start))
    if length < SHORTEST_M:
        return f"a push of {length:.4f} m has no direction; the shortest is {SHORTEST_M} m"
    way = (end - start) / length
    first = start + STARTS_BEHIND_M * way
    if far := _out_of_reach(f"the point {STARTS_BEHIND_M} m after the start", first, PICK_LIMITS):
        return f"{far}; the spatula is told that point"
    # The second point that it is told must lie on the table: near an edge the push is cut short, its way kept.
    room = min(_room(float(at), float(along), axis) for axis, (at, along) in enumerate(zip(first, way, strict=True)))
    travel = min(length, room - STOPS_BEFORE_M + STARTS_BEHIND_M)
    if travel < SHORTEST_M:
        return (
            f"only {max(travel, 0.0):.3f} m of this push fit: the spatula is told a point {STOPS_BEFORE_M} m "
            f"past its end, and that must lie within x {LOW_XY_M[0]} to {HIGH_XY_M[0]} m, y {LOW_XY_M[1]} to {HIGH_XY_M[1]} m"
        )
    stop = start + travel * way
    return Converted(_arrays(first, stop + STOPS_BEFORE_M * way, UPRIGHT), stop)


def _arrays(first: Array, last: Array, turned: Sequence[float]) -> dict[str, Array]:
    low, high = np.array(LOW_XY_M, np.float32), np.array(HIGH_XY_M, np.float32)
    return {
        "pose0_position": np.clip(np.asarray(first[:2], np.float32), low, high),
        "pose0_rotation": np.array(UPRIGHT, np.float32),
        "pose1_position": np.clip(np.asarray(last[:2], np.float32), low, high),
        "pose1_rotation": np.clip(np.array(turned, np.float32), -1.0, 1.0),
    }


def _out_of_reach(role: str, point: Array, limits: Limits) -> str:
    for axis in (0, 1):
        low, high, value = limits.low_m[axis], limits.high_m[axis], float(point[axis])
        if not low - ROUNDING_M <= value <= high + ROUNDING_M:
            return f"{role} {'xy'[axis]} = {value:.3f} m is out of reach [{low}, {high}] m"
    return ""


def _room(at: float, along: float, axis: int) -> float:
    """How far one can go from a point along a unit vector before this coordinate leaves the table [m]."""
    if abs(along) < 1e-9:
        return math.inf
    return ((HIGH_XY_M[axis] if along > 0 else LOW_XY_M[axis]) - at) / along
