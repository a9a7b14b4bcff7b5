"""One action against the scene as it is expected before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Motion
from wonderful_team.images.relief import Relief

SAME_RAD = 1e-3
"""Turns that differ by less are the same."""


@dataclass(frozen=True, eq=False)
class Carried:
    """What a tool carries or pushes.

    Attributes:
        offsets_m: Its points from above, relative to the tool, shape (M, 2) [m]; None when its size is not known.
        hanging_m: How far it hangs below the tool [m].
    """

    offsets_m: Array | None
    hanging_m: float = 0.0

    @property
    def radius_m(self) -> float:
        """How far it reaches from the tool [m]; 0 when that is not known."""
        if self.offsets_m is None or not len(self.offsets_m):
            return 0.0
        return float(np.linalg.norm(self.offsets_m, axis=1).max())

    def turned(self, yaw_rad: float) -> Carried:
        """The same, turned with the tool."""
        if self.offsets_m is None or abs(yaw_rad) < SAME_RAD:
            return self
        c, s = np.cos(yaw_rad), np.sin(yaw_rad)
        return Carried(self.offsets_m @ np.array([[c, s], [-s, c]]), self.hanging_m)


@dataclass(frozen=True, eq=False)
class Stage:
    """One action against the scene as it is expected before it.

    Attributes:
        motion: What the action does.
        relief: The surface; None without depth.
        own: Which of its points belong to what is carried or pushed, shape (N,) bool.
        carried: What is carried or pushed; None for the bare tool.
        meant: What the thing (or tool) is meant to meet: a shape on the table; None for nothing.
        level: Whether the place has to be level with its surroundings: nothing was named to stand on.
        stated: Whether a plan names the place; otherwise its numbers have to agree with the surface.
        restored: It goes back to where it stood, so what was seen beside it there leaves room for it.
        taken: What else that the plan names lies where the thing goes, not moved so far; "" when nothing does.
        put: Which points belong to things that the plan itself has put somewhere, but for the named place and what the
            plan puts there as well, shape (N,) bool.
        support_m: What the thing stands on now, where that is not the table: points under it, shape (M, 3) [m]. They show once it is lifted.
    """

    motion: Motion
    relief: Relief | None
    own: Array | None
    carried: Carried | None
    meant: Any | None
    level: bool
    stated: bool
    restored: bool = False
    taken: str = ""
    put: Array | None = None
    support_m: Array | None = None
