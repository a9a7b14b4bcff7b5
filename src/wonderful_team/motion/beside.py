"""Spots next to a box, in pixels of the view: beside it on a named side, and behind it for a push."""

from __future__ import annotations

import math

from wonderful_team.core.actions import Side
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point

GAP_SHARE = 0.15
"""Free space left between two things put side by side (share of the standing one's smaller side)."""
LEAST_GAP_PX = 2.0
SHORTEST_PX = 0.25
"""A shorter push has no direction; a small view's pixel may be 4 mm wide, and a thing be that much short of its place."""

_TOWARDS: dict[Side, Point] = {"left": (-1, 0), "right": (1, 0), "above": (0, -1), "below": (0, 1)}


def gap_px(box: Box) -> float:
    """Free space to leave beside a box [px]."""
    return max(LEAST_GAP_PX, GAP_SHARE * min(box.width, box.height))


def half_extents(box: Box | None, yaw_rad: float = 0.0) -> tuple[float, float]:
    """Half the width and height [px] of what a box encloses, once it is turned; (0, 0) without a box."""
    if box is None:
        return 0.0, 0.0
    c, s = abs(math.cos(yaw_rad)), abs(math.sin(yaw_rad))
    return (c * box.width + s * box.height) / 2, (s * box.width + c * box.height) / 2


def beside_px(box: Box, side: Side, half: tuple[float, float], view_size_px: tuple[int, int]) -> Point:
    """Where the centre of a thing with half extents `half` goes so that it stands next to `box`.

    It is shifted back into the view when it would stick out, but never onto the box.

    Raises:
        ValueError: No room on that side of the box.
    """
    dx, dy = _TOWARDS[side]
    gap = gap_px(box)
    wanted = (
        box.centre[0] + dx * (box.width / 2 + gap + half[0]),
        box.centre[1] + dy * (box.height / 2 + gap + half[1]),
    )
    x, y = (
        min(max(value, extent), max(size - extent, extent))
        for value, extent, size in zip(wanted, half, view_size_px, strict=True)
    )
    free = abs(x - box.centre[0]) - box.width / 2 - half[0] if dx else abs(y - box.centre[1]) - box.height / 2 - half[1]
    if free < 0:
        needed = 2 * (half[0] if dx else half[1])
        rooms = {
            "left": box.x0,
            "right": view_size_px[0] - box.x1,
            "above": box.y0,
            "below": view_size_px[1] - box.y1,
        }
        others = ", ".join(f"{room:.0f} px {other}" for other, room in rooms.items() if other != side)
        raise ValueError(
            f"{rooms[side]:.0f} px of the picture lie there, {needed:.0f} px are needed; on the other sides lie {others}"
        )
    return x, y


def behind_px(box: Box, end: Point) -> tuple[Point, Point]:
    """Where a tool starts and ends so that pushing moves the centre of `box` to `end`.

    It starts a gap behind the box, on the side away from the end, and stops short of the end by half the extent of what
    the box holds: that of an ellipse in it, since a corner turns away under a push.

    Raises:
        ValueError: The end is where the box already stands.
    """
    dx, dy = end[0] - box.centre[0], end[1] - box.centre[1]
    length = math.hypot(dx, dy)
    if length < SHORTEST_PX:
        raise ValueError("the push would end where it begins")
    dx, dy = dx / length, dy / length
    reach = (abs(dx) * box.width + abs(dy) * box.height) / 2
    back = reach + gap_px(box)
    short = math.hypot(dx * box.width, dy * box.height) / 2
    return (
        (box.centre[0] - dx * back, box.centre[1] - dy * back),
        (end[0] - dx * short, end[1] - dy * short),
    )
