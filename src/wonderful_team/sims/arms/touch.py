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
        contact, bodies = self._state.contact, self._model.geom_bodyid
        pairs = bodies[contact.geom[: self._state.ncon]].reshape(-1, 2)
        left, right = (
            frozenset(int(b if a == finger else a) for a, b in pairs if finger in (a, b)) - self._own - {0}
            for finger in self._fingers
        )
        return left, right

    def force_n(self, closed: bool) -> float:
        """Sum of the forces with which what does not belong to the robot presses on it, or on what its closed fingers hold [N]."""
        own = self._own | self._carried_now() if closed else self._own
        total, force = 0.0, np.zeros(6)
        for k in range(self._state.ncon):
            a, b = (int(self._model.geom_bodyid[geom]) for geom in self._state.contact.geom[k])
            if (a in own) != (b in own):
                mj.mj_contactForce(self._model, self._state, k, force)
                total += float(force[0])
        return total

    def push_n(self) -> Array:
        """What pushes the robot in all, as a sensor at its wrist feels it, shape (3,) [N]: fingers that press against each other cancel."""
        total, force = np.zeros(3), np.zeros(6)
        for k in range(self._state.ncon):
            contact = self._state.contact[k]
            a, b = (int(self._model.geom_bodyid[geom]) for geom in contact.geom)
            if (a in self._own) != (b in self._own):
                mj.mj_contactForce(self._model, self._state, k, force)
                # The frame's first row points from the first body to the second, on which the force acts.
                total += (1.0 if b in self._own else -1.0) * (contact.frame.reshape(3, 3).T @ force[:3])
        return total

    def _carried_now(self) -> frozenset[int]:
        """What both fingers touch, and what they both did before and one still does: a finger may lift off for one step of physics."""
        left, right = self._touched()
        self._carried = (left & right) | (self._carried & (left | right))
        return self._carried
