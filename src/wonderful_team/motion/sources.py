"""Number sources: every number of an action with the pixel and the rule that it came from."""

from __future__ import annotations

from wonderful_team.core.pictures import Point
from wonderful_team.core.values import NumberSource
from wonderful_team.motion.deprojector import ResolvedPoint


def source(role: str, target: str, spot: ResolvedPoint, tool_px: Point | None = None) -> NumberSource:
    """The record of one point of an action; `tool_px` is where the tool ends when that is not the point itself."""
    position = None
    if spot.position_m is not None:
        x, y, z = (float(value) for value in spot.position_m)
        position = (x, y, z)
    return NumberSource(role, target, spot.px, position, spot.how, tool_px)
