"""Actions of an arm that solve a table, from the truth."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from shapely import box
from shapely.affinity import rotate, translate

from wonderful_team.core.actions import Action, Gripper, Home, MoveTo, PickPlace
from wonderful_team.core.geometry import Pose, wrap_angle
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms.rows import ArmRow
from wonderful_team.sims.arms.scoring import lying
from wonderful_team.sims.tabletop.goals import Poses, footprint_of
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.oracle import solve
from wonderful_team.sims.tabletop.rules import Rules

ABOVE_M, CLEAR_M, GRASP_M = 0.1, 0.25, 0.03
YAWS = 24
LEVEL_M = 0.002
"""Something may end so far over where a thing begins that lies on it [m]."""
ROOM_M = 0.006
"""More than the thing's width the fingers want between them [m]."""


def grasp_yaw(thing: Thing, poses: Poses, things: Mapping[str, Thing], row: ArmRow) -> float | None:
    """The yaw at which the fingers close across the thing's narrowest side without meeting others; None when there is none."""
    own = footprint_of(thing, poses[thing.name])
    a, b = thing.body.grasp_ab
    x, y, _ = (float(v) for v in poses[thing.name].apply([(-b, a, 0.0)])[0])
    others = [
        footprint_of(other, poses[name])
        for name, other in things.items()
        if name != thing.name and other.body.kind != "area" and not _under(other, poses[name], poses[thing.name])
    ]
    found = []
    for yaw in np.linspace(-math.pi / 2, math.pi / 2, YAWS, endpoint=False):
        turned = rotate(translate(own, -x, -y), -math.degrees(yaw), origin=(0, 0))
        slice_ = turned.intersection(box(-row.breadth_m / 2, -1, row.breadth_m / 2, 1))
        width = 2 * max(abs(slice_.bounds[1]), abs(slice_.bounds[3]))
        if width + ROOM_M > row.opening_m:
            continue
        reach = row.opening_m / 2 + row.thickness_m
        fingers = [box(-row.breadth_m / 2, s * row.opening_m / 2, row.breadth_m / 2, s * reach) for s in (1, -1)]
        hit = any(
            translate(rotate(finger, math.degrees(yaw), origin=(0, 0)), x, y).intersects(other)
            for finger in fingers
            for other in others
        )
        found.append((hit, round(width, 3), abs(yaw), float(yaw)))
    return min(found)[3] if found and not min(found)[0] else None


def _under(other: Thing, at: Pose, thing: Pose) -> bool:
    """Whether something ends below where a thing begins, such as a plate that it lies on: the fingers do not meet it."""
    return float(at.position_m[2]) + other.body.height_m <= float(thing.position_m[2]) + LEVEL_M


def arm_actions(pick: PickPlace, yaw_rad: float, height_m: float) -> list[Action]:
    """One pick and place as an arm does it.

    Args:
        pick: Where the thing's top is held, and where it goes.
        yaw_rad: How the gripper is turned to grip.
        height_m: Of the thing.
    """
    grasp = pick.pick_m - np.array([0.0, 0.0, min(GRASP_M, height_m / 2)])
    hanging = float(grasp[2]) - (float(pick.pick_m[2]) - height_m)
    end = np.array([*pick.place_m[:2], float(pick.place_m[2]) + hanging + 0.004])
    turned = wrap_angle(yaw_rad + pick.yaw_rad)

    def to(point: Array, up_m: float, yaw: float) -> MoveTo:
        return MoveTo(Pose.at(point + np.array([0.0, 0.0, up_m]), yaw))

    return [
        Gripper("open"),
        to(grasp, ABOVE_M, yaw_rad),
        to(grasp, 0.0, yaw_rad),
        Gripper("close"),
        to(grasp, CLEAR_M, yaw_rad),
        to(end, max(0.0, CLEAR_M - float(end[2])), turned),
        to(end, 0.0, turned),
        Gripper("open"),
        to(end, max(0.0, CLEAR_M - float(end[2])), turned),
        Home(),
    ]


def solve_things(rules: Rules, poses: Poses, things: Mapping[str, Thing], row: ArmRow) -> Sequence[Action]:
    """Arm actions for every goal that is not met."""
    upright = lying(poses, things)
    actions: list[Action] = []
    believed = dict(upright)
    for pick in solve(rules, rules.start(upright, things), upright, things):
        name = min(
            things,
            key=lambda n: math.dist(believed[n].position_m[:2], pick.pick_m[:2]) + (things[n].body.kind == "area"),
        )
        thing = things[name]
        yaw = grasp_yaw(thing, believed, things, row)
        actions += arm_actions(pick, 0.0 if yaw is None else yaw, thing.body.height_m)
        shift = pick.place_m - pick.pick_m
        moved = believed[name].position_m + np.array([shift[0], shift[1], 0.0])
        believed[name] = Pose.at(moved, wrap_angle(believed[name].yaw_rad + pick.yaw_rad))
    return actions
