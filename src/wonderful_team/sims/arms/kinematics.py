"""Inverse kinematics of an arm alone, by mink: where the joints go for the flange to stand somewhere."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms.rows import ArmRow
from wonderful_team.sims.tabletop.engine import mj

POSITION_M, TURN_RAD = 3e-4, 2e-3
"""An answer is one when the flange is this near to where it should be."""
ROUNDS = 60
STEP_S = 0.5
MOST_STEP_RAD = 0.35
"""A joint turns at most so far in one round: far leaps end in another posture of the arm."""
PAUSE_RAD = 2.2
"""No joint of one straight move may turn farther than this [rad]."""


def downwards(yaw_rad: float) -> Array:
    """Rotation of a tool that points down, shape (3, 3): the fingers close along its y axis, its x axis heads for the yaw."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])


class Kinematics:
    """The arm alone, without a scene."""

    def __init__(self, row: ArmRow) -> None:
        import mink

        self._mink = mink
        self.row = row
        self.model = row.load().compile()
        self.state = mj.MjData(self.model)
        joints = [int(mj.mj_name2id(self.model, mj.mjtObj.mjOBJ_JOINT, name)) for name in row.joints]
        self._at = np.array([int(self.model.jnt_qposadr[joint]) for joint in joints])
        self._speeds = np.array([int(self.model.jnt_dofadr[joint]) for joint in joints])
        self._range = np.array([self.model.jnt_range[joint] for joint in joints])
        self._site = int(mj.mj_name2id(self.model, mj.mjtObj.mjOBJ_SITE, row.flange))
        self._configuration = mink.Configuration(self.model)
        self._task = mink.FrameTask(row.flange, "site", position_cost=1.0, orientation_cost=0.5, lm_damping=1e-4)
        self._limits = [mink.ConfigurationLimit(self.model)]
        # Joints of the fingers do not move the flange: their columns are zero, and a little damping keeps them still.
        self._rest = self._configuration.q.copy()

    def flange(self, q: Array) -> tuple[Array, Array]:
        """Where the flange stands, shape (3,) [m], and how it is turned, shape (3, 3)."""
        self.state.qpos[:] = self._rest
        self.state.qpos[self._at] = q
        mj.mj_kinematics(self.model, self.state)
        return self.state.site_xpos[self._site].copy(), self.state.site_xmat[self._site].reshape(3, 3).copy()

    def parked(self) -> Array:
        """Joint angles at which the arm waits beside the table, shape (N,) [rad]."""
        q = self.facing(np.array([1.0, 0.0]), 0.0)
        q[0] = self._wrapped(0, q[0] + self.row.parked_rad)
        return q

    def facing(self, xy_m: Array, yaw_rad: float) -> Array:
        """The ready posture, turned towards a point of the table and to a yaw: where a search begins."""
        q = np.array(self.row.ready, dtype=np.float64)
        at, _ = self.flange(q)
        q[0] = self._wrapped(0, q[0] + math.atan2(xy_m[1], xy_m[0]) - math.atan2(at[1], at[0]))
        _, turn = self.flange(q)
        # The last axis points down: turning it one way turns the tool the other way as seen from above.
        off = math.remainder(yaw_rad - math.atan2(turn[1, 0], turn[0, 0]), 2 * math.pi)
        q[-1] = self._wrapped(len(q) - 1, q[-1] - off)
        return q

    def solve(self, position_m: Array, turn: Array, start: Array) -> Array | None:
        """Joint angles for a pose of the flange, the nearest to `start` in its posture; None when there are none."""
        mink = self._mink
        q = self._rest.copy()
        q[self._at] = np.clip(start, self._range[:, 0] + 1e-4, self._range[:, 1] - 1e-4)
        configuration, task = self._configuration, self._task
        configuration.update(q)
        task.set_target(mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(turn), position_m))
        for _ in range(ROUNDS):
            error = task.compute_error(configuration)
            if np.linalg.norm(error[:3]) < POSITION_M and np.linalg.norm(error[3:]) < TURN_RAD:
                return np.asarray(configuration.q[self._at].copy())
            try:
                speed = mink.solve_ik(configuration, [task], STEP_S, "daqp", limits=self._limits, damping=1e-6)
            except mink.NoSolutionFound:
                return None
            still = np.zeros_like(speed)
            still[self._speeds] = speed[self._speeds]
            most = float(np.abs(still).max()) * STEP_S
            configuration.integrate_inplace(still * min(1.0, MOST_STEP_RAD / max(most, 1e-9)), STEP_S)
        return None

    def reach(self, position_m: Array, turn: Array, near: Array) -> Array | None:
        """Like `solve`, from where the arm is first, then from the ready posture before that point."""
        found = self.solve(position_m, turn, near)
        if found is not None and float(np.abs(found - near).max()) <= PAUSE_RAD:
            return found
        return self.solve(position_m, turn, self.facing(position_m[:2], math.atan2(turn[1, 0], turn[0, 0])))

    def _wrapped(self, joint: int, angle: float) -> float:
        """The same angle within the joint's range, the nearest to its middle."""
        low, high = self._range[joint]
        middle = (low + high) / 2 if joint else float(self.row.ready[0])
        return float(np.clip(middle + math.remainder(angle - middle, 2 * math.pi), low, high))
