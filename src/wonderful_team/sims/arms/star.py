"""What a five-pointed star is: of ten corners round its outline, or five that the pen joins without lifting."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import ArrayLike
from shapely import Polygon

from wonderful_team.core.geometry.arrays import Array

STRAIGHT_M = 0.005
"""An edge may bend so far from straight [m]."""
CLOSED_M = 0.01
"""Ends of strokes that are nearer than this meet [m]."""
LEAST_REACH_M = 0.025
"""The tips lie at least so far from the middle [m]."""
EVEN_DEG, EVEN_SHARE = 14.0, 0.2
"""Tips lie 72 degrees apart, give or take this, and equally far from the middle, give or take this share."""
NOTCH_SHARES = (0.2, 0.72)
"""How far in the corners between the tips lie, as a share of how far the tips lie out."""


def star_points(centre: ArrayLike, reach_m: float, turn_rad: float = 0.0) -> Array:
    """The closed outline of a five-pointed star, shape (11, 2) [m]; one tip points along +x when nothing is turned."""
    inner = math.cos(math.radians(72)) / math.cos(math.radians(36))
    radii = [reach_m if k % 2 == 0 else reach_m * inner for k in range(10)]
    angles = [turn_rad + math.pi * k / 5 for k in range(10)]
    x, y = (float(v) for v in np.asarray(centre)[:2])
    points = [(x + r * math.cos(a), y + r * math.sin(a)) for r, a in zip(radii, angles, strict=True)]
    return np.array([*points, points[0]])


def star_problem(strokes: Sequence[Array]) -> str:
    """What keeps strokes, shape (N, 2) each [m], from being one five-pointed star; "" when nothing does."""
    loop = _joined(strokes)
    if loop is None:
        return f"the line is not closed: its ends are more than {1000 * CLOSED_M:.0f} mm apart"
    corners = _corners(loop)
    if len(corners) not in (5, 10):
        return f"the line has {len(corners)} corners or bends; a five-pointed star has 10 round its outline, or 5 where the lines cross"
    middle = corners.mean(axis=0)
    away = corners - middle
    reach, angle = np.hypot(*away.T), np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    if reach.max() < LEAST_REACH_M:
        return f"its tips lie {1000 * reach.max():.0f} mm from its middle (at least {1000 * LEAST_REACH_M:.0f} mm)"
    return _crossing(reach, angle) if len(corners) == 5 else _outlined(reach, angle, corners)


def _joined(strokes: Sequence[Array]) -> Array | None:
    """All strokes as one closed line, end to end; None when they are not."""
    left = [np.asarray(stroke) for stroke in strokes]
    line = left.pop(0)
    while left:
        found = [
            (np.linalg.norm(line[-1] - end), k, flip)
            for k, one in enumerate(left)
            for end, flip in ((one[0], False), (one[-1], True))
        ]
        distance, k, flip = min(found, key=lambda one: float(one[0]))
        if distance > CLOSED_M:
            return None
        stroke = left.pop(k)
        line = np.vstack([line, stroke[::-1] if flip else stroke])
    return line if np.linalg.norm(line[0] - line[-1]) <= CLOSED_M else None


def _corners(loop: Array) -> Array:
    """Corners of the polygon that stays within `STRAIGHT_M` of a closed line, shape (N, 2)."""
    # Begin at the point farthest out: a corner, where the simplification keeps its first point.
    start = int(np.argmax(np.linalg.norm(loop - loop.mean(axis=0), axis=1)))
    line = np.vstack([loop[start:], loop[: start + 1]])
    mm = (1000 * line).astype(np.float32)[:, None, :]
    found = cv2.approxPolyDP(mm, 1000 * STRAIGHT_M, False)[:, 0] / 1000
    kept = [found[0]]
    for point in found[1:]:
        if np.linalg.norm(point - kept[-1]) > CLOSED_M:
            kept.append(point)
    if len(kept) > 1 and np.linalg.norm(kept[-1] - kept[0]) <= CLOSED_M:
        kept.pop()
    return np.array(kept)


def _even(reach: Array, turns_deg: Array, wanted_deg: float, what: str) -> str:
    if np.ptp(reach) > EVEN_SHARE * reach.mean() * 2:
        return f"its {what} lie {1000 * reach.min():.0f} to {1000 * reach.max():.0f} mm from its middle, unevenly"
    off = float(np.abs(np.abs(turns_deg) - wanted_deg).max())
    if off > EVEN_DEG:
        return f"its {what} are {off:.0f} degrees from evenly spread (at most {EVEN_DEG:.0f})"
    return ""


def _crossing(reach: Array, angle: Array) -> str:
    """Five corners that the line joins by way of the middle: each edge leaps over one of them."""
    turns = np.degrees(np.diff(np.append(angle, angle[0])))
    turns = (turns + 180.0) % 360.0 - 180.0
    if np.abs(turns).mean() < 108.0:
        return "it is a pentagon: its edges join neighbouring corners"
    return _even(reach, turns, 144.0, "tips")


def _outlined(reach: Array, angle: Array, corners: Array) -> str:
    """Ten corners in turn far out and further in."""
    first = 0 if reach[0::2].mean() > reach[1::2].mean() else 1
    tips, notches = reach[first::2], reach[1 - first :: 2]
    if not Polygon(corners).is_valid:
        return "its outline crosses itself"
    low, high = NOTCH_SHARES
    shares = notches / tips.mean()
    if shares.max() > high or shares.min() < low:
        return (
            f"the corners between its tips lie at {100 * shares.min():.0f} to {100 * shares.max():.0f} % of the tips' distance "
            f"(valid: {100 * low:.0f} to {100 * high:.0f} %)"
        )
    turns = np.degrees(np.diff(np.append(angle[first::2], angle[first])))
    turns = (turns + 180.0) % 360.0 - 180.0
    return _even(tips, turns, 72.0, "tips")
