"""Turning: degrees clockwise seen from above, as people and models say it, against radians counter-clockwise inside."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point


def yaw_of(rotate_deg: float) -> float:
    """Degrees clockwise from above to radians counter-clockwise about +z."""
    return -math.radians(rotate_deg) if rotate_deg else 0.0


def turned_m(offset_m: Array, yaw_rad: float) -> Array:
    """An offset, shape (3,) [m], turned about the vertical."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    x, y, z = offset_m
    return np.array([c * x - s * y, s * x + c * y, z])


def turned_px(offset: Point, yaw_rad: float) -> Point:
    """An offset in a picture taken from above (y down), turned as seen there."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    dx, dy = offset
    return c * dx + s * dy, -s * dx + c * dy
