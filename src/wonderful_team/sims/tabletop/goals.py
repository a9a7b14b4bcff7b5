"""What a task wants, as data, and whether the true poses fulfil it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal, TypeAlias

import numpy as np
import shapely
from shapely import Point, Polygon
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.geometry import Pose, wrap_angle
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.shapes import shape

NEAR_M = 0.1
"""How close two centres count as together, seen from above [m]; VIMA-Bench's figure."""
TURN_TOLERANCE_RAD = math.radians(15)
Poses: TypeAlias = Mapping[str, Pose]


@dataclass(frozen=True)
class Goal:
    """Where one thing has to end.

    Attributes:
        thing: Name of the thing.
        near: Names of things; being near any one of them is enough.
        at_m: A point (x, y) to be near instead.
        inside: Names of areas or containers; its centre being over any one of them is enough.
        off: Names of areas that its centre must not be over.
        within_m: What near means.
        yaw_rad: Which way it has to be turned at the end, counter-clockwise; None for any.
    """

    thing: str
    near: tuple[str, ...] = ()
    at_m: tuple[float, float] | None = None
    inside: tuple[str, ...] = ()
    off: tuple[str, ...] = ()
    within_m: float = NEAR_M
    yaw_rad: float | None = None

    def met(self, poses: Poses, things: Mapping[str, Thing]) -> bool:
        """Whether the true poses fulfil it."""
        pose = poses[self.thing]
        x, y = float(pose.position_m[0]), float(pose.position_m[1])
        targets = self.target_points(poses)
        if targets and min(math.dist((x, y), t) for t in targets) >= self.within_m:
            return False
        if self.inside and not any(stands_on((x, y), area, poses, things) for area in self.inside):
            return False
        if any(stands_on((x, y), area, poses, things) for area in self.off):
            return False
        return self.yaw_rad is None or abs(wrap_angle(pose.yaw_rad - self.yaw_rad)) <= TURN_TOLERANCE_RAD

    def turned_like(self, poses: Poses, other: str) -> bool:
        """Whether another thing is turned as this one is, where the goal asks how it is turned; else always.

        A thing that has to be turned is taken for another only where their turns agree, too: VIMA-Bench compares poses.
        """
        apart = wrap_angle(poses[self.thing].yaw_rad - poses[other].yaw_rad)
        return self.yaw_rad is None or abs(apart) <= TURN_TOLERANCE_RAD

    def target_points(self, poses: Poses) -> list[tuple[float, float]]:
        """The points (x, y) [m] that it may be near."""
        points = [(float(poses[n].position_m[0]), float(poses[n].position_m[1])) for n in self.near]
        return [*points, self.at_m] if self.at_m is not None else points


def footprint_at(thing: Thing, x_m: float, y_m: float, yaw_rad: float) -> BaseGeometry:
    """What a thing covers of the table, as a shapely geometry in base frame x and y [m]."""
    return _covered(thing.shape, thing.stretch, x_m, y_m, yaw_rad)


@lru_cache(maxsize=256)
def _covered(shape_name: str, stretch: float, x_m: float, y_m: float, yaw_rad: float) -> BaseGeometry:
    """Kept for a while: most things stand still while one is pushed."""
    turned = rotate(shape(shape_name, stretch).footprint, 90 + math.degrees(yaw_rad), origin=(0, 0))
    return translate(turned, x_m, y_m)


def footprint_of(thing: Thing, pose: Pose) -> BaseGeometry:
    """The same, for a pose."""
    return footprint_at(thing, float(pose.position_m[0]), float(pose.position_m[1]), pose.yaw_rad)


def stands_on(point_m: tuple[float, float], area: str, poses: Poses, things: Mapping[str, Thing]) -> bool:
    """Whether a point lies on a flat area."""
    return bool(footprint_of(things[area], poses[area]).covers(Point(point_m)))


@dataclass(frozen=True)
class Verdict:
    """The state of a task: still open, reached, or failed for a reason."""

    state: Literal["open", "success", "failure"]
    reason: str = ""


@dataclass(frozen=True)
class Zone:
    """A region of the table that belongs to a thing and moves with it.

    Attributes:
        of: Name of the thing.
        corners_ab: Outline coordinates (a right, b up) [m], a simple polygon.
    """

    of: str
    corners_ab: tuple[tuple[float, float], ...]

    def region(self, poses: Poses) -> BaseGeometry:
        """Where it lies now, base frame x and y [m]."""
        return _region(self.corners_ab, *centre_of(poses[self.of]), poses[self.of].yaw_rad)


@lru_cache(maxsize=64)
def _region(corners_ab: tuple[tuple[float, float], ...], x_m: float, y_m: float, yaw_rad: float) -> BaseGeometry:
    placed = translate(rotate(Polygon(corners_ab), 90 + math.degrees(yaw_rad), origin=(0, 0)), x_m, y_m)
    shapely.prepare(placed)
    return placed


@dataclass(frozen=True)
class Count:
    """Exactly so many of some things have to come to lie in a zone; a thing that was once inside stays counted.

    Attributes:
        things: Names of those that count.
        exactly: How many; more of them is a failure.
        strangers: Names of those of which no point may enter the zone.
    """

    things: tuple[str, ...]
    zone: Zone
    exactly: int
    strangers: tuple[str, ...] = ()

    def inside(self, poses: Poses, things: Mapping[str, Thing]) -> frozenset[str]:
        """Which of the things lie in the zone with their eight sample points: corners and middles of the sides."""
        region = self.zone.region(poses)
        return frozenset(n for n in self.things if _covers(region, sample_points(things[n], poses[n])).all())

    def intruder(self, poses: Poses, things: Mapping[str, Thing]) -> str | None:
        """A stranger with a sample point in the zone."""
        region = self.zone.region(poses)
        for name in self.strangers:
            if _covers(region, sample_points(things[name], poses[name])).any():
                return name
        return None


@dataclass(frozen=True)
class Never:
    """Things that may at no time, not even on the way, overlap another thing seen from above."""

    things: tuple[str, ...]
    over: str

    def broken(self, poses: Poses, things: Mapping[str, Thing]) -> str | None:
        """One that overlaps now."""
        line = footprint_of(things[self.over], poses[self.over])
        for name in self.things:
            if footprint_of(things[name], poses[name]).intersects(line):
                return name
        return None


def sample_points(thing: Thing, pose: Pose) -> Array:
    """Corners of a thing's outline box and the middles of its sides, base frame x and y, shape (8, 2) [m]."""
    return np.asarray(pose.apply(_around(thing.shape, thing.stretch))[:, :2])


@cache
def _around(shape_name: str, stretch: float) -> Array:
    """The same in the thing's own frame, shape (8, 3) [m]."""
    a0, b0, a1, b1 = shape(shape_name, stretch).footprint.bounds
    a, b = (a0 + a1) / 2, (b0 + b1) / 2
    around = [(a0, b0), (a, b0), (a1, b0), (a1, b), (a1, b1), (a, b1), (a0, b1), (a0, b)]
    return np.array([(-v, u, 0.0) for u, v in around])


def _covers(region: BaseGeometry, points_m: Array) -> Array:
    """Which points lie in a region or on its edge, shape (N,) bool."""
    return np.asarray(shapely.covers(region, shapely.points(points_m)))


def centre_of(pose: Pose) -> tuple[float, float]:
    """Where a thing's centre stands, seen from above [m]."""
    return float(pose.position_m[0]), float(pose.position_m[1])


def off_table(pose: Pose) -> bool:
    """Whether a thing's centre is beyond the table's edge."""
    x, y = centre_of(pose)
    return not (TABLE_LOW_M[0] <= x <= TABLE_HIGH_M[0] and TABLE_LOW_M[1] <= y <= TABLE_HIGH_M[1])
