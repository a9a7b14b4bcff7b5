"""A tool that the fingers hold from the start: a pen, a sponge. It is held by contact, like everything else."""

from __future__ import annotations

from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.tabletop.engine import mj

GRIP_HALF_M = (0.011, 0.011, 0.02)
"""Half the sides of the block that the fingers hold a tool by [m]."""

GRIP_KG = 0.06
STIFF = (0.004, 1.0)
"""Time constant and damping of contacts of a light tool: with MuJoCo's own it would sink in by millimetres."""


class HeldTool:
    """A free body with a block between the fingers and its working end below.

    Attributes:
        name: Of its body.
        below_m: How far below the middle of that block its working end lies [m].
    """

    name = "held tool"
    below_m = 0.05

    def furnish(self, spec: Any) -> None:
        """The body, far away until it is put between the fingers."""
        body = spec.worldbody.add_body(name=self.name, pos=(0.0, 1.5, 0.5))
        body.add_freejoint(name=f"free {self.name}")
        body.add_geom(
            name=f"{self.name} grip", type=mj.mjtGeom.mjGEOM_BOX, size=GRIP_HALF_M, mass=GRIP_KG, group=0, condim=6,
            friction=(1.0, 0.01, 0.005), rgba=(0.25, 0.25, 0.28, 1.0),
        )  # fmt: skip
        self.add_end(body)

    def add_end(self, body: Any) -> None:
        """Its working end."""
        raise NotImplementedError

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        """Put it between the open fingers, close them tightly, and measure where its working end is."""
        self._built, self._state, self._robot = built, state, robot
        self._body = built.body_id(self.name)
        joint = int(built.model.body_jntadr[self._body])
        at, speed = int(built.model.jnt_qposadr[joint]), int(built.model.jnt_dofadr[joint])
        turn = np.column_stack([robot.turn[:, 0], -robot.turn[:, 1], -robot.turn[:, 2]])
        quaternion = np.zeros(4)
        mj.mju_mat2Quat(quaternion, turn.ravel())
        built.model.body_gravcomp[self._body] = 1.0
        state.qpos[at : at + 3], state.qpos[at + 3 : at + 7] = robot.tool_m, quaternion
        state.qvel[speed : speed + 6] = 0.0
        mj.mj_forward(built.model, state)
        robot.grip(True, True)
        built.model.body_gravcomp[self._body] = 0.0
        robot.rest(0.3)
        robot.tip_m = robot.turn.T @ (self.end_m() - robot.tool_m)

    def end_m(self) -> Array:
        """Where its working end is, shape (3,) [m]."""
        turn = self._state.xmat[self._body].reshape(3, 3)
        return np.asarray(self._state.xpos[self._body] + turn @ np.array([0.0, 0.0, -self.below_m]))

    @property
    def lost(self) -> bool:
        """Whether the fingers do not hold it any more."""
        return self._body not in self._robot.held_bodies()
