"""Paths of helper functions: what is wrong with one before anybody looks at it, and its points in metres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from wonderful_team.core.actions import FollowStep, Trajectory
from wonderful_team.core.pictures import PathPoint, Point, rises_of
from wonderful_team.core.values import GroundedTarget, Limits, PlannedAction, View
from wonderful_team.motion.deprojector import Deprojector, ResolvedPoint
from wonderful_team.motion.heights import clear_z_m
from wonderful_team.motion.places import Places
from wonderful_team.motion.sources import source
from wonderful_team.motion.state import MotionState

MOST_UP_M = 0.3
"""No path in the air rises farther over the height at which things are carried [m]."""
ROUNDING_M = 1e-6
EVEN_M = 0.003
"""Points that lie no farther from a plane lie on it: the rest is noise of depth, and a tool that is led over it would lift off [m]."""


def carried_z_m(grounded: Mapping[str, GroundedTarget], view: View, limits: Limits) -> float:
    """Height at which the tool is clear of everything, whichever of the targets it holds [m]."""
    lift = Deprojector(view)
    tops = [0.0]
    for name, target in grounded.items():
        if target.box is not None and lift.inside(target.box.centre):
            position = lift.surface(target.box.centre, name).position_m
            tops += [] if position is None else [float(position[2])]
    return clear_z_m(tops, limits, max(tops))


def most_up_m(carried_m: float, limits: Limits) -> float:
    """How far a path in the air may rise over the height at which things are carried [m]."""
    return float(np.clip(limits.high_m[2] - carried_m, 0.0, MOST_UP_M))


def seen_from(points: Sequence[PathPoint], carried_m: float, main: View, side: View) -> tuple[Point, ...]:
    """Where a path in the air shows in another view [px]; () where a camera is unknown or the path leaves that view.

    Args:
        points: Pixels of the main view, and how far up [m].
        carried_m: Height at which things are carried [m].
        main: The main view.
        side: The other view.
    """
    lift = Deprojector(main)
    spots = [lift.surface(point[:2], "path").position_m for point in points]
    if side.camera is None or any(spot is None for spot in spots):
        return ()
    heights = [carried_m + up for up in rises_of(points)] or [carried_m] * len(points)
    path = np.column_stack([np.array(spots)[:, :2], heights])
    try:
        pixels = side.camera.project(path)
    except ValueError:
        return ()
    found = tuple((float(x), float(y)) for x, y in pixels)
    return found if all(Deprojector(side).inside(px) for px in found) else ()


def path_problem(points: Sequence[PathPoint], view: View, limits: Limits, up_m: float) -> str:
    """What keeps a path from being followed: a point outside the view or the workspace, or one that rises too far; "" when nothing.

    Args:
        points: Pixels of the view.
        view: The main view.
        limits: The workspace.
        up_m: How far it may rise [m].
    """
    lift = Deprojector(view)
    width, height = view.size_px
    for number, point in enumerate(points, start=1):
        px = point[:2]
        if not lift.inside(px):
            return f"point {number} lies outside the picture"
        position = lift.surface(px, "path").position_m
        for axis in range(0 if position is None else 2):
            low, high, value = limits.low_m[axis], limits.high_m[axis], float(position[axis])  # type: ignore[index]
            if not low <= value <= high:
                return (
                    f"point {number} is out of reach: its {'xy'[axis]} = {value:.3f} m in the base frame (valid: {low:.3f} to "
                    f"{high:.3f} m), at {100 * px[0] / width:.0f} % of the picture's width and {100 * px[1] / height:.0f} % of its height"
                )
    for number, up in enumerate(rises_of(points), start=1):
        if not -ROUNDING_M <= up <= up_m + ROUNDING_M:
            return f"point {number} has up = {up:.3f} m; valid: 0 to {up_m:.2f} m over the height at which things are carried"
    return ""


def ground_follow(
    step: FollowStep, places: Places, progress: MotionState, surfaces_z_m: Sequence[float]
) -> tuple[PlannedAction, MotionState]:
    """Follow a path in the air, clear of everything, or on the surface: lowered at its first point, lifted after its last."""
    if step.function not in places.paths:
        known = ", ".join(places.paths) or "none"
        raise places.fail(f"there is no path for function {step.function!r}; paths: {known}")
    points = places.paths[step.function]
    low = step.contact == "surface" or (step.contact is None and progress.height == "at")
    if low and any(rises_of(points)):
        raise places.fail(f"the path {step.function!r} rises, so it is followed in the air; contact: 'air'")
    hanging = progress.held.hanging_m if progress.held is not None else 0.0
    spots = []
    shown = [_seen(step, point, number, places) for number, point in enumerate(points, start=1)]
    for number, (point, seen) in enumerate(zip(points, _evened(shown) if low else shown, strict=True), start=1):
        if seen.position_m is None:
            spots.append(seen)
            continue
        x, y, surface = (float(value) for value in seen.position_m)
        up = point[2] if len(point) == 3 else 0.0
        z = clear_z_m([surface, *surfaces_z_m], places.limits, hanging) + up
        most = places.limits.high_m[2]
        if up and z > most + ROUNDING_M:
            raise places.fail(
                f"point {number} of path {step.function!r} rises by {up:.3f} m to z = {z:.3f} m (limit {most:.3f} m); at most "
                f"{max(0.0, most - z + up):.3f} m are left there"
            )
        risen = f", and {up:.3f} m up" if up else ""
        over = ResolvedPoint(seen.px, np.array([x, y, z]), f"{seen.how}; z = {z:.3f} m, clear of everything{risen}")
        if not low:
            spots.append(over)
            continue
        on_m = surface + hanging
        on = ResolvedPoint(seen.px, np.array([x, y, on_m]), f"{seen.how}; z = {on_m:.3f} m, on the surface")
        first, last = number == 1, number == len(points)
        spots += [on] if step.contact is None else [over, on] if first else [on, over] if last else [on]
    positions = [spot.position_m for spot in spots if spot.position_m is not None]
    action = Trajectory(np.array(positions)) if positions and len(positions) == len(spots) else None
    planned = PlannedAction(step, action, tuple(source("waypoint", step.function, spot) for spot in spots))
    return planned, replace(
        progress,
        tool=spots[-1] if spots else progress.tool,
        height="clear" if step.contact else progress.height,
        over=None,
    )


def _evened(shown: Sequence[ResolvedPoint]) -> Sequence[ResolvedPoint]:
    """Points of a surface, on one plane where all of them lie on it as far as depth tells."""
    points = [one.position_m for one in shown if one.position_m is not None]
    if len(points) < len(shown) or len(points) < 4:
        return shown
    xyz = np.array(points)
    across = np.column_stack([xyz[:, :2] - xyz[:, :2].mean(axis=0), np.ones(len(xyz))])
    even_z = across @ np.linalg.lstsq(across, xyz[:, 2], rcond=None)[0]
    if float(np.abs(even_z - xyz[:, 2]).max()) > EVEN_M:
        return shown
    return [
        replace(one, position_m=np.array([*at[:2], z]), how=f"{one.how}, on one plane with the others")
        for one, at, z in zip(shown, xyz, even_z, strict=True)
    ]


def _seen(step: FollowStep, point: PathPoint, number: int, places: Places) -> ResolvedPoint:
    """The surface that shows at a point of a path."""
    px = point[:2]
    if not places.lift.inside(px):
        width, height = places.lift.view.size_px
        raise places.fail(
            f"point {number} of path {step.function!r} at ({px[0]:.0f}, {px[1]:.0f}) px lies outside the view of {width} x {height} px"
        )
    return places.lift.surface(px, f"point {number} of the path of {step.function}")
