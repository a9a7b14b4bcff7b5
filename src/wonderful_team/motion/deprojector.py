"""Pixels to metres: onto the visible surface where depth is known, else onto the table plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, PlanarCamera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.geometry.boxes import level_all_round
from wonderful_team.core.geometry.cameras import Camera
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import View

TABLE_Z_M = 0.0
"""Height of the table in the base frame [m]."""
RING_SHARE = 0.15
"""How far round a box its surroundings are measured (share of its smaller side)."""
DEPTH_NOISE_M = 0.01
"""Surfaces seen less than this below the table are the table; what lies deeper is beside it [m]."""
STEP_M = 0.004
"""From one cell to the next a surface rises or falls by no more than this [m]: in the finest cells, at 45 degrees."""
FINEST_M = 0.004
"""Finest cells in which a surface is followed [m]."""
REACH_M = 0.35
"""How far round a point one surface may reach [m]."""
LEAST_APART_PX = 4.0
"""Points that are closer to each other count as so far apart [px]."""
_WINDOW_PER_PX = 1 / 150
"""Half width of the depth window per pixel of the view's smaller side: 1 px in a 128 px view, 5 px in a 720 px one."""


@dataclass(frozen=True, eq=False)
class ResolvedPoint:
    """A pixel of the main view, the point in the base frame that it stands for, and the rule that made it one.

    Attributes:
        position_m: Shape (3,) [m]; None without a camera.
    """

    px: Point
    position_m: Array | None
    how: str


@dataclass(frozen=True, eq=False)
class Deprojector:
    """Turns pixels of one view into points of the base frame."""

    view: View

    @property
    def camera(self) -> Camera | None:
        return self.view.camera

    def inside(self, px: Point) -> bool:
        """Whether a pixel lies in the view."""
        width, height = self.view.size_px
        return 0 <= px[0] <= width and 0 <= px[1] <= height

    def surface(self, px: Point, name: str) -> ResolvedPoint:
        """The visible surface at a pixel: by depth where there is any near it, else on the table plane."""
        if self.camera is None:
            return ResolvedPoint(px, None, f"{name}, no camera: pixels only")
        depth_m = None if isinstance(self.camera, PlanarCamera) else self._depth_near(px)
        if depth_m is None:
            return self.at_height(px, self._plane_z_m, f"{name}, on the table plane (no depth there)")
        position = np.asarray(self.camera.deproject([px], [depth_m])[0])
        how = f"{name}, depth {depth_m:.3f} m"
        if TABLE_Z_M - DEPTH_NOISE_M <= position[2] < TABLE_Z_M:
            return self.at_height(px, TABLE_Z_M, f"{how}, on the table")
        return ResolvedPoint(px, position, how)

    def at_height(self, px: Point, z_m: float, how: str) -> ResolvedPoint:
        """Where a pixel's ray meets a height."""
        if self.camera is None:
            return ResolvedPoint(px, None, how)
        return ResolvedPoint(px, np.asarray(self.camera.on_plane([px], z_m)[0]), how)

    def support_z_m(self, box: Box | None, below_m: float = math.inf) -> float:
        """Height of what a boxed thing stands on, measured just round its box; the table's without a box or depth.

        Neighbours stand higher than the support, so a low quantile of the heights is taken; what lies lower than the
        table is beside it and supports nothing. Nor does what stands higher than the thing itself: round a thing in a
        bowl is the bowl's rim, and the bowl's floor shows between.

        Args:
            box: Where the thing shows [px].
            below_m: Height of a point of the thing; what is higher does not support it [m].
        """
        if self.camera is None or box is None or isinstance(self.camera, PlanarCamera):
            return self._plane_z_m
        margin = max(2.0, RING_SHARE * min(box.width, box.height))
        spots = [self.surface(px, "round the box") for px in _outline(box.grown(*[margin] * 4)) if self.inside(px)]
        heights = [float(spot.position_m[2]) for spot in spots if spot.position_m is not None]
        supports = [height for height in heights if TABLE_Z_M <= height < below_m]
        if heights and not supports and math.isfinite(below_m):
            inside = [self.surface(px, "inside the box").position_m for px in _grid(box) if self.inside(px)]
            lower = [float(at[2]) for at in inside if at is not None and TABLE_Z_M <= at[2] < below_m]
            supports = [min(lower)] if lower else []
        found = float(np.quantile(supports, 0.25)) if supports else self._plane_z_m
        close = self._all_round(box)
        return close if close is not None and found < close < below_m else found

    def _all_round(self, box: Box) -> float | None:
        """Height of one level that shows close to a box on all four of its sides [m]; None where there is none."""
        sides = []
        for side in box.sides:
            seen = [self.surface(px, "side").position_m for px in side.scaled(0.5).corners if self.inside(px)]
            sides.append([float(at[2]) for at in seen if at is not None])
        return level_all_round(sides)

    def one_surface(self, one: Point, other: Point, box: Box | None = None) -> bool:
        """Whether depth shows a surface that hangs together from a pixel to another, level or aslant, round holes too.

        It is looked at from above, where a wall, which a tilted camera sees as a slope, is the step that it is.

        Args:
            one: Where it starts [px].
            other: Where it is to lead [px].
            box: What shows outside it does not count [px]; without one, what is farther off than the two are from each other.
        """
        camera, depth = self.camera, self.view.depth_m
        if camera is None or isinstance(camera, PlanarCamera) or depth is None:
            return False
        if box is None:
            side = 3 * max(math.dist(one, other), LEAST_APART_PX)
            box = Box.around(((one[0] + other[0]) / 2, (one[1] + other[1]) / 2), side, side)
        start, end = (self.surface(px, "end").position_m for px in (one, other))
        low_x, low_y = max(0, math.floor(box.x0)), max(0, math.floor(box.y0))
        part = depth[low_y : max(0, math.ceil(box.y1)), low_x : max(0, math.ceil(box.x1))]
        rows, columns = np.nonzero(np.isfinite(part) & (part > 0))
        if start is None or end is None or not len(rows):
            return False
        px = np.column_stack([columns + low_x, rows + low_y]) + 0.5
        return _hang_together(np.asarray(camera.deproject(px, part[rows, columns])), start, end)

    def to_px(self, position_m: Array) -> Point:
        """The pixel at which a point of the base frame shows; only with a camera."""
        assert self.camera is not None
        x, y = self.camera.project([position_m])[0]
        return float(x), float(y)

    @property
    def _plane_z_m(self) -> float:
        return self.camera.plane_z_m if isinstance(self.camera, PlanarCamera) else TABLE_Z_M

    def _depth_near(self, px: Point) -> float | None:
        """Median of the valid depths in a small window; the window grows up to three times when there is none."""
        depth = self.view.depth_m
        if depth is None:
            return None
        height, width = depth.shape
        column, row = min(int(px[0]), width - 1), min(int(px[1]), height - 1)
        reach = max(1, round(min(width, height) * _WINDOW_PER_PX))
        for radius in (reach, 2 * reach, 3 * reach):
            window = depth[max(0, row - radius) : row + radius + 1, max(0, column - radius) : column + radius + 1]
            valid = window[np.isfinite(window) & (window > 0)]
            if valid.size:
                return _median(valid)
        return None


def _median(values: Array) -> float:
    """What numpy's `median` gives for a few finite numbers, in a quarter of its time."""
    ordered, half = np.sort(values, axis=None), values.size // 2
    if values.size % 2:
        return float(ordered[half])
    return float((ordered[half - 1] + ordered[half]) / ordered.dtype.type(2))


def _hang_together(points: Array, one: Array, other: Array) -> bool:
    """Whether the highest of these points, shape (N, 3) [m], lead from one place to another without a step."""
    apart = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
    cell_m = max(2 * float(np.median(apart)), FINEST_M) if len(apart) else FINEST_M
    count = 2 * math.ceil(REACH_M / cell_m) + 1
    cells = np.floor((np.vstack([one, other, points])[:, :2] - one[:2]) / cell_m).astype(np.int64) + count // 2
    inside = np.asarray(((cells >= 0) & (cells < count)).all(axis=1))
    if not inside[1]:
        return False
    heights = np.full((count, count), TABLE_Z_M - 2 * REACH_M, np.float32)
    of_points = cells[2:][inside[2:]]
    np.maximum.at(heights, (of_points[:, 1], of_points[:, 0]), points[inside[2:], 2].astype(np.float32))
    reached = np.zeros((count + 2, count + 2), np.uint8)
    seed = (int(cells[0, 0]), int(cells[0, 1]))
    cv2.floodFill(heights, reached, seed, 0.0, STEP_M, STEP_M, 4 | cv2.FLOODFILL_MASK_ONLY | (1 << 8))
    return bool(reached[cells[1, 1] + 1, cells[1, 0] + 1])


def _grid(box: Box) -> list[Point]:
    """A hundred points inside a box."""
    shares = [(k + 0.5) / 10 for k in range(10)]
    return [(box.x0 + box.width * a, box.y0 + box.height * b) for b in shares for a in shares]


def _outline(box: Box) -> list[Point]:
    """Sixteen points along a box's outline."""
    corners = [*box.corners, box.corners[0]]
    return [
        (a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share)
        for a, b in zip(corners, corners[1:], strict=False)
        for share in (0.0, 0.25, 0.5, 0.75)
    ]
