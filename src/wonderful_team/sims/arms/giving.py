"""Giving way to forces: how an arm's joints turn for its tool to shift a little, and how far it shifts for what presses on it."""

from __future__ import annotations

from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.engine import mj

SIDEWAYS_M_N = 1e-4
"""How far a closing gripper gives way at each command for a newton that pushes it aside [m]."""
MOST_SIDEWAYS_M = 0.01
"""And at most in all [m]: farther off the camera is not."""
EASED_N = 0.3
"""So little does not push it [N]."""


def shifted(model: Any, state: Any, site: int, columns: Array, q: Array, by_m: Array) -> Array:
    """Joint angles with the tool a little elsewhere, not turned.

    Args:
        model: Of MuJoCo.
        state: Where the arm stands now says how its joints move the tool.
        site: Id of the site that moves.
        columns: Of the arm's joints among all speeds.
        q: Joint angles, shape (N,) [rad].
        by_m: Shape (3,) [m].
    """
    jacobian = np.zeros((6, model.nv))
    mj.mj_jacSite(model, state, jacobian[:3], jacobian[3:], site)
    return np.asarray(q + np.linalg.lstsq(jacobian[:, columns], np.concatenate([by_m, np.zeros(3)]), rcond=None)[0])


class GivesSideways:
    """A gripper that closes off the middle of a thing is moved over it, where a stiff arm would tip or push the thing.

    Attributes:
        by_m: How far it has given way so far, shape (3,) [m].
    """

    def __init__(self) -> None:
        self.by_m = np.zeros(3)

    def step(self, force_n: Array) -> bool:
        """One command on; whether it has come to rest.

        Args:
            force_n: What pushes the gripper, shape (3,) [N]; only what pushes it sideways counts.
        """
        side = np.array([force_n[0], force_n[1], 0.0])
        if float(np.linalg.norm(side)) < EASED_N:
            return True
        by = self.by_m + SIDEWAYS_M_N * side
        far = float(np.linalg.norm(by))
        self.by_m = by * min(1.0, MOST_SIDEWAYS_M / max(far, 1e-9))
        return False
