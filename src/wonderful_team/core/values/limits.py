"""What a world allows: its workspace, and regions that nothing may enter."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.later import later


@dataclass(frozen=True)
class KeepOut:
    """A region nothing may enter: a box in pixels of the main view, or in metres on the table (x0, y0, x1, y1)."""

    name: str
    box: Box
    unit: Literal["px", "m"] = "px"


@dataclass(frozen=True)
class Fingers:
    """A gripper with two parallel fingers that points down.

    Attributes:
        opening_m: Between the open fingers [m].
        thickness_m, breadth_m: Of one finger, along the way it closes and across it [m].
        turns: Whether the gripper turns about the vertical; else it closes along the y axis of the base frame, always.
    """

    opening_m: float
    thickness_m: float
    breadth_m: float
    turns: bool = later(True)

    def __post_init__(self) -> None:
        for name in ("opening_m", "thickness_m", "breadth_m"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"fingers: {name} must be more than 0 m, got {getattr(self, name)} m")


@dataclass(frozen=True, eq=False)
class Limits:
    """What a world allows.

    Attributes:
        low_m, high_m: Corners of the workspace, shape (3,) [m], base frame.
        keep_out: Regions nothing may enter.
        clearance_m: Height at which things are carried over the table [m].
        blade_m: Width of what pushes, across the way of a push [m]; None where nobody says.
        fingers: Of the gripper: how it is turned to grip is then computed from depth; None where nobody says.
        lift_m: How far a thing is lifted from where it is gripped, as far as the workspace reaches, so that a tall one is
            carried higher; None where nobody says.
    """

    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    keep_out: tuple[KeepOut, ...] = ()
    clearance_m: float = 0.2
    blade_m: float | None = later(None)
    fingers: Fingers | None = later(None)
    lift_m: float | None = later(None)

    def __post_init__(self) -> None:
        if not all(math.isfinite(value) for value in (*self.low_m, *self.high_m, self.clearance_m)):
            raise ValueError(
                f"workspace: every number must be finite, got {self.low_m}, {self.high_m} m, clearance {self.clearance_m} m"
            )
        if self.blade_m is not None and not 0 < self.blade_m < math.inf:
            raise ValueError(f"blade: its width must be more than 0 m, got {self.blade_m} m")
        if self.lift_m is not None and not 0 < self.lift_m < math.inf:
            raise ValueError(f"lift: it must be more than 0 m, got {self.lift_m} m")
        if any(low >= high for low, high in zip(self.low_m, self.high_m, strict=True)):
            raise ValueError(f"workspace: every low must be below its high, got {self.low_m} and {self.high_m} m")

    def carried_z_m(self, start_m: Array, end_m: Array) -> float:
        """Height of the tool while a thing is carried from one surface to another [m]."""
        lifted_z_m = min(float(start_m[2]) + (self.lift_m or 0.0), self.high_m[2])
        return max(self.clearance_m, lifted_z_m, float(start_m[2]), float(end_m[2]))


NO_WORKSPACE = Limits((-100.0, -100.0, -100.0), (100.0, 100.0, 100.0))
"""Limits of a photo without a robot: nobody has said where the workspace ends."""
