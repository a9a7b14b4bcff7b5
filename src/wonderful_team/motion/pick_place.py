"""PickPlace: from a thing's pick point to where its centre is to lie, turned on the way."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.core.actions import PickPlace, PickPlaceStep
from wonderful_team.core.geometry import Camera, PinholeCamera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import PlannedAction
from wonderful_team.motion.deprojector import ResolvedPoint
from wonderful_team.motion.places import TO_PICK, Places
from wonderful_team.motion.sources import source
from wonderful_team.motion.state import MotionState, Moved
from wonderful_team.motion.turns import turned_m, turned_px, yaw_of

SAME_PX = 0.5
"""A tool that ends this close to where the thing's middle lands ends there [px]."""


def ground_pick_place(step: PickPlaceStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """The action for one step.

    A robot that picks at P and puts down at Q moves the thing's centre C to Q + R(yaw)(C - P). So Q is chosen such that
    the centre, not the pick point, lands on the place; a thing that is turned in place turns about its own centre.
    """
    yaw_rad = yaw_of(step.rotate_deg)
    pick = places.spot(step.pick, TO_PICK, progress)[1]
    centre = places.centre(step.pick, progress)
    goal = places.destination(step.place, progress, step.pick, yaw_rad)
    put = put_spot(pick, centre, goal, yaw_rad, step.pick, places.lift.camera)
    moved = Moved(places.step, pick.px, put.px, _on_support(pick, places, step.pick, progress), put.position_m, yaw_rad)
    action = None
    if pick.position_m is not None and put.position_m is not None:
        action = PickPlace(pick.position_m, put.position_m, yaw_rad)
    turned = f"; turned {step.rotate_deg:g} degrees clockwise, as the step states" if step.rotate_deg else ""
    planned = PlannedAction(
        step,
        action,
        (
            source("pick", step.pick, pick),
            source(
                "place",
                step.place.target,
                ResolvedPoint(goal.px, put.position_m, put.how + turned),
                put.px if math.dist(put.px, goal.px) >= SAME_PX else None,
            ),
        ),
    )
    return planned, progress.with_move(step.pick, moved)


def put_spot(
    tool: ResolvedPoint,
    centre: ResolvedPoint,
    goal: ResolvedPoint,
    yaw_rad: float,
    name: str,
    camera: Camera | None,
) -> ResolvedPoint:
    """Where the tool has to end so that the thing's centre ends at `goal`; heights are left to the caller's goal."""
    dx, dy = turned_px((centre.px[0] - tool.px[0], centre.px[1] - tool.px[1]), yaw_rad)
    px = (goal.px[0] - dx, goal.px[1] - dy)
    if tool.position_m is None or centre.position_m is None or goal.position_m is None:
        return ResolvedPoint(px, None, goal.how)
    shift = -turned_m(centre.position_m - tool.position_m, yaw_rad)
    position = goal.position_m + np.array([shift[0], shift[1], 0.0])
    how = goal.how
    if np.hypot(shift[0], shift[1]) > 5e-4:
        how += f"; shifted ({shift[0]:+.3f}, {shift[1]:+.3f}) m so that the centre of {name} lands there"
        if isinstance(camera, PinholeCamera):
            # Pixels at the thing's top are wider than those at the height where it is put.
            at, there = camera.project([goal.position_m, position])
            px = (goal.px[0] + float(there[0] - at[0]), goal.px[1] + float(there[1] - at[1]))
    return ResolvedPoint(px, position, how)


def _on_support(pick: ResolvedPoint, places: Places, name: str, progress: MotionState) -> Array | None:
    """The pick point at the height of what the thing stands on now."""
    if pick.position_m is None:
        return None
    resting = places.resting(name, progress).position_m
    assert resting is not None
    return np.array([pick.position_m[0], pick.position_m[1], resting[2]])
