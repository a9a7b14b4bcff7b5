"""The path that each action sweeps through, in metres or in pixels of the main view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wonderful_team.core.actions import Action, EndEffectorDelta, MoveTo, Navigate, PickPlace, Push, Trajectory
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import Limits, PlannedAction


def carry_height_m(action: PickPlace, limits: Limits) -> float:
    """Height at which a picked object travels [m]: the world's clearance, or higher where an end lies higher."""
    return float(max(limits.clearance_m, action.pick_m[2], action.place_m[2]))


@dataclass(frozen=True, eq=False)
class Sweep:
    """The path of the tool in one action; straight in between.

    Attributes:
        path_m: Corners of what the action asks for, shape (N, 3) [m], N >= 1; None for an action that does not move the
            tool, or whose path the world alone knows.
        transit_m: The way from where the tool stands to the first of them, shape (2, 3) [m]; None when that is unknown.
        after_m: Where the tool stands afterwards, shape (3,) [m]; None when only the world knows.
    """

    path_m: Array | None
    transit_m: Array | None
    after_m: Array | None


def sweep_of(action: Action, limits: Limits, tool_m: Array | None) -> Sweep:
    """The path of an action.

    Args:
        action: What will run.
        limits: Gives the clearance at which things are carried.
        tool_m: Where the tool stands before, shape (3,), or None when unknown.
    """
    match action:
        case PickPlace():
            carry = carry_height_m(action, limits)
            lifted, over = action.pick_m.copy(), action.place_m.copy()
            lifted[2] = over[2] = carry
            path = np.array([action.pick_m, lifted, over, action.place_m])
            return Sweep(path, _high(tool_m, lifted), over)
        case Push():
            over = np.array([*action.end_m[:2], max(limits.clearance_m, action.end_m[2])])
            above = np.array([*action.start_m[:2], max(limits.clearance_m, action.start_m[2])])
            return Sweep(np.array([action.start_m, action.end_m]), _high(tool_m, above), over)
        case MoveTo():
            return _straight(tool_m, action.pose.position_m[None])
        case Trajectory():
            return _straight(tool_m, action.waypoints_m)
        case Navigate():
            if len(action.path_m) == 0:
                return Sweep(None, None, tool_m)
            return Sweep(np.column_stack([action.path_m, np.zeros(len(action.path_m))]), None, tool_m)
        case EndEffectorDelta():
            if tool_m is None:
                return Sweep(None, None, None)
            return _straight(tool_m, (tool_m + action.v7[:3])[None])
    return Sweep(None, None, None if action.kind == "home" else tool_m)


def _straight(tool_m: Array | None, points_m: Array) -> Sweep:
    return Sweep(points_m, None if tool_m is None else np.array([tool_m, points_m[0]]), np.asarray(points_m[-1]))


def _high(tool_m: Array | None, above_m: Array) -> Array | None:
    """The way to a point above a thing: level, at the height of that point or of the tool, whichever is higher."""
    if tool_m is None:
        return None
    height = max(float(tool_m[2]), float(above_m[2]))
    return np.array([[*tool_m[:2], height], [*above_m[:2], height]])


def swept_path_px(planned: PlannedAction) -> tuple[Point, ...]:
    """Points of an action in pixels of the main view, in the order they are visited."""
    return tuple(source.point_px for source in planned.sources)
