"""The surface that depth shows: points in the base frame, and what stands where."""

from __future__ import annotations

import math
import threading
import weakref
from collections import deque
from dataclasses import dataclass, field, replace
from typing import Any

import cv2
import numpy as np
import shapely
from shapely import LineString, MultiPoint

from wonderful_team.core.geometry import Box, PlanarCamera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.geometry.boxes import level_all_round
from wonderful_team.core.values import View

FARTHEST_M = 50.0
"""Depth beyond this is none [m]."""
RAISED_M = 0.004
"""What is at least this much higher than the table is not the table: more than a sheet of paper and sensor noise."""
STEP_M = 0.006
"""Neighbouring parts of one surface differ by less than this in height [m]."""
AROUND_M = 0.35
"""How far round a point one thing may reach [m]."""
_QUAD_SEGS = 16
"""Sides of a quarter circle."""
_SURELY_INSIDE = 0.99 * math.cos(math.pi / (4 * _QUAD_SEGS))
"""So near to the middle, as a share of the radius, the sides of such a circle are farther out."""
_FINEST_M = 0.004
"""Finest cells that heights are looked up in [m]."""


@dataclass(frozen=True, eq=False)
class Relief:
    """Points of the visible surface.

    Attributes:
        xyz_m: Base frame, shape (N, 3) [m].
        px: Pixel of the view at which each was seen, shape (N, 2); NaN for points that are only expected. Fast where a column
            of it lies together in memory.
        spacing_m: Usual distance between neighbouring points [m].
        row_starts: Where each row of the view starts among the points, and where the last one ends, shape (rows + 1,). Whatever
            comes behind is only expected. Empty where that is not known.
    """

    xyz_m: Array
    px: Array
    spacing_m: float
    row_starts: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @classmethod
    def of(cls, view: View) -> Relief | None:
        """What a view shows; None without depth or a camera that turns it into metres. It may hold no point at all."""
        with _lock:
            known = next((relief for held, relief in _latest if held() is view), _UNKNOWN)
        if known is _UNKNOWN:
            known = cls._made(view)
            with _lock:
                _latest.append((weakref.ref(view), known))
        return known  # type: ignore[return-value]

    @classmethod
    def _made(cls, view: View) -> Relief | None:
        camera, depth = view.camera, view.depth_m
        if depth is None or camera is None or isinstance(camera, PlanarCamera):
            return None
        known = np.isfinite(depth) & (depth > 0) & (depth <= FARTHEST_M)
        rows, columns = np.nonzero(known)
        if len(rows) == 0:
            return cls(np.zeros((0, 3)), np.zeros((0, 2)), _FINEST_M)
        px = np.stack([columns, rows]).T + 0.5
        points = np.array(camera.deproject(px, depth[known]), dtype=np.float64)
        heights = np.full(depth.shape, np.nan, np.float32)
        heights[known] = points[:, 2]
        points[:, 2] = np.minimum(points[:, 2], _without_specks(heights)[known])
        steps = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
        spacing_m = float(max(np.median(steps), 1e-4)) if len(steps) else _FINEST_M
        return cls(points, px, spacing_m, np.append(0, np.cumsum(known.sum(axis=1))))

    def with_expected(self, points_m: Array) -> Relief:
        """A copy with points behind its own that are only expected, shape (M, 3) [m]."""
        unseen = np.full((2, len(points_m)), np.nan)
        return replace(
            self,
            xyz_m=np.concatenate([self.xyz_m.T, points_m.T], axis=1).T,
            px=np.concatenate([self.px.T, unseen], axis=1).T,
        )

    @property
    def cell_m(self) -> float:
        """Side of a cell that surely holds a point where the surface was seen [m]."""
        return max(2 * self.spacing_m, _FINEST_M)

    def in_box(self, box: Box) -> Array:
        """Which points show in a box of the view, shape (N,) bool."""
        found = np.zeros(len(self.px), dtype=bool)
        rows, inside = self._rows_in_box(box)
        found[rows] = inside
        return found

    def _rows_in_box(self, box: Box) -> tuple[slice, Array]:
        """The points of the rows that a box of the view touches, and which of them show in it."""
        rows = slice(0, len(self.px))
        if len(self.row_starts):
            last = len(self.row_starts) - 1
            low = min(max(math.ceil(box.y0 - 0.5), 0), last)
            high = min(max(math.floor(box.y1 - 0.5) + 1, low), last)
            rows = slice(int(self.row_starts[low]), int(self.row_starts[high]))
        x, y = self.px[rows].T
        return rows, np.asarray((x >= box.x0) & (x <= box.x1) & (y >= box.y0) & (y <= box.y1))

    def all_round(self, box: Box) -> float | None:
        """Height of one level that shows close to a box of the view on all four of its sides [m]; None where there is none."""
        sides = [self._rows_in_box(side) for side in box.sides]
        return level_all_round([self.xyz_m[rows, 2][inside].tolist() for rows, inside in sides])

    def inside(self, region: Any) -> Array:
        """Which points lie in a region of the table (a shapely shape), shape (N,) bool."""
        x, y = self.xyz_m[:, 0], self.xyz_m[:, 1]
        low_x, low_y, high_x, high_y = region.bounds
        found = np.asarray((x >= low_x) & (x <= high_x) & (y >= low_y) & (y <= high_y))
        found[found] = shapely.contains_xy(region, x[found], y[found])
        return found

    def along(self, start_m: Array, end_m: Array, reach_m: float) -> Array:
        """Which points lie within reach of a straight way over the table, shape (N,) bool: those inside `round_way`."""
        way = round_way(start_m, end_m, reach_m)
        low_x, low_y, high_x, high_y = way.bounds
        x, y = self.xyz_m[:, 0], self.xyz_m[:, 1]
        found = np.asarray((x >= low_x) & (x <= high_x) & (y >= low_y) & (y <= high_y))
        # The shape is asked about its rim alone, where its corners stand on the circle and its sides lie a little inside.
        x, y = x[found], y[found]
        along_x, along_y = (float(one) for one in end_m[:2] - start_m[:2])
        x_off, y_off = x - start_m[0], y - start_m[1]
        share = np.clip((x_off * along_x + y_off * along_y) / (along_x**2 + along_y**2), 0.0, 1.0)
        apart2 = ((x_off - share * along_x) ** 2 + (y_off - share * along_y) ** 2) / reach_m**2
        inside = apart2 <= _SURELY_INSIDE**2
        rim = ~inside & (apart2 <= 1 + 1e-9)
        inside[rim] = shapely.contains_xy(way, x[rim], y[rim])
        found[found] = inside
        return found

    def near(self, xy_m: Array, radius_m: float) -> Array:
        """Which points lie within a radius of a point of the table, shape (N,) bool."""
        x, y = self.xyz_m[:, 0] - xy_m[0], self.xyz_m[:, 1] - xy_m[1]
        # The square round the circle first, a little larger than need be: most points lie outside, and roots are slow.
        reach = radius_m * (1 + 1e-9)
        found = np.asarray((np.abs(x) <= reach) & (np.abs(y) <= reach))
        found[found] = np.hypot(x[found], y[found]) <= radius_m
        return found

    def surface_m(self, xy_m: Array, but: Array | None = None) -> float | None:
        """Height of the surface at a point of the table [m]; None where nothing near it was seen.

        Args:
            xy_m: The point, shape (2,) [m].
            but: Points to leave out, shape (N,) bool.
        """
        for factor in (0.75, 1.5, 3.0):
            found = self.near(xy_m, factor * self.cell_m)
            if but is not None:
                found &= ~but
            if found.any():
                return float(np.median(self.xyz_m[found, 2]))
        return None

    def patch(self, xy_m: Array, table_z_m: float) -> Array | None:
        """Which points belong to the even surface at a point, shape (N,) bool; None where it is the bare table."""
        heights, low = self._raster(xy_m, table_z_m)
        seed = self._cell(xy_m, low)
        if heights[seed[1], seed[0]] <= table_z_m + RAISED_M:
            return None
        walls = np.zeros((heights.shape[0] + 2, heights.shape[1] + 2), np.uint8)
        walls[1:-1, 1:-1] = heights <= table_z_m + RAISED_M
        cv2.floodFill(heights, walls, seed, 0.0, STEP_M, STEP_M, 4 | cv2.FLOODFILL_MASK_ONLY | (2 << 8))
        return self._points_in(walls[1:-1, 1:-1] == 2, low)

    def standing(self, xy_m: Array, table_z_m: float) -> Any | None:
        """Outline of everything that stands together at a point, as a convex shape; None where it is the bare table."""
        heights, low = self._raster(xy_m, table_z_m)
        _, labels = cv2.connectedComponents((heights > table_z_m + RAISED_M).astype(np.uint8))
        column, row = self._cell(xy_m, low)
        if labels[row, column] == 0:
            return None
        found = self._points_in(labels == labels[row, column], low)
        return outline(self.xyz_m[found, :2], self.spacing_m) if found.any() else None

    def _raster(self, xy_m: Array, table_z_m: float) -> tuple[Array, Array]:
        """Highest point of every cell round a point, float32, and the corner where the cells start [m]."""
        count = max(3, 2 * int(np.ceil(AROUND_M / self.cell_m)) + 1)
        low = np.asarray(xy_m[:2]) - (count / 2) * self.cell_m
        heights = np.full((count, count), table_z_m, np.float32)
        cells = np.floor((self.xyz_m[:, :2] - low) / self.cell_m).astype(np.int64)
        inside = ((cells >= 0) & (cells < count)).all(axis=1)
        np.maximum.at(heights, (cells[inside, 1], cells[inside, 0]), self.xyz_m[inside, 2].astype(np.float32))
        return heights, low

    def _cell(self, xy_m: Array, low: Array) -> tuple[int, int]:
        column, row = np.floor((np.asarray(xy_m[:2]) - low) / self.cell_m).astype(int)
        return int(column), int(row)

    def _points_in(self, cells: Array, low: Array) -> Array:
        at = np.floor((self.xyz_m[:, :2] - low) / self.cell_m).astype(np.int64)
        found = ((at >= 0) & (at < cells.shape[0])).all(axis=1)
        found[found] = cells[at[found, 1], at[found, 0]]
        return np.asarray(found)


_UNKNOWN = object()
_lock = threading.Lock()
_latest: deque[tuple[weakref.ref[View], Relief | None]] = deque(maxlen=2)
"""Of the last views asked about: the gate and what follows an execution look at the same one several times."""


def round_way(start_m: Array, end_m: Array, reach_m: float) -> Any:
    """The shape of all that lies within reach of a straight way over the table; the way has a length."""
    return LineString([start_m[:2], end_m[:2]]).buffer(reach_m, quad_segs=_QUAD_SEGS)


def outline(xy_m: Array, spacing_m: float) -> Any:
    """The convex shape round points of the table, shape (N, 2) [m], each as wide as their spacing."""
    points = np.asarray(xy_m, dtype=np.float64)
    # The hull is that of the points, whatever holds them; a line is built ten times as fast.
    held = shapely.linestrings(points) if len(points) > 2 else MultiPoint(points)  # noqa: PLR2004  fewer make no line
    return shapely.convex_hull(held).buffer(spacing_m / 2, quad_segs=2)


def covered(places_m: Array, points_m: Array, cell_m: float) -> Array:
    """Which of `points_m`, shape (N, 2), lie in a cell that one of `places_m`, shape (M, 2), lies in; shape (N,) bool."""
    both = np.floor(np.vstack([places_m, points_m]) / cell_m).astype(np.int64)
    both -= both.min(axis=0)
    codes = both[:, 0] * (int(both[:, 1].max()) + 1) + both[:, 1]
    return np.asarray(np.isin(codes[len(places_m) :], codes[: len(places_m)]))


def _without_specks(heights: Array) -> Array:
    """Heights without peaks thinner than three pixels, which are noise at the edges of things; NaN where unknown."""
    kernel = np.ones((3, 3), np.uint8)
    lost = ~np.isfinite(heights)
    low = cv2.erode(np.where(lost, np.float32(1e9), heights), kernel)
    opened = cv2.dilate(np.where(low >= 1e9, np.float32(-1e9), low), kernel)
    return np.asarray(np.where(lost, np.nan, opened))
