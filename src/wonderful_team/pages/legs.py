"""What a record says of the tool's way: planned by the gate's profiles, measured by the robot's reports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team.core.geometry import Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import ConfigError
from wonderful_team.record.stored import stored_camera

STRAIGHT_M = 0.001
"""What is less than this off a straight line is on it [m]."""


@dataclass(frozen=True, eq=False)
class Leg:
    """The tool's way in one action.

    Attributes:
        number: Of the action, from 1.
        points_m: Planned, shape (N, 3) [m].
        profile: As the record has it.
        measured_m: Where the robot says that the tool was, shape (M, 3) [m]; none where it did not say.
        off_m: Farthest that a measured position lies from the plan [m]; None without one.
    """

    number: int
    points_m: Array
    profile: Mapping[str, Any]
    measured_m: Array
    off_m: float | None


def executions_of(record: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """What ran of a plan, action by action from its first."""
    found, used = [], 0
    for run in record["planner"]["subgoals"]:
        if run["plan"] == number:
            found += record["planner"]["executions"][used : used + run["actions"]]
        used += run["actions"]
    return found


def camera_of(scene: Mapping[str, Any] | None) -> Camera | None:
    """The camera of an observation's main view; None where the record has none that it can make again."""
    if scene is None:
        return None
    try:
        view = scene.get("stored", {}).get(scene["main"])
        return None if view is None else stored_camera(Path(), view["camera"], "the main view")
    except ConfigError:
        return None


def leg_of(profile: Mapping[str, Any], executed: list[dict[str, Any]]) -> Leg:
    """The way of one profile, with what ran of its plan."""
    points = np.array(profile["points_m"], dtype=np.float64)
    action = profile["action"]
    measured = executed[action]["measured"] if action < len(executed) else {}
    path = positions(measured.get("path_m"))
    end = positions([measured.get("tool_m")]) if profile.get("stays") else np.zeros((0, 3))
    off = [distance_to(point, points) for point in path] + [float(np.linalg.norm(one - points[-1])) for one in end]
    return Leg(action + 1, points, profile, np.vstack([path, end]), max(off) if off else None)


def positions(value: Any) -> Array:
    """Positions that a robot reported, shape (N, 3) [m]; none where it is something else: reports are a user's own."""
    try:
        points = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return np.zeros((0, 3))
    good = points.ndim == 2 and points.shape[1] == 3 and bool(np.isfinite(points).all())
    return points if good else np.zeros((0, 3))


def distance_to(point: Array, path: Array) -> float:
    """From a point to a path of straight pieces, shape (N, 3) [m]."""
    best = float(np.linalg.norm(path - point, axis=1).min())
    for start, end in pairwise(path):
        way = end - start
        length = float(way @ way)
        if length > 0:
            share = min(1.0, max(0.0, float((point - start) @ way) / length))
            best = min(best, float(np.linalg.norm(start + share * way - point)))
    return best


def corners_of(points_m: Array) -> list[int]:
    """Where a path turns, its ends among them, as places in it: what is left when all that lies on a straight line goes."""
    if len(points_m) < 3:
        return list(range(len(points_m)))
    start, way = points_m[0], points_m[-1] - points_m[0]
    length = float(np.linalg.norm(way))
    off = points_m - start
    if length > STRAIGHT_M:
        off = off - np.outer(off @ way, way) / length**2
    worst = int(np.argmax(np.linalg.norm(off, axis=1)))
    if float(np.linalg.norm(off[worst])) <= STRAIGHT_M:
        return [0, len(points_m) - 1]
    return [*corners_of(points_m[: worst + 1])[:-1], *(worst + k for k in corners_of(points_m[worst:]))]


def touches(profile: Mapping[str, Any]) -> bool:
    """Whether what passes comes as near to what is seen as only a tool may that is meant to touch something."""
    clearance, least = profile.get("clearance_m"), profile.get("least_m")
    return clearance is not None and least is not None and clearance <= -least


def millimetres(value_m: float) -> str:
    """A length, with a real minus."""
    return f"{round(1000 * value_m)} mm".replace("-", "\N{MINUS SIGN}")
