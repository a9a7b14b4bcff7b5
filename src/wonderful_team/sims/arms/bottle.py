"""Bottles on an arm's table: one is meant, another stands beside it and is to be left alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wonderful_team.core.actions import Action, Gripper, Home, MoveTo
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.model import BuiltArm, upright
from wonderful_team.sims.arms.oracle import grasp_yaw
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.tabletop.goals import Poses, off_table
from wonderful_team.sims.tabletop.model import Thing

LEANS_RAD = 0.17
"""A bottle that leans over farther has fallen."""
OFF_M = 0.01
"""A bottle whose bottom is higher than this has left the table [m]."""
MOVED_M = 0.02
"""What nobody was asked to touch may have moved by this [m]."""
EVERY_STEPS = 5
"""Things are looked at after so many steps of physics: every 10 ms."""
ABOVE_M, CLEAR_M = 0.1, 0.15
"""How far over where the fingers close the oracle comes from, and how far over the table what it holds is carried [m]."""


class Bottles:
    """What tasks with bottles share: which of them is meant, how they stand, and how one is taken hold of.

    Attributes:
        things: Everything on the table, by name.
        wanted: The bottle that is meant.
        lifted: Bottles that were ever off the table.
    """

    def __init__(self, wanted: Thing, things: Sequence[Thing]) -> None:
        self.wanted = wanted
        self.things: Mapping[str, Thing] = {thing.name: thing for thing in things}
        self.lifted: set[str] = set()
        self._start: dict[str, Array] = {}
        self._count = 0

    @property
    def bottles(self) -> tuple[Thing, ...]:
        """All of them."""
        return tuple(thing for thing in self.things.values() if thing.shape == self.wanted.shape)

    def furnish(self, spec: Any) -> None:
        """Nothing that things are not."""

    def decorate(self, scene: Any) -> None:
        """Nothing that bodies do not show."""

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        """Keep in mind how everything stands at the start."""
        self._built, self._state, self._robot = built, state, robot
        self._bodies = {name: built.body_id(name) for name in self.things}
        self._start = {name: state.xpos[body].copy() for name, body in self._bodies.items()}

    def step(self) -> None:
        """Look at things every few steps."""
        self._count += 1
        if self._count % EVERY_STEPS == 0:
            self.watch()

    def watch(self) -> None:
        """Keep in mind which bottles have left the table."""
        for bottle in self.bottles:
            if self._state.xpos[self._bodies[bottle.name]][2] > OFF_M:
                self.lifted.add(bottle.name)

    def moved_m(self, name: str, poses: Poses) -> float:
        """How far something stands from where it stood at the start, seen from above [m]."""
        start = self._start.get(name)
        if start is None:
            start = np.array([self.things[name].x_m, self.things[name].y_m, 0.0])
        return float(np.hypot(*(poses[name].position_m - start)[:2]))

    def held(self, name: str) -> bool:
        """Whether both fingers touch it."""
        return self._bodies[name] in self._robot.held_bodies()

    def fallen(self, name: str, poses: Poses) -> bool:
        """Whether a bottle does not stand any more."""
        return upright(poses[name].quaternion_wxyz) > LEANS_RAD or off_table(poses[name])

    def disturbed(self, poses: Poses) -> Score | None:
        """A failure when a bottle that is not meant was touched."""
        for bottle in self.bottles:
            if bottle is self.wanted:
                continue
            moved = self.moved_m(bottle.name, poses)
            if bottle.name in self.lifted:
                return Score(
                    False, "wrong object", f"the {bottle.name} was lifted, and the {self.wanted.name} is meant"
                )
            if self.fallen(bottle.name, poses) or moved > MOVED_M:
                return Score(False, "execution", f"the {bottle.name} was pushed {1000 * moved:.0f} mm, or over")
        return None

    def grasp(self, thing: Thing, poses: Poses, depth_m: float, tight: bool) -> tuple[Array, float, list[Action]]:
        """Where the fingers close on something, shape (3,) [m], how they are turned [rad], and the actions up to then.

        Args:
            thing: What is gripped.
            poses: How things stand.
            depth_m: How far below its top.
            tight: How hard.
        """
        position = poses[thing.name].position_m
        at = np.array([*position[:2], float(position[2]) + thing.body.height_m - depth_m])
        yaw = grasp_yaw(thing, poses, self._beside(thing), self._built.row) or 0.0
        actions: list[Action] = [Gripper("open"), self.to(at, yaw, ABOVE_M), self.to(at, yaw)]
        return at, yaw, [*actions, Gripper("tight" if tight else "close")]

    def _beside(self, thing: Thing) -> Mapping[str, Thing]:
        """The things that fingers could meet: not what carries this one."""
        where = self._start
        return {
            name: other
            for name, other in self.things.items()
            if other is thing or np.hypot(*(where[name] - where[thing.name])[:2]) > MOVED_M
        }

    def put(self, at: Array, yaw_rad: float) -> list[Action]:
        """Put down what is held: from above down to a point, open, and away."""
        over = max(0.0, CLEAR_M + ABOVE_M - float(at[2]))
        return [
            self.to(at, yaw_rad, over), self.to(at, yaw_rad), Gripper("open"), self.to(at, yaw_rad, over), Home(),
        ]  # fmt: skip

    @staticmethod
    def to(point: Array, yaw_rad: float, up_m: float = 0.0) -> MoveTo:
        """A move of the tool to a point, or over it."""
        return MoveTo(Pose.at(point + np.array([0.0, 0.0, up_m]), yaw_rad))
