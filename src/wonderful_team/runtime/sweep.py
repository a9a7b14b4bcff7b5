"""The path that each action sweeps through, in metres or in pixels of the main view."""

from __future__ import annotations

import numpy as np

from wonderful_team.actions import (
    Action,
    EndEffectorDelta,
    MoveTo,
    Navigate,
    PickPlace,
    Push,
    Trajectory,
)
from wonderful_team.geometry.arrays import Array
from wonderful_team.pictures import Point
from wonderful_team.types import Limits, PlannedAction


def carry_height_m(action: PickPlace, limits: Limits) -> float:
    """Height at which a picked object travels [m]: the world's clearance, or higher where an end lies higher."""
    return float(max(limits.clearance_m, action.pick_m[2], action.place_m[2]))


def swept_path_m(action: Action, limits: Limits, tool_m: Array | None) -> Array | None:
    """Corners of the path of the tool, shape (N, 3) [m], N >= 1; straight in between.

    Args:
        action: What will run.
        limits: Gives the clearance at which things are carried.
        tool_m: Where the tool stands before, shape (3,), or None when unknown: then the way to the first point is
            left out.

    Returns:
        None for an action that does not move the tool or whose path the world alone knows (home).
    """
    match action:
        case PickPlace():
            carry = carry_height_m(action, limits)
            lifted, over = action.pick_m.copy(), action.place_m.copy()
            lifted[2] = over[2] = carry
            return np.array([action.pick_m, lifted, over, action.place_m])
        case Push():
            return np.array([action.start_m, action.end_m])
        case MoveTo():
            return _from_tool(tool_m, action.pose.position_m[None])
        case Trajectory():
            return _from_tool(tool_m, action.waypoints_m)
        case Navigate():
            if len(action.path_m) == 0:
                return None
            return np.column_stack([action.path_m, np.zeros(len(action.path_m))])
        case EndEffectorDelta() if tool_m is not None:
            return np.array([tool_m, tool_m + action.v7[:3]])
    return None


def tool_after(action: Action, tool_m: Array | None) -> Array | None:
    """Where the tool stands after the action, shape (3,) [m], or None when only the world knows."""
    match action:
        case MoveTo():
            return action.pose.position_m
        case Trajectory():
            return np.asarray(action.waypoints_m[-1])
        case EndEffectorDelta():
            return None if tool_m is None else tool_m + action.v7[:3]
        case PickPlace() | Push():
            return None
        case _:
            return None if action.kind == "home" else tool_m


def swept_path_px(planned: PlannedAction) -> tuple[Point, ...]:
    """Points of an action in pixels of the main view, in the order they are visited."""
    return tuple(source.point_px for source in planned.sources)


def _from_tool(tool_m: Array | None, points_m: Array) -> Array:
    return points_m if tool_m is None else np.vstack([tool_m[None], points_m])
