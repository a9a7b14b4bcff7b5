"""The path that each action sweeps through, in metres or in pixels of the main view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wonderful_team.core.actions import Action
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Carry, Drive, Leave, Lost, Motion, Reach, Slide, Stay
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import Limits, PlannedAction


@dataclass(frozen=True, eq=False)
class Sweep:
    """The path of the tool in one action; straight in between.

    Attributes:
        motion: What the action does to the scene.
        path_m: Corners of what the action asks for, shape (N, 3) [m], N >= 1; None for an action that does not move the
            tool, or whose path the world alone knows.
        transit_m: The way from where the tool stands to the first of them, shape (2, 3) [m]; None when that is unknown.
        after_m: Where the tool stands afterwards, shape (3,) [m]; None when only the world knows.
    """

    motion: Motion
    path_m: Array | None
    transit_m: Array | None
    after_m: Array | None


def sweep_of(action: Action, limits: Limits, tool_m: Array | None) -> Sweep:
    """The path of an action.

    Args:
        action: What will run.
        limits: Give the height at which things are carried.
        tool_m: Where the tool stands before, shape (3,), or None when unknown.
    """
    motion = action.motion(tool_m)
    match motion:
        case Carry(start_m=start, end_m=end):
            lifted, over = start.copy(), end.copy()
            lifted[2] = over[2] = limits.carried_z_m(start, end)
            return Sweep(motion, np.array([start, lifted, over, end]), _high(tool_m, lifted), over)
        case Slide(start_m=start, end_m=end):
            over = np.array([*end[:2], max(limits.clearance_m, end[2])])
            above = np.array([*start[:2], max(limits.clearance_m, start[2])])
            return Sweep(motion, np.array([start, end]), _high(tool_m, above), over)
        case Reach(points_m=points):
            transit = None if tool_m is None else np.array([tool_m, points[0]])
            return Sweep(motion, points, transit, np.asarray(points[-1]))
        case Drive(path_m=path) if len(path):
            return Sweep(motion, np.column_stack([path, np.zeros(len(path))]), None, tool_m)
        case Drive() | Stay():
            return Sweep(motion, None, None, tool_m)
        case Leave() | Lost():
            return Sweep(motion, None, None, None)


def _high(tool_m: Array | None, above_m: Array) -> Array | None:
    """The way to a point above a thing: level, at the height of that point or of the tool, whichever is higher."""
    if tool_m is None:
        return None
    height = max(float(tool_m[2]), float(above_m[2]))
    return np.array([[*tool_m[:2], height], [*above_m[:2], height]])


def swept_path_px(planned: PlannedAction) -> tuple[Point, ...]:
    """Points of an action in pixels of the main view, in the order they are visited."""
    return tuple(source.point_px for source in planned.sources)
