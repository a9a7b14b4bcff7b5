"""Drives a Fetch by its own 4-D actions (dx, dy, dz, gripper): straight ways, fingers, and what is felt on the way.

Every motion has an end: so many steps as its length needs, and a few for settling.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array

ORIGIN_TO_GRIP_M = 0.0095
"""The tool's point lies so far below the package's grip site: 9 mm over the tips of the fingers [m]."""
STEP_M = 0.05
"""What the package makes of 1 in an action's dx, dy or dz [m]."""
SPEED_M_S, CONTACT_SPEED_M_S = 0.3, 0.12
GAIN, MOST = 10.0, 0.6
"""Of the error [m] to the action, and the largest share of it that is used: beyond, the arm's weld stretches."""
SETTLE_STEPS, ARRIVED_M = 40, 0.0015
"""Waited for at most at a motion's end; and how near to its goal it is over [m]."""
TOUCH_N, COLLISION_N = 8.0, 60.0
"""A tool that goes down stops at the first force; any other motion at the second [N]."""
DOWN_SHARE = 0.5
CLOSE, TIGHT, OPEN, GRIP_STEPS = -0.002, -0.006, 0.5, 60
"""Gripper's part of an action: what the package adds to where each finger is [m]; times 30,000 N/m it is a force."""
STILL_M, STILL_STEPS = 1e-4, 5
FULLY_OPEN_M, FACE_M = 0.1, 0.0018
"""Sum of both finger joints where the fingers are fully open, and what is free between closed ones [m]."""
EMPTY_M = 0.004
"""Fingers that are closed up to this hold nothing [m]."""
HOME_M = (-0.14, 0.42, 0.5)
"""Beside the table and out of the top view, on the side from which every place is reached without folding the arm over [m]."""
OVER_M = 0.32
"""Height at which the tool comes from there, and goes there [m]."""


@dataclass(frozen=True)
class Felt:
    """What the robot measures after a step.

    Attributes:
        tool_m: Of the tool's point in the base frame, shape (3,) [m].
        opening_m: Between the fingers [m].
        force_n: Sum of what presses on the arm, or on what it holds.
        gripped: Whether both fingers press on something.
    """

    tool_m: Array
    opening_m: float
    force_n: float
    gripped: bool
    time_s: float

    @classmethod
    def of(cls, said: Mapping[str, Any], origin_m: Array) -> Felt:
        """From the simulator's answer, in the base frame.

        Raises:
            ValueError: A number is missing or not finite.
        """
        try:
            tool = np.asarray(said["tool_m"], dtype=np.float64).reshape(-1)
            numbers = [float(said[name]) for name in ("fingers_m", "force_n", "time_s")]
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"the simulator's answer lacks a measurement: {error}") from error
        if tool.shape != (3,) or not np.isfinite([*tool, *numbers]).all():
            raise ValueError(f"the simulator's answer holds a number that means nothing: {dict(said)}")
        tool = tool - origin_m - (0.0, 0.0, ORIGIN_TO_GRIP_M)
        return cls(tool, numbers[0] + FACE_M, numbers[1], bool(said["gripped"]), numbers[2])


@dataclass(frozen=True)
class Moved:
    """How a motion ended: how far from its goal, the largest force on the way, and what stopped it ("", contact, collision, stop)."""

    error_m: float
    force_n: float
    stopped_by: str = ""


class Driver:
    """Turns motions into steps.

    Attributes:
        felt: After the last step.
        closed: What the fingers were told last.
        watch: Called after every step.
    """

    def __init__(self, step: Callable[[Array], Felt], felt: Felt) -> None:
        self._step, self.felt = step, felt
        self.closed = False
        self.watch: Callable[[], None] | None = None
        self._halted = False
        self._squeeze = CLOSE

    @property
    def holding(self) -> bool:
        """Whether the closed fingers press on something that keeps them apart."""
        return self.closed and self.felt.gripped and self.felt.opening_m > EMPTY_M

    def halt(self) -> None:
        """Stay where it is, from the next step on; what is held stays held."""
        self._halted = True

    def move(self, goal_m: Array) -> Moved:
        """The tool in a straight line to a point, shape (3,) [m]."""
        goal, start = np.asarray(goal_m, dtype=np.float64), self.felt.tool_m
        way = goal - start
        length = float(np.linalg.norm(way))
        down = length > 1e-6 and -float(way[2]) > DOWN_SHARE * length
        most_n = TOUCH_N if down else COLLISION_N
        speed = CONTACT_SPEED_M_S if down and length < 0.15 else SPEED_M_S
        count = max(1, math.ceil(length / (speed * self._step_s)))
        worst = 0.0
        for k in range(1, count + SETTLE_STEPS + 1):
            if self._halted:
                return self._ended(goal, worst, "stop")
            if k > count and float(np.linalg.norm(goal - self.felt.tool_m)) < ARRIVED_M:
                break
            self._towards(start + min(1.0, k / count) * way)
            worst = max(worst, self.felt.force_n)
            if self.felt.force_n > most_n:
                self._rest(2)
                return self._ended(goal, worst, "contact" if down else "collision")
        return self._ended(goal, worst, "")

    def grip(self, closed: bool, tight: bool = False) -> Moved:
        """Close or open the fingers; the tool stays where it is."""
        at, before, still, worst = self.felt.tool_m, math.inf, 0, 0.0
        self.closed, self._squeeze = closed, TIGHT if tight else CLOSE
        for _ in range(GRIP_STEPS):
            if self._halted:
                return self._ended(at, worst, "stop")
            self._towards(at, self._squeeze if closed else OPEN)
            worst = max(worst, self.felt.force_n)
            still = still + 1 if abs(self.felt.opening_m - before) < STILL_M else 0
            before = self.felt.opening_m
            if still >= STILL_STEPS:
                break
        return self._ended(at, worst, "")

    def home(self) -> Moved:
        """Straight up, and beside the table."""
        at = self.felt.tool_m
        if at[2] < OVER_M:
            moved = self.move(np.array([at[0], at[1], OVER_M]))
            if moved.stopped_by:
                return moved
        return self.move(np.array(HOME_M))

    def from_home(self, goal_m: Array) -> Moved:
        """Over a point of the table, when the tool stands beside it."""
        return self.move(np.array([goal_m[0], goal_m[1], max(OVER_M, float(goal_m[2]))]))

    @property
    def parked(self) -> bool:
        """Whether it stands beside the table."""
        return float(self.felt.tool_m[0]) < 0.0

    def rest(self, steps: int) -> None:
        """Let time pass."""
        self._rest(steps)

    _step_s = 0.04

    def _rest(self, steps: int) -> None:
        at = self.felt.tool_m
        for _ in range(steps):
            self._towards(at)

    def _towards(self, point_m: Array, gripper: float | None = None) -> None:
        if gripper is None:
            gripper = self._squeeze if self.closed else 0.0
        ways = np.clip(GAIN * (point_m - self.felt.tool_m), -MOST, MOST)
        self.felt = self._step(np.array([*ways, gripper], dtype=np.float32))
        if self.watch is not None:
            self.watch()

    def _ended(self, goal: Array, force_n: float, stopped_by: str) -> Moved:
        return Moved(float(np.linalg.norm(goal - self.felt.tool_m)), force_n, stopped_by)
