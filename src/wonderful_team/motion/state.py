"""What earlier steps have changed: where things were put, how the gripper is turned, what it holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from wonderful_team.core.actions import Height
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.motion.deprojector import Deprojector, ResolvedPoint
from wonderful_team.motion.turns import turned_m, turned_px


@dataclass(frozen=True, eq=False)
class Moved:
    """One move of a thing: what was at `start` is now at `end`, turned about it.

    Attributes:
        start_m, end_m: Shape (3,) [m]; their heights are those of the support before and after; None without camera.
        step: Number of the step that moved it, from 1.
        pushed: Where it ended was decided by friction: what follows from it is a guess.
    """

    step: int
    start_px: Point
    end_px: Point
    start_m: Array | None
    end_m: Array | None
    yaw_rad: float = 0.0
    pushed: bool = False

    def carry(self, spot: ResolvedPoint, lift: Deprojector) -> ResolvedPoint:
        """Where a spot of the thing lies after the move."""
        how = f"{spot.how}; moved along by step {self.step}" + (", a guess: it was pushed" if self.pushed else "")
        if spot.position_m is not None and self.start_m is not None and self.end_m is not None:
            position = self.end_m + turned_m(spot.position_m - self.start_m, self.yaw_rad)
            return ResolvedPoint(lift.to_px(position), position, how)
        dx, dy = turned_px((spot.px[0] - self.start_px[0], spot.px[1] - self.start_px[1]), self.yaw_rad)
        return ResolvedPoint((self.end_px[0] + dx, self.end_px[1] + dy), None, how)


@dataclass(frozen=True, eq=False)
class Held:
    """What the gripper holds.

    Attributes:
        tool: Where the tool was when it closed.
        centre: Where the thing's centre was then.
        support_z_m: Height of what it stood on then [m].
        yaw_rad: How the gripper was turned then.
    """

    target: str
    tool: ResolvedPoint
    centre: ResolvedPoint
    support_z_m: float
    yaw_rad: float

    @property
    def hanging_m(self) -> float:
        """How far the thing hangs below the tool [m]."""
        return 0.0 if self.tool.position_m is None else float(self.tool.position_m[2]) - self.support_z_m


@dataclass(frozen=True, eq=False)
class MotionState:
    """The state between two steps.

    Attributes:
        moved: By target id, in order.
        yaw_rad: How far the gripper was turned so far.
        tool: Where the last move took the tool; None before the first.
        height: At which height the last move ended.
        over: Which target the tool was last moved to.
    """

    moved: Mapping[str, tuple[Moved, ...]] = field(default_factory=dict)
    yaw_rad: float = 0.0
    tool: ResolvedPoint | None = None
    height: Height = "clear"
    over: str | None = None
    held: Held | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "moved", MappingProxyType(dict(self.moved)))

    def with_move(self, target: str, move: Moved) -> MotionState:
        """After a thing was moved once more."""
        return replace(self, moved={**self.moved, target: (*self.moved.get(target, ()), move)})

    def carry(self, target: str, spot: ResolvedPoint, lift: Deprojector) -> ResolvedPoint:
        """Where a spot of a target lies now, given where the picture showed it."""
        for move in self.moved.get(target, ()):
            spot = move.carry(spot, lift)
        return spot

    def guessed(self, target: str) -> str:
        """What to add to a rule that starts from where a target lies now: that it is a guess, once it was pushed; else ""."""
        pushes = [move.step for move in self.moved.get(target, ()) if move.pushed]
        return f", where step {pushes[-1]} should leave it: a guess" if pushes else ""

    def turn_of(self, target: str) -> float:
        """How far a target was turned so far [rad]."""
        return float(np.sum([move.yaw_rad for move in self.moved.get(target, ())]))
