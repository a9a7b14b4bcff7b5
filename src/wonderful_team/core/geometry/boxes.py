"""Axis-aligned boxes in pixels: origin top-left, x right, y down."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

CLOSE_PX, CLOSE_SHARE = 4.0, 0.04
"""What is no farther from a box than this many pixels, or this share of its shorter side, is close to it."""
LEVEL_M = 0.005
"""Heights close to a box that differ by no more are one level [m]."""


def level_all_round(sides: Sequence[Sequence[float]]) -> float | None:
    """Height of one level that shows on all four sides of a box [m]; None where there is none.

    Args:
        sides: Heights that were seen in each of `Box.sides` [m].
    """
    levels = [statistics.median(heights) for heights in sides if len(heights)]
    return min(levels) if len(levels) == 4 and max(levels) - min(levels) <= LEVEL_M else None


@dataclass(frozen=True)
class Box:
    """A box (x0, y0, x1, y1) [px] with x0 < x1 and y0 < y1; edges are real numbers, not pixel indices.

    Raises:
        ValueError: An edge is not finite or the box is empty.
    """

    x0: float
    y0: float
    x1: float
    y1: float

    def __post_init__(self) -> None:
        values = tuple(float(v) for v in (self.x0, self.y0, self.x1, self.y1))
        if not all(math.isfinite(v) for v in values):
            raise ValueError(f"box edges must be finite, got {values}")
        if values[0] >= values[2] or values[1] >= values[3]:
            raise ValueError(f"box must have x0 < x1 and y0 < y1, got {values}")
        for name, value in zip(("x0", "y0", "x1", "y1"), values, strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    def around(cls, centre: tuple[float, float], width: float, height: float) -> Box:
        """A box of the given size [px] round a centre (x, y) [px]."""
        return cls(centre[0] - width / 2, centre[1] - height / 2, centre[0] + width / 2, centre[1] + height / 2)

    @classmethod
    def bounding(cls, points: Iterable[tuple[float, float]]) -> Box:
        """The smallest box that holds all points (x, y) [px]."""
        xs, ys = zip(*points, strict=True)
        return cls(min(xs), min(ys), max(xs), max(ys))

    @property
    def width(self) -> float:
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        return self.y1 - self.y0

    @property
    def area(self) -> float:
        return self.width * self.height

    @property
    def centre(self) -> tuple[float, float]:
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Clockwise from the top left."""
        return (self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1)

    @property
    def as_tuple(self) -> tuple[float, float, float, float]:
        return self.x0, self.y0, self.x1, self.y1

    def contains(self, point: tuple[float, float]) -> bool:
        """Whether a point (x, y) [px] lies inside or on the edge."""
        return self.x0 <= point[0] <= self.x1 and self.y0 <= point[1] <= self.y1

    def shifted(self, dx: float, dy: float) -> Box:
        return Box(self.x0 + dx, self.y0 + dy, self.x1 + dx, self.y1 + dy)

    def grown(self, left: float, top: float, right: float, bottom: float) -> Box:
        """Move each edge outward by that much [px]; negative moves it inward."""
        return Box(self.x0 - left, self.y0 - top, self.x1 + right, self.y1 + bottom)

    @property
    def sides(self) -> tuple[Box, Box, Box, Box]:
        """Strips close to its four sides, without the corners: left, right, above, below.

        Of what lies askew on a larger thing, the corners of the box and all that is farther off show what lies beside both.
        """
        deep = max(CLOSE_PX, CLOSE_SHARE * min(self.width, self.height))
        x, y = self.width / 6, self.height / 6
        return (
            Box(self.x0 - deep, self.y0 + y, self.x0 - deep / 2, self.y1 - y),
            Box(self.x1 + deep / 2, self.y0 + y, self.x1 + deep, self.y1 - y),
            Box(self.x0 + x, self.y0 - deep, self.x1 - x, self.y0 - deep / 2),
            Box(self.x0 + x, self.y1 + deep / 2, self.x1 - x, self.y1 + deep),
        )

    def scaled(self, factor: float) -> Box:
        """The same centre, sides times `factor`."""
        return Box.around(self.centre, self.width * factor, self.height * factor)

    def intersection(self, other: Box) -> Box | None:
        """What both boxes share, or None."""
        x0, y0 = max(self.x0, other.x0), max(self.y0, other.y0)
        x1, y1 = min(self.x1, other.x1), min(self.y1, other.y1)
        return Box(x0, y0, x1, y1) if x0 < x1 and y0 < y1 else None

    def iou(self, other: Box) -> float:
        """Intersection over union, 0 to 1."""
        shared = self.intersection(other)
        if shared is None:
            return 0.0
        return shared.area / (self.area + other.area - shared.area)
