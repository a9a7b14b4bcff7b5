"""Bottles and what closes them, as stacks of discs."""

from __future__ import annotations

from typing import TypeAlias

from shapely import Point
from shapely.geometry.base import BaseGeometry

Disc: TypeAlias = tuple[float, float, float]
"""Radius, and the heights from which to which it stands [m]."""
BOTTLES: dict[str, tuple[Disc, ...]] = {
    "bottle": ((0.027, 0.0, 0.068), (0.015, 0.068, 0.11)),
    "screw-top bottle": ((0.039, 0.0, 0.08), (0.012, 0.08, 0.084)),
    "cap": ((0.015, 0.0, 0.03),),
}
"""By name: a bottle with a neck for two fingers, one whose neck a cap hides, and such a cap."""


def layers(name: str) -> list[tuple[BaseGeometry, float, float]]:
    """Its discs as outlines that stand from one height to another [m]."""
    return [(Point(0, 0).buffer(radius), low, high) for radius, low, high in BOTTLES[name]]
