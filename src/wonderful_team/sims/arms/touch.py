"""What a gripper's fingers touch, and what presses on the robot: from the contacts of physics."""

from __future__ import annotations

from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.tabletop.engine import mj


class Touch:
    """Contacts of an arm and its two fingers."""

    def __init__(self, built: BuiltArm, state: Any) -> None:
        self._model, self._state, self._own = built.model, state, built.bodies
        self._fingers = [built.arm_id(mj.mjtObj.mjOBJ_BODY, name) for name in built.row.fingers]
        self._carried: frozenset[int] = frozenset()

    def held(self) -> frozenset[int]:
        """Bodies that both fingers touch."""
        left, right = self._touched()
        return left & right

    def _touched(self) -> tuple[frozenset[int], frozenset[int]]:
        pairs = self._pairs()
        left, right = (
            frozenset(pairs[(pairs == finger).any(axis=1)].ravel().tolist()) - self._own - {0, finger}
            for finger in self._fingers
        )
        return left, right

    def _pairs(self) -> Array:
        """The two bodies of each contact, shape (N, 2)."""
        return np.asarray(self._model.geom_bodyid[self._state.contact.geom]).reshape(-1, 2)

    def _of_one_side(self, own: frozenset[int]) -> tuple[Array, Array]:
        """Which contacts have one body of these alone, in order, shape (K,), and whether it is the second, shape (K,) bool."""
        ours = np.zeros(self._model.nbody, dtype=bool)
        ours[list(own)] = True
        first, second = ours[self._pairs()].T
        return np.flatnonzero(first != second), second[first != second]

    def force_n(self, closed: bool) -> float:
        """Sum of the forces with which what does not belong to the robot presses on it, or on what its closed fingers hold [N]."""
        own = self._own | self._carried_now() if closed else self._own
        total, force = 0.0, np.zeros(6)
        for k in self._of_one_side(own)[0].tolist():
            mj.mj_contactForce(self._model, self._state, k, force)
            total += float(force[0])
        return total

    def push_n(self) -> Array:
        """What pushes the robot in all, as a sensor at its wrist feels it, shape (3,) [N]: fingers that press against each other cancel."""
        total, force = np.zeros(3), np.zeros(6)
        for k, is_second in zip(*(column.tolist() for column in self._of_one_side(self._own)), strict=True):
            mj.mj_contactForce(self._model, self._state, k, force)
            # The frame's first row points from the first body to the second, on which the force acts.
            total += (1.0 if is_second else -1.0) * (self._state.contact[k].frame.reshape(3, 3).T @ force[:3])
        return total

    def _carried_now(self) -> frozenset[int]:
        """What both fingers touch, and what they both did before and one still does: a finger may lift off for one step of physics."""
        left, right = self._touched()
        self._carried = (left & right) | (self._carried & (left | right))
        return self._carried
