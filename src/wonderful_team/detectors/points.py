"""Where to act on what a detector found, and how large it is and how it lies: from its mask where it has one, else from its box."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import Detection, PointRole

STANDOFF = 0.35
"""How far beside a box a push starts, in shares of its half side, as `offline` has it."""
DEEP = 0.7
"""A pixel is well inside a mask from this share of the mask's greatest depth on."""


def act_at(found: Detection, role: PointRole, towards: Point | None = None) -> Point:
    """The point for a role [px of the picture].

    pick, grasp: the middle of the mask's pixels where that lies well inside the mask, else the pixel nearest to it that does; the
    middle of the box without a mask. place, push_end: the middle of the box. push_start: beside the box, on the side away from
    where the push goes; left of it where that is not known.

    Args:
        found: What was found.
        role: What the point is for.
        towards: Where a push goes [px].
    """
    if role in ("pick", "grasp"):
        return found.box.centre if found.mask is None else _inside(found.mask)
    if role == "push_start":
        return _beside(found, towards)
    return found.box.centre


def _inside(mask: Array) -> Point:
    rows, columns = np.nonzero(mask)
    middle = float(columns.mean()) + 0.5, float(rows.mean()) + 0.5
    depth = cv2.distanceTransform(np.pad(mask.astype(np.uint8), 1), cv2.DIST_L2, 3)[1:-1, 1:-1][rows, columns]
    away = np.hypot(columns + 0.5 - middle[0], rows + 0.5 - middle[1])
    nearest = int(np.where(depth >= DEEP * depth.max(), away, np.inf).argmin())
    at_middle = (rows == int(middle[1])) & (columns == int(middle[0]))
    if at_middle.any() and depth[at_middle][0] >= DEEP * depth.max():
        return middle
    return float(columns[nearest]) + 0.5, float(rows[nearest]) + 0.5


def _beside(found: Detection, towards: Point | None) -> Point:
    (x, y), box = found.box.centre, found.box
    dx, dy = (1.0, 0.0) if towards is None else (towards[0] - x, towards[1] - y)
    length = math.hypot(dx, dy)
    dx, dy = (dx / length, dy / length) if length else (1.0, 0.0)
    reach = min(
        box.width / 2 / abs(dx) if abs(dx) > 1e-6 else math.inf,
        box.height / 2 / abs(dy) if abs(dy) > 1e-6 else math.inf,
    )
    return x - dx * reach * (1 + STANDOFF), y - dy * reach * (1 + STANDOFF)


@dataclass(frozen=True)
class Extent:
    """The tightest turned rectangle round a thing [px].

    Attributes:
        length, width: Its longer and its shorter side.
        angle_deg: Of the longer side, clockwise from the x axis as the picture shows it, 0 or more and less than 180.
    """

    length: float
    width: float
    angle_deg: float


def extent_of(found: Detection) -> Extent:
    """How large a thing is and how it lies; along the picture's edges where there is no mask."""
    if found.mask is None:
        wide = found.box.width >= found.box.height
        sides = (found.box.width, found.box.height)
        return Extent(max(sides), min(sides), 0.0 if wide else 90.0)
    rows, columns = np.nonzero(found.mask)
    _, (one, other), angle = cv2.minAreaRect(np.stack([columns, rows], axis=1).astype(np.float32))
    # The rectangle goes through the middles of the outermost pixels; y points down, so OpenCV's angle is clockwise.
    longer = angle if one >= other else angle + 90.0
    return Extent(max(one, other) + 1.0, min(one, other) + 1.0, float(longer % 180.0))
