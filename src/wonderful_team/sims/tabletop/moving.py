"""Moving a MuJoCo state: setting bodies down by hand, moving a tool, letting everything come to rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.model import TIMESTEP_S, BuiltModel

SETTLED_M_S = 0.004
SETTLE_LIMIT_S = 1.6
HOME_M = (0.5, 0.0, 0.3)
"""Where a tool waits [m]."""


def put_body(built: BuiltModel, state: Any, name: str, pose: Pose) -> None:
    """Put a body somewhere: a fixed one by its mocap slot, a free one by its joint, at rest."""
    # Physics leaves out what has rested for a while. What is left out it wakes by itself when it is put elsewhere, with all that
    # touched it; what is about to be left out would stay in the air.
    awake = state.tree_asleep < 0
    state.tree_asleep[awake] = -1 - mj.mjMINAWAKE
    model, body = built.model, built.body_id(name)
    slot = int(model.body_mocapid[body])
    if slot >= 0:
        state.mocap_pos[slot], state.mocap_quat[slot] = pose.position_m, pose.quaternion_wxyz
        return
    joint = int(model.body_jntadr[body])
    start, speed = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
    state.qpos[start : start + 3], state.qpos[start + 3 : start + 7] = pose.position_m, pose.quaternion_wxyz
    state.qvel[speed : speed + 6] = np.zeros(6)


def settle(built: BuiltModel, state: Any) -> None:
    """Let physics run until everything rests, or the limit of simulated time is reached."""
    quiet = 0
    for _ in range(round(SETTLE_LIMIT_S / TIMESTEP_S)):
        mj.mj_step(built.model, state)
        quiet = quiet + 1 if np.abs(state.qvel).max(initial=0.0) < SETTLED_M_S else 0
        if quiet >= 20:
            break
    mj.mj_forward(built.model, state)


class Tool:
    """A tool over the table, in a MuJoCo state.

    Attributes:
        tool_m: Where it is, shape (3,) [m].
        watch: Called after every step of physics.
    """

    holding = False

    def __init__(self, built: BuiltModel, state: Any) -> None:
        self._built, self._model, self._state = built, built.model, state
        slot = int(built.model.body_mocapid[built.body_id("tool")])
        # Views into the state, which stays where it is.
        self._at, self._turn = state.mocap_pos[slot], state.mocap_quat[slot]
        self.tool_m = np.array(HOME_M)
        self.watch: Callable[[], None] | None = None

    def _place_tool(self, position_m: Array, yaw_rad: float) -> None:
        self.tool_m = np.array(position_m)
        self._at[:] = position_m
        self._turn[:] = (math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2))

    def _step(self) -> None:
        mj.mj_step(self._model, self._state)
        if self.watch is not None:
            self.watch()
