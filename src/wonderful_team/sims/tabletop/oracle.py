"""Actions that solve a table, from the truth."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from shapely import Point, box
from shapely.affinity import translate
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.actions import PickPlace
from wonderful_team.core.geometry import Pose, wrap_angle
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.goals import Goal, Poses, footprint_of
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.rules import Rules, RuleState

SPACE_M = 0.006
"""Free space that is kept between things that are put on one area [m]."""
STEP_M = 0.01
AWAY_M = 0.14
"""How far from every target a thing goes that is only put aside [m]."""


def grasp_point(thing: Thing, pose: Pose) -> tuple[float, float, float]:
    """Where the suction cup holds a thing, base frame [m]."""
    a, b = thing.body.grasp_ab
    x, y, z = pose.apply([(-b, a, thing.body.height_m)])[0]
    return float(x), float(y), float(z)


def solve(rules: Rules, progress: RuleState, poses: Poses, things: Mapping[str, Thing]) -> list[PickPlace]:
    """One action per goal that is not met, phase after phase; a thing whose place is taken waits or steps aside."""
    believed = dict(poses)
    actions: list[PickPlace] = []
    if progress.verdict.state != "open" and rules.ends_when_reached:
        return actions
    for number, goals in enumerate(rules.phases[progress.phase :]):
        phase = [goal for goal in goals if not (rules.goals_last and number == 0 and goal in progress.done)]
        limit = len(actions) + 2 * len(phase) + len(rules.distractors)
        while len(actions) < limit and (move := _next_move(rules, phase, believed, things)) is not None:
            name, end = move
            actions.append(_move(things[name], believed[name], end))
            believed[name] = end
    return actions


def _next_move(
    rules: Rules, phase: Sequence[Goal], poses: Poses, things: Mapping[str, Thing]
) -> tuple[str, Pose] | None:
    """A thing that can go where it belongs; else one that is in the way goes aside."""
    waiting = [goal for goal in phase if not goal.met(poses, things)]
    # What is at its own place already stays there, even where things come to lie close to each other.
    settled = {goal.thing for goal in phase} - {goal.thing for goal in waiting}
    taken: list[str] = []
    for goal in waiting:
        end = _destination(goal, poses, things)
        if end is None:
            continue
        blockers = _in_the_way(goal, end, poses, things) if goal.at_m is not None else []
        blockers = [name for name in blockers if name not in settled]
        if not blockers:
            return goal.thing, end
        taken.extend(blockers)
    for name in (*taken, *(goal.thing for goal in waiting)):
        if things[name].body.movable:
            away = [target for goal in rules.goals for target in goal.target_points(poses)]
            kept = [_kept(goal, name, poses, things) for goal in rules.goals]
            # Where nothing is free away from every target, any free place will do for the time being.
            aside = _free_table(things[name], poses, things, away, kept) or _free_table(things[name], poses, things)
            if aside is not None:
                return name, aside
    return None


def _kept(goal: Goal, aside: str, poses: Poses, things: Mapping[str, Thing]) -> BaseGeometry:
    """What a thing will cover of the table where it goes; nothing where that is the thing that goes aside."""
    if goal.at_m is None or goal.thing == aside:
        return Point()
    yaw = poses[goal.thing].yaw_rad if goal.yaw_rad is None else goal.yaw_rad
    return footprint_of(things[goal.thing], Pose.at((*goal.at_m, 0.0), yaw)).convex_hull


def _in_the_way(goal: Goal, end: Pose, poses: Poses, things: Mapping[str, Thing]) -> list[str]:
    """What stands where a thing is to go on the table; the thing it stands on in a stack is not in its way."""
    placed = footprint_of(things[goal.thing], end).convex_hull
    names = [n for n, t in things.items() if n != goal.thing and t.body.movable]
    return [n for n in names if footprint_of(things[n], poses[n]).convex_hull.intersects(placed)]


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


def _free_table(
    thing: Thing,
    poses: Poses,
    things: Mapping[str, Thing],
    away: Sequence[tuple[float, float]] = (),
    kept: Sequence[BaseGeometry] = (),
) -> Pose | None:
    table = box(TABLE_LOW_M[0], TABLE_LOW_M[1], TABLE_HIGH_M[0], TABLE_HIGH_M[1])
    return _free_spot(thing, table, (), poses, things, away, kept)


def _free_spot(
    thing: Thing,
    room: BaseGeometry,
    ignore: tuple[str, ...],
    poses: Poses,
    things: Mapping[str, Thing],
    away: Sequence[tuple[float, float]] = (),
    kept: Sequence[BaseGeometry] = (),
) -> Pose | None:
    """The free place nearest to the middle of a region, the thing turned as it is."""
    pose = poses[thing.name]
    others = [footprint_of(t, poses[n]) for n, t in things.items() if n != thing.name and n not in ignore]
    others += [place for place in kept if not place.is_empty]
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
        if any(math.dist((x, y), point) < AWAY_M for point in away):
            continue
        if (
            room.covers(Point(x, y))
            and room.buffer(0.012).covers(placed)
            and all(placed.distance(o) >= SPACE_M for o in others)
        ):
            return Pose.at((float(x), float(y), 0.0), pose.yaw_rad)
    return None
