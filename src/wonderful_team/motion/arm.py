"""Steps of an arm with a gripper: move, open, close, turn, follow a path, go home; and driving a mobile base."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wonderful_team.core.actions import (
    At,
    CloseStep,
    Gripper,
    Home,
    HomeStep,
    MoveStep,
    MoveTo,
    Navigate,
    NavigateStep,
    OpenStep,
    RotateGripper,
    RotateGripperStep,
)
from wonderful_team.core.geometry import Pose, wrap_angle
from wonderful_team.core.values import Fingers, PlannedAction
from wonderful_team.errors import GeometryError
from wonderful_team.motion.deprojector import ResolvedPoint
from wonderful_team.motion.grasp import Displaced, grip_of, seen_of
from wonderful_team.motion.heights import above_z_m, clear_z_m, grasp_z_m
from wonderful_team.motion.pick_place import put_spot
from wonderful_team.motion.places import TO_GRASP, Places
from wonderful_team.motion.sources import source
from wonderful_team.motion.state import Held, MotionState, Moved
from wonderful_team.motion.turns import yaw_of


def ground_move(step: MoveStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """Move the tool; a held thing is carried such that its centre arrives at the place."""
    spot, gripping = _tool_goal(step, places, progress)
    over_m = 0.0
    if gripping and places.limits.fingers is not None and step.height != "clear" and spot.position_m is not None:
        spot, yaw_rad, over_m = _gripped(step.to.target, spot, places, progress, places.limits.fingers)
        progress = replace(progress, yaw_rad=yaw_rad)
    tool = _at_height(step, spot, gripping, places, progress, over_m)
    action = None if tool.position_m is None else MoveTo(Pose.at(tool.position_m, progress.yaw_rad))
    planned = PlannedAction(step, action, (source("waypoint", step.to.target, tool),))
    return planned, replace(progress, tool=tool, height=step.height, over=step.to.target)


def _gripped(
    name: str, spot: ResolvedPoint, places: Places, progress: MotionState, fingers: Fingers
) -> tuple[ResolvedPoint, float, float]:
    """Where the middle between the fingers goes to grip a thing, how the gripper is turned, and how far over what the thing
    stands on the part begins that they grip, from the points of the thing.
    """
    px = places.point(name, TO_GRASP)[1]
    seen = places.lift.surface(px, name).position_m
    assert seen is not None
    assert spot.position_m is not None
    top, support = float(seen[2]), places.support_z_m(name)
    view, displaced = places.lift.view, _displaced(name, places, progress)
    try:
        grip = grip_of(view, places.box(name), px, support, grasp_z_m(top, support), fingers, displaced)
    except GeometryError as problem:
        raise places.fail(f"{name} cannot be gripped: {problem}") from problem
    yaw_rad = wrap_angle(grip.yaw_rad + progress.turn_of(name))
    middle = ResolvedPoint(px, np.array([*grip.centre_m, top]), f"{spot.how}; {replace(grip, yaw_rad=yaw_rad).how}")
    return progress.carry(name, middle, places.lift), yaw_rad, grip.support_z_m - support


def _displaced(name: str, places: Places, progress: MotionState) -> list[Displaced]:
    """What earlier steps have moved, but for the thing itself: the fingers meet it where it is now."""
    found = []
    for other, moves in progress.moved.items():
        target = places.grounded.get(other)
        if other == name or target is None or target.box is None or places.lift.view.depth_m is None:
            continue
        was, points = seen_of(places.lift.view, target.box, places.support_z_m(other))
        for move in moves:
            if move.start_m is not None and move.end_m is not None:
                c, s = np.cos(move.yaw_rad), np.sin(move.yaw_rad)
                turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
                points = (points - move.start_m) @ turn + move.end_m
        found.append(Displaced(was, points))
    return found


def _tool_goal(step: MoveStep, places: Places, progress: MotionState) -> tuple[ResolvedPoint, bool]:
    """Where the tool goes, still on the surface, and whether it goes there to grip a thing."""
    held = progress.held
    if held is None:
        if isinstance(step.to, At):
            role, spot = places.spot(step.to.target, TO_GRASP, progress)
            return spot, role in ("grasp", "pick")
        return places.destination(step.to, progress, None), False
    if step.to == At(held.target) and progress.tool is not None:
        resting = held.support_z_m
        tool = progress.tool
        if tool.position_m is None:
            return ResolvedPoint(tool.px, None, f"over where {held.target} was gripped"), False
        x, y, _ = tool.position_m
        return ResolvedPoint(tool.px, np.array([x, y, resting]), f"where the tool holds {held.target}"), False
    yaw_rad = progress.yaw_rad - held.yaw_rad
    goal = places.destination(step.to, progress, held.target, yaw_rad)
    return put_spot(held.tool, held.centre, goal, yaw_rad, held.target, places.lift.camera), False


def _at_height(
    step: MoveStep, spot: ResolvedPoint, gripping: bool, places: Places, progress: MotionState, over_m: float
) -> ResolvedPoint:
    if spot.position_m is None:
        return spot
    x, y, surface = (float(value) for value in spot.position_m)
    hanging = progress.held.hanging_m if progress.held is not None else 0.0
    match step.height:
        case "at" if gripping:
            z, rule = grasp_z_m(surface, _support_now(places, step.to.target, progress) + over_m), "to grip it"
        case "at":
            z, rule = surface + hanging, "down to it"
        case "above":
            z, rule = above_z_m(surface, places.limits, hanging), "just above"
        case "clear":
            z, rule = clear_z_m([surface, *surfaces_z_m(places)], places.limits, hanging), "clear of everything"
    return ResolvedPoint(spot.px, np.array([x, y, z]), f"{spot.how}; z = {z:.3f} m, {rule}")


def _support_now(places: Places, name: str, progress: MotionState) -> float:
    resting = places.resting(name, progress).position_m
    assert resting is not None
    return float(resting[2])


def surfaces_z_m(places: Places) -> list[float]:
    """Heights of all surfaces at the points that were found."""
    heights = []
    for name, target in places.grounded.items():
        for px in target.points.values():
            position = places.lift.surface(px, name).position_m if places.lift.inside(px) else None
            if position is not None:
                heights.append(float(position[2]))
    return heights


def ground_close(step: CloseStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """Close the gripper; what it was moved down to is held from now on."""
    planned = PlannedAction(step, Gripper("tight" if step.tight else "close"))
    name = progress.over
    if progress.held is not None or progress.height != "at" or name is None or progress.tool is None:
        return planned, progress
    held = Held(
        name,
        progress.tool,
        places.centre(name, progress),
        _support_z_m(places, name, progress),
        progress.yaw_rad,
    )
    return planned, replace(progress, held=held)


def _support_z_m(places: Places, name: str, progress: MotionState) -> float:
    return 0.0 if places.lift.camera is None else _support_now(places, name, progress)


def ground_open(step: OpenStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """Open the gripper; what it held lies where the tool is now."""
    planned = PlannedAction(step, Gripper("open"))
    held, tool = progress.held, progress.tool
    if held is None or tool is None:
        return planned, replace(progress, held=None)
    moved = Moved(
        places.step,
        held.tool.px,
        tool.px,
        held.tool.position_m,
        tool.position_m,
        progress.yaw_rad - held.yaw_rad,
    )
    return planned, replace(progress.with_move(held.target, moved), held=None)


def ground_rotate(step: RotateGripperStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """Turn the gripper; later moves keep the turn."""
    yaw_rad = yaw_of(step.rotate_deg)
    return PlannedAction(step, RotateGripper(yaw_rad)), replace(progress, yaw_rad=progress.yaw_rad + yaw_rad)


def ground_home(step: HomeStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """Go home; the gripper keeps what it holds, at no place of the picture."""
    return PlannedAction(step, Home()), replace(progress, tool=None, height="clear", over=None)


def ground_navigate(step: NavigateStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """Drive straight to a place on the floor."""
    spot = places.destination(step.to, progress, None)
    action = None if spot.position_m is None else Navigate(spot.position_m[None, :2])
    return PlannedAction(step, action, (source("waypoint", step.to.target, spot),)), progress
