"""Heights of the tool: above, at and clear of things, and how deep fingers reach round them."""

from __future__ import annotations

from wonderful_team.core.values import Limits
from wonderful_team.motion.deprojector import TABLE_Z_M

ABOVE_M = 0.08
"""Free space between a thing and the tool just above it [m]."""
GRASP_DEPTH_M = 0.03
"""How far fingers reach down a thing's side at most [m]; half its height for flat things."""


def above_z_m(surface_z_m: float, limits: Limits, hanging_m: float = 0.0) -> float:
    """Just above a surface; `hanging_m` is how far a held thing hangs below the tool."""
    return surface_z_m + hanging_m + min(ABOVE_M, limits.clearance_m)


def clear_z_m(surfaces_z_m: list[float], limits: Limits, hanging_m: float = 0.0) -> float:
    """Clear of the table by the world's clearance, and of every known surface."""
    highest = max(surfaces_z_m, default=TABLE_Z_M)
    return hanging_m + max(TABLE_Z_M + limits.clearance_m, above_z_m(highest, limits))


def grasp_z_m(top_z_m: float, support_z_m: float) -> float:
    """Where the fingers close on a thing that stands on `support_z_m`."""
    height_m = max(0.0, top_z_m - support_z_m)
    return top_z_m - min(GRASP_DEPTH_M, height_m / 2)
