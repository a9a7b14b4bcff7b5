"""Pushes that solve a table, from the truth: one thing after the other, each in straight pushes that touch nothing else."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.actions import Push
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.goals import Count, Poses, footprint_at, footprint_of
from wonderful_team.sims.tabletop.model import BLADE_HALF_M, Thing
from wonderful_team.sims.tabletop.rules import Rules, RuleState

BEHIND_M = 0.012
"""How far behind a thing the blade comes down [m]."""
MARGIN_M = 0.003
DRIFT_M = 0.004
"""How far a thing that is not square to the push may wander sideways while it turns against the blade [m]."""
SQUARE_RAD = math.radians(10)
GRID_M = 0.0305
FROM_ZONE_M, INTO_ZONE_M = 0.04, 0.024
"""How far outside a zone a thing rests on its way, and how far inside its centre ends [m]."""
SHORTEST_M = 0.02
EDGE_M = 0.03
PUSH_COST_M = 1.0
"""What one more push costs, as metres of way."""
AT_ONCE = 400
"""So many pushes are measured at once, the cheapest first."""
ENOUGH_M = 0.02
OPEN_M = 0.12
DEPTH_WORTH = 3.0
"""What a metre farther from a line is worth, as metres of way."""


@dataclass(frozen=True, eq=False)
class _Job:
    """A thing to be pushed, what it must not meet, and where it may end.

    Attributes:
        corners: Of its outline, turned by 0, shape (N, 2) [m].
        goals, stops: Points where it may end, and where it may rest on the way, shape (N, 2) [m].
        worth: What each goal saves, shape (N,): far from a line is better, or the next thing finds no way in.
    """

    corners: Array
    pose: Pose
    obstacles: BaseGeometry
    goals: Array
    stops: Array
    worth: Array


def solve(rules: Rules, progress: RuleState, poses: Poses, things: Mapping[str, Thing]) -> list[Push]:
    """Pushes until every count is right, as far as straight pushes find a way.

    Only the first is sure to do what is expected: friction decides where a thing ends.
    """
    if progress.verdict.state != "open" or not rules.counts:
        return []
    believed, pushes = dict(poses), list[Push]()
    for count, inside in zip(rules.counts, progress.counted, strict=True):
        done = set(inside)
        while len(done) < count.exactly:
            found = _best(rules, count, done, believed, things)
            if found is None:
                break
            name, ways, moved = found
            pushes.extend(ways)
            believed[name] = moved
            if name in count.things and count.zone.region(believed).covers(footprint_of(things[name], moved)):
                done.add(name)
            elif len(pushes) > rules.horizon:
                break
    return pushes


def _best(
    rules: Rules, count: Count, done: set[str], poses: Poses, things: Mapping[str, Thing]
) -> tuple[str, list[Push], Pose] | None:
    """The cheapest way to bring one more thing into the zone; else a way to clear one out of the way."""
    for names, clearing in ((set(count.things) - done, False), (set(count.strangers) | set(count.things) - done, True)):
        options = []
        for name in sorted(names):
            found = _ways(_job(rules, count, name, poses, things, clearing))
            if found is not None:
                cost, pushes, end = found
                options.append((cost, name, pushes, end))
        if options:
            _, name, pushes, end = min(options, key=lambda option: option[:2])
            return name, pushes, end
    return None


def _job(rules: Rules, count: Count, name: str, poses: Poses, things: Mapping[str, Thing], clearing: bool) -> _Job:
    zone = count.zone.region(poses)
    block = [footprint_of(t, poses[n]) for n, t in things.items() if n != name and t.body.kind != "area"]
    block += [footprint_of(things[never.over], poses[never.over]) for never in rules.nevers if name in never.things]
    if clearing:
        block.append(zone)
    grid = _grid(poses[count.zone.of], zone)
    spots = shapely.points(grid)
    stops = grid[shapely.distance(zone, spots) > FROM_ZONE_M]
    goals = stops if clearing else grid[shapely.covers(zone.buffer(-INTO_ZONE_M), spots)]
    corners = np.asarray(footprint_at(things[name], 0.0, 0.0, 0.0).convex_hull.exterior.coords)
    spots = shapely.points(goals)
    if clearing:
        # Into the open, where the next look finds more ways.
        worth = DEPTH_WORTH * np.minimum(shapely.distance(shapely.unary_union(block), spots), OPEN_M)
    else:
        lines = [footprint_of(things[never.over], poses[never.over]) for never in rules.nevers] or [zone.boundary]
        worth = DEPTH_WORTH * shapely.distance(shapely.unary_union(lines), spots)
    return _Job(corners, poses[name], shapely.unary_union(block), goals, stops, worth)


def _grid(frame: Pose, zone: BaseGeometry) -> Array:
    """Points over the table, square to the zone and symmetric to its middle line, shape (N, 2) [m]."""
    turn = np.array([math.cos(frame.yaw_rad), math.sin(frame.yaw_rad)])
    across = np.array([-turn[1], turn[0]])
    i, j = np.meshgrid(np.arange(-8, 9), np.arange(-24, 25))
    points = np.array([zone.centroid.x, zone.centroid.y]) + GRID_M * (
        i.ravel()[:, None] * across + j.ravel()[:, None] * turn
    )
    low, high = np.array(TABLE_LOW_M[:2]) + EDGE_M, np.array(TABLE_HIGH_M[:2]) - EDGE_M
    return np.asarray(points[((points > low) & (points < high)).all(axis=1)])


def _ways(job: _Job) -> tuple[float, list[Push], Pose] | None:
    """The cheapest one or two pushes that bring a thing to one of its goals."""
    start, yaw = job.pose.position_m[:2], np.array([job.pose.yaw_rad])
    direct = _costs_to_goals(job, start[None], yaw, np.zeros(1))[0]
    if np.isfinite(direct).any():
        goal = job.goals[int(direct.argmin())]
        return float(direct.min()), [_push(job, start, yaw[0], goal)], _ended(start, goal)
    first = _costs(job, start[None], yaw, job.stops)[0]
    stops = job.stops[np.isfinite(first)]
    if not len(stops) or not len(job.goals):
        return None
    turned = np.arctan2(*(stops - start).T[::-1])
    both = _costs_to_goals(job, stops, turned, first[np.isfinite(first)])
    if not np.isfinite(both).any():
        return None
    k, m = np.unravel_index(int(both.argmin()), both.shape)
    stop, goal = stops[k], job.goals[m]
    pushes = [_push(job, start, yaw[0], stop), _push(job, stop, float(turned[k]), goal)]
    return float(both[k, m]), pushes, _ended(stop, goal)


def _costs(job: _Job, starts: Array, yaws: Array, ends: Array) -> Array:
    """What straight pushes cost from each start to each end, shape (S, E); infinite where something is in the way."""
    pushes = _Pushes(job, starts, yaws, ends)
    at = pushes.possible
    found = np.full(pushes.length.shape, np.inf)
    found[at] = pushes.costs(at, pushes.clearance(at))
    return found


def _costs_to_goals(job: _Job, starts: Array, yaws: Array, before: Array) -> Array:
    """The same to the goals, less what each of them is worth, with what came `before` each start, shape (S,).

    The cheapest ones are worked out first; infinite too is what can be no cheaper than one that was found.
    """
    pushes = _Pushes(job, starts, yaws, job.goals)
    found = np.full(pushes.length.shape, np.inf)
    rows, columns = pushes.possible

    def total(at: tuple[Array, Array], clear: Array | float) -> Array:
        return np.asarray(before[at[0]] + pushes.costs(at, clear) - job.worth[at[1]])

    least = total((rows, columns), ENOUGH_M)
    order = np.argsort(least)
    for first in range(0, len(order), AT_ONCE):
        some = order[first : first + AT_ONCE]
        if least[some[0]] > found.min():
            break
        at = rows[some], columns[some]
        found[at] = total(at, pushes.clearance(at))
    return found


class _Pushes:
    """Straight pushes of a thing from each of some starts to each of some ends.

    Attributes:
        length: Of each, shape (S, E) [m].
        possible: Rows and columns of those that are long enough and begin over the table.
    """

    def __init__(self, job: _Job, starts: Array, yaws: Array, ends: Array) -> None:
        way = ends[None] - starts[:, None]
        self.length = np.linalg.norm(way, axis=2)
        way = way / np.maximum(self.length, 1e-9)[..., None]
        across = np.stack([-way[..., 1], way[..., 0]], axis=-1)
        along, wide = _reach(job, yaws, way), _reach(job, yaws, across)
        off = np.arctan2(way[..., 1], way[..., 0]) - yaws[:, None]
        off = np.abs((off + math.pi / 4) % (math.pi / 2) - math.pi / 4)
        radius = float(np.linalg.norm(job.corners, axis=1).max()) + DRIFT_M
        half = np.maximum(np.where(off < SQUARE_RAD, wide, radius), BLADE_HALF_M[1]) + MARGIN_M
        back = starts[:, None] - (along + BEHIND_M)[..., None] * way
        tip = ends[None] + job.corners[:, 0].max() * way
        tail, side = back - 2 * BLADE_HALF_M[0] * way, half[..., None] * across
        inside = ((back > TABLE_LOW_M[:2]) & (back < TABLE_HIGH_M[:2])).all(axis=2)
        self.possible = np.nonzero(inside & (self.length > SHORTEST_M))
        self._lanes = np.stack([tail - side, tail + side, tip + side, tip - side], axis=-2)
        self._obstacles = job.obstacles

    def costs(self, at: tuple[Array, ...], clear: Array | float) -> Array:
        """What some of them cost that keep so far from all obstacles, shape (N,)."""
        return np.where(np.asarray(clear) > 0, PUSH_COST_M + self.length[at] - 5 * np.asarray(clear), np.inf)

    def clearance(self, at: tuple[Array, ...]) -> Array:
        """How far some of them keep from all obstacles, at most `ENOUGH_M`, shape (N,) [m]."""
        lanes = shapely.polygons(self._lanes[at])
        shapely.prepare(self._obstacles)
        clear = np.zeros(len(lanes))
        # Which ones cross an obstacle is told sooner than how far off it is.
        free = ~shapely.intersects(self._obstacles, lanes)
        clear[free] = np.minimum(shapely.distance(lanes[free], self._obstacles), ENOUGH_M)
        return clear


def _reach(job: _Job, yaws: Array, way: Array) -> Array:
    """How far a thing reaches from its centre along directions, shape (S, E) [m]."""
    cos, sin = np.cos(yaws)[:, None], np.sin(yaws)[:, None]
    turned = np.stack([cos * way[..., 0] + sin * way[..., 1], cos * way[..., 1] - sin * way[..., 0]], axis=-1)
    return np.asarray((turned @ job.corners.T).max(axis=-1))


def _push(job: _Job, start: Array, yaw: float, end: Array) -> Push:
    way = (end - start) / np.linalg.norm(end - start)
    back = start - (float(_reach(job, np.array([yaw]), way[None, None])[0, 0]) + BEHIND_M) * way
    front = end - job.corners[:, 0].max() * way
    return Push(np.append(back, 0.0), np.append(front, 0.0))


def _ended(start: Array, end: Array) -> Pose:
    """Where a thing stands after a push: at its end, square to it."""
    way = end - start
    return Pose.at((*end, 0.0), math.atan2(way[1], way[0]))
