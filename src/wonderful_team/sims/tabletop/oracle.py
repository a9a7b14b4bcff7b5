"""Actions that solve a table, from the truth."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from shapely import Point, box
from shapely.affinity import translate
from shapely.geometry.base import BaseGeometry

from wonderful_team.actions import PickPlace
from wonderful_team.geometry import Pose, wrap_angle
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.goals import Goal, Poses, Rules, footprint_of
from wonderful_team.sims.tabletop.model import Thing

SPACE_M = 0.006
"""Free space that is kept between things that are put on one area [m]."""
STEP_M = 0.01


def grasp_point(thing: Thing, pose: Pose) -> tuple[float, float, float]:
    """Where the suction cup holds a thing, base frame [m]."""
    a, b = thing.body.grasp_ab
    x, y, z = pose.apply([(-b, a, thing.body.height_m)])[0]
    return float(x), float(y), float(z)


def solve(rules: Rules, poses: Poses, things: Mapping[str, Thing]) -> list[PickPlace]:
    """One action per goal that is not met; a thing whose place is taken by another waits or steps aside."""
    believed = dict(poses)
    actions: list[PickPlace] = []
    waiting = [goal for goal in rules.goals if not goal.met(believed, things)]
    while waiting and len(actions) < 2 * len(rules.goals):
        moves = [(goal, _destination(goal, believed, things)) for goal in waiting]
        moves.append((waiting[0], _free_table(things[waiting[0].thing], believed, things)))
        goal, end = next(((goal, end) for goal, end in moves if end is not None), (waiting[0], None))
        if end is None:
            break
        actions.append(_move(things[goal.thing], believed[goal.thing], end))
        believed[goal.thing] = end
        waiting = [g for g in rules.goals if not g.met(believed, things)]
    return actions


def _move(thing: Thing, pose: Pose, end: Pose) -> PickPlace:
    pick = np.array(grasp_point(thing, pose))
    turn = wrap_angle(end.yaw_rad - pose.yaw_rad)
    offset = Pose.at((0.0, 0.0, 0.0), turn).apply([pick - pose.position_m])[0]
    return PickPlace(pick, end.position_m + offset * np.array([1.0, 1.0, 0.0]), turn)


def _destination(goal: Goal, poses: Poses, things: Mapping[str, Thing]) -> Pose | None:
    pose = poses[goal.thing]
    yaw = pose.yaw_rad if goal.yaw_rad is None else goal.yaw_rad
    targets = goal.target_points(poses)
    if targets:
        return Pose.at((*targets[0], 0.0), yaw)
    if goal.inside:
        area = things[goal.inside[0]]
        return _free_spot(things[goal.thing], footprint_of(area, poses[area.name]), goal.inside, poses, things)
    return _free_table(things[goal.thing], poses, things)


def _free_table(thing: Thing, poses: Poses, things: Mapping[str, Thing]) -> Pose | None:
    table = box(TABLE_LOW_M[0], TABLE_LOW_M[1], TABLE_HIGH_M[0], TABLE_HIGH_M[1])
    return _free_spot(thing, table, (), poses, things)


def _free_spot(
    thing: Thing, room: BaseGeometry, ignore: tuple[str, ...], poses: Poses, things: Mapping[str, Thing]
) -> Pose | None:
    """The free place nearest to the middle of a region, the thing turned as it is."""
    pose = poses[thing.name]
    others = [footprint_of(t, poses[n]) for n, t in things.items() if n != thing.name and n not in ignore]
    own = footprint_of(thing, Pose.at((0.0, 0.0, 0.0), pose.yaw_rad)).convex_hull
    middle = room.centroid
    low_x, low_y, high_x, high_y = room.bounds
    spots = [
        (math.dist((x, y), (middle.x, middle.y)), x, y)
        for x in np.arange(low_x, high_x, STEP_M)
        for y in np.arange(low_y, high_y, STEP_M)
    ]
    for _, x, y in sorted([(0.0, middle.x, middle.y), *spots]):
        placed = translate(own, x, y)
        if (
            room.covers(Point(x, y))
            and room.buffer(0.012).covers(placed)
            and all(placed.distance(o) >= SPACE_M for o in others)
        ):
            return Pose.at((float(x), float(y), 0.0), pose.yaw_rad)
    return None
