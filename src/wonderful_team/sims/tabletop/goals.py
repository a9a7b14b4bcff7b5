"""What a task wants, as data, and whether the true poses fulfil it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

from shapely import Point
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

from wonderful_team.geometry import Pose, wrap_angle
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.model import Thing

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

    def target_points(self, poses: Poses) -> list[tuple[float, float]]:
        """The points (x, y) [m] that it may be near."""
        points = [(float(poses[n].position_m[0]), float(poses[n].position_m[1])) for n in self.near]
        return [*points, self.at_m] if self.at_m is not None else points


def footprint_at(thing: Thing, x_m: float, y_m: float, yaw_rad: float) -> BaseGeometry:
    """What a thing covers of the table, as a shapely geometry in base frame x and y [m]."""
    turned = rotate(thing.body.footprint, 90 + math.degrees(yaw_rad), origin=(0, 0))
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
class Rules:
    """Goals of a task and what ends it.

    Attributes:
        distractors: Things that must stay away from every target, and targets from them.
        ends_when_reached: True: reaching all goals once is enough. False: the state at the end counts.
    """

    goals: tuple[Goal, ...]
    distractors: tuple[str, ...]
    horizon: int
    ends_when_reached: bool = True

    def judge(self, poses: Poses, things: Mapping[str, Thing]) -> Verdict:
        """Apply the rules to the true poses."""
        for goal in self.goals:
            met = goal.met(poses, things)
            x, y = (float(v) for v in poses[goal.thing].position_m[:2])
            if not met and not (TABLE_LOW_M[0] <= x <= TABLE_HIGH_M[0] and TABLE_LOW_M[1] <= y <= TABLE_HIGH_M[1]):
                return Verdict("failure", f"{goal.thing} left the table at ({x:.3f}, {y:.3f}) m")
            disturbed = self._disturbed(goal, (x, y), poses)
            if disturbed:
                return Verdict("failure", disturbed)
        if all(goal.met(poses, things) for goal in self.goals):
            return Verdict("success")
        return Verdict("open")

    def _disturbed(self, goal: Goal, at: tuple[float, float], poses: Poses) -> str:
        for name in self.distractors:
            other = (float(poses[name].position_m[0]), float(poses[name].position_m[1]))
            if math.dist(at, other) < goal.within_m:
                return f"{goal.thing} lies {math.dist(at, other):.3f} m from the distractor {name} (limit {goal.within_m} m)"
            for target in goal.target_points(poses):
                if math.dist(target, other) < goal.within_m:
                    return f"the distractor {name} lies {math.dist(target, other):.3f} m from a target of {goal.thing}"
        return ""
