"""Cameras: pixels to metres in the robot base frame and back. Pixels are (u right, v down), origin top-left.

Pixel coordinates are continuous: the top-left pixel covers 0..1, so its centre is (0.5, 0.5).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from wonderful_team.core.geometry.arrays import Array, as_points, frozen_array
from wonderful_team.core.geometry.poses import Pose
from wonderful_team.errors import ConfigError, MissingDepthError


@runtime_checkable
class Camera(Protocol):
    """What the planner needs of a camera; all points in the robot base frame."""

    def project(self, points_m: ArrayLike) -> Array:
        """Points, shape (N, 3) [m], to pixels, shape (N, 2)."""
        ...

    def deproject(self, points_px: ArrayLike, depth_m: ArrayLike) -> Array:
        """Pixels, shape (N, 2), with distance along the optical axis, shape (N,) [m], to points, shape (N, 3) [m]."""
        ...

    def on_plane(self, points_px: ArrayLike, z_m: float) -> Array:
        """Where the pixels' rays meet the horizontal plane at height z [m]; shape (N, 3) [m]."""
        ...


def _checked_depth(points_px: Array, depth_m: ArrayLike) -> Array:
    depth = np.atleast_1d(np.asarray(depth_m, dtype=np.float64))
    if depth.shape != (len(points_px),):
        raise ValueError(f"depth_m: expected shape ({len(points_px)},), got {depth.shape}")
    bad = ~(np.isfinite(depth) & (depth > 0))
    if bad.any():
        raise MissingDepthError(f"depth_m: no depth at pixels {points_px[bad].round(1).tolist()}")
    return depth


@dataclass(frozen=True, eq=False)
class PinholeCamera:
    """A pinhole camera without distortion.

    Attributes:
        K: Intrinsics [px], shape (3, 3).
        T_base_cam: Pose of the camera (x right, y down, z forward) in the base frame.

    Source: Hartley & Zisserman, Multiple View Geometry, 2nd ed., ch. 6.
    """

    K: Array
    T_base_cam: Pose

    def __post_init__(self) -> None:
        K = frozen_array(self.K, (3, 3), "K")
        if K[0, 0] <= 0 or K[1, 1] <= 0:
            raise ValueError(f"K: focal lengths must be positive, got {K[0, 0]} and {K[1, 1]}")
        if not np.array_equal(K[2], (0.0, 0.0, 1.0)) or np.linalg.det(K) <= 1e-6 * K[0, 0] * K[1, 1]:
            raise ValueError(
                f"K: expected [[fx, skew, cx], [0, fy, cy], [0, 0, 1]] [px], or that turned in the picture, got {K.tolist()}"
            )
        if not isinstance(self.T_base_cam, Pose):
            given = np.shape(self.T_base_cam) if isinstance(self.T_base_cam, np.ndarray | list | tuple) else ""
            raise TypeError(
                f"T_base_cam: expected a Pose, got {type(self.T_base_cam).__name__}{f' of shape {given}' if given else ''}; "
                "valid: Pose(position_m, quaternion_wxyz), or Pose.from_matrix(T) for a 4 x 4 matrix"
            )
        object.__setattr__(self, "K", K)

    def project(self, points_m: ArrayLike) -> Array:
        points = self.T_base_cam.inverse().apply(points_m)
        if (points[:, 2] <= 1e-9).any():
            raise ValueError("points_m: a point lies behind the camera")
        pixels = points @ self.K.T
        return np.asarray(pixels[:, :2] / pixels[:, 2:])

    def deproject(self, points_px: ArrayLike, depth_m: ArrayLike) -> Array:
        points = as_points(points_px, 2, "points_px")
        depth = _checked_depth(points, depth_m)
        return self.T_base_cam.apply(self._rays(points) * depth[:, None])

    def on_plane(self, points_px: ArrayLike, z_m: float) -> Array:
        rays = self._rays(as_points(points_px, 2, "points_px")) @ self.T_base_cam.rotation.T
        origin = self.T_base_cam.position_m
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = (z_m - origin[2]) / rays[:, 2]
        if not (np.isfinite(reach) & (reach > 0)).all():
            raise ValueError(f"a ray never meets the plane z = {z_m:.3f} m in front of the camera")
        return np.asarray(origin + rays * reach[:, None])

    def _rays(self, points_px: Array) -> Array:
        homogeneous = np.column_stack([points_px, np.ones(len(points_px))])
        return np.asarray(np.linalg.solve(self.K, homogeneous.T).T)


@dataclass(frozen=True, eq=False)
class AffineCamera:
    """An affine (orthographic) camera: pixels are a linear function of the point.

    Attributes:
        matrix: Shape (3, 4): rows give u [px], v [px] and depth along the optical axis [m] from (x, y, z, 1) [m].
    """

    matrix: Array

    def __post_init__(self) -> None:
        matrix = frozen_array(self.matrix, (3, 4), "matrix")
        if abs(np.linalg.det(matrix[:, :3])) < 1e-12:
            raise ValueError("matrix: u, v and depth must be independent")
        object.__setattr__(self, "matrix", matrix)

    def project(self, points_m: ArrayLike) -> Array:
        points = as_points(points_m, 3, "points_m")
        return np.asarray(points @ self.matrix[:2, :3].T + self.matrix[:2, 3])

    def deproject(self, points_px: ArrayLike, depth_m: ArrayLike) -> Array:
        points = as_points(points_px, 2, "points_px")
        # A row for each number, as the solver wants them: copying points into rows takes as long as a fifth of the solving.
        seen = np.stack([*points.T, _checked_depth(points, depth_m)])
        seen -= self.matrix[:, 3:]
        return self._seen.solved(seen).T

    def on_plane(self, points_px: ArrayLike, z_m: float) -> Array:
        points = as_points(points_px, 2, "points_px")
        if self._level is None:
            raise ValueError("this camera looks along the plane: pixels do not fix a point on it")
        right = np.empty((3, len(points)))
        right[:2], right[2] = (points - self.matrix[:2, 3]).T, z_m
        return self._level.solved(right).T

    @cached_property
    def _seen(self) -> _System:
        return _System(self.matrix[:, :3])

    @cached_property
    def _level(self) -> _System | None:
        """Pixels and a height; None where pixels do not fix a point of a level plane."""
        matrix = np.vstack([self.matrix[:2, :3], (0.0, 0.0, 1.0)])
        return None if abs(np.linalg.det(matrix)) < 1e-12 else _System(matrix)


class _System:
    """Three linear equations, solved again and again.

    A camera that looks along an axis of the base gives each coordinate by one number alone: ten times as fast for a whole picture and for
    a point. As LAPACK does, it divides for one point and multiplies by the inverse for several, so that the results are the same to the
    last bit.
    """

    def __init__(self, matrix: Array) -> None:
        self._matrix = matrix
        rows, columns = (axis.tolist() for axis in np.nonzero(matrix))
        each = len(rows) == 3 and len(set(rows)) == len(set(columns)) == 3  # noqa: PLR2004  one number for each coordinate
        self._numbers = (
            [(row, column, float(matrix[row, column])) for row, column in zip(rows, columns, strict=True)]
            if each
            else None
        )

    def solved(self, right: Array) -> Array:
        """The solution for what stands on the right, shape (3, N)."""
        if self._numbers is None:
            return np.asarray(np.linalg.solve(self._matrix, right))
        found = np.empty_like(right)
        for row, column, number in self._numbers:
            if right.shape[1] == 1:
                found[column, 0] = right[row, 0] / number
            else:
                np.multiply(right[row], 1 / number, out=found[column])
        return found


@dataclass(frozen=True, eq=False)
class PlanarCamera:
    """A homography between picture and table, fitted to four marked corners; knows the table plane only.

    Attributes:
        H_table_px: Maps homogeneous pixels to homogeneous (x, y) on the table [m], shape (3, 3); its third row gives
            positive numbers for what lies before the camera and negative ones beyond the table's horizon.
        plane_z_m: Height of that plane in the base frame [m].
    """

    H_table_px: Array
    plane_z_m: float = 0.0

    def __post_init__(self) -> None:
        matrix = frozen_array(self.H_table_px, (3, 3), "H_table_px")
        if abs(np.linalg.det(matrix)) < 1e-15:
            raise ValueError("H_table_px: cannot be inverted")
        object.__setattr__(self, "H_table_px", matrix)

    @classmethod
    def from_corners(cls, corners_px: ArrayLike, corners_m: ArrayLike, plane_z_m: float = 0.0) -> PlanarCamera:
        """Fit to four corners, in the same order: pixels, shape (4, 2), and table points, shape (4, 2) [m].

        Raises:
            ConfigError: Three corners lie on one line, or no camera sees the corners so: they do not fix the table.
        """
        pixels, metres = as_points(corners_px, 2, "corners_px"), as_points(corners_m, 2, "corners_m")
        if len(pixels) != 4 or len(metres) != 4:
            raise ConfigError(f"corners: exactly four are needed, got {len(pixels)} pixels and {len(metres)} metres")
        rows = []
        for (u, v), (x, y) in zip(pixels, metres, strict=True):
            rows.append([u, v, 1, 0, 0, 0, -x * u, -x * v, -x])
            rows.append([0, 0, 0, u, v, 1, -y * u, -y * v, -y])
        for points in (pixels, metres):
            for left_out in range(4):
                (ax, ay), (bx, by), (cx, cy) = np.delete(points, left_out, axis=0)
                span = max(float(np.ptp(points)), 1e-12)
                if abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) < 1e-4 * span * span:
                    raise ConfigError(
                        f"corners: three of {points.tolist()} lie on one line; give the table's four corners"
                    )
        # The solution of the homogeneous system is the last right singular vector.
        matrix = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
        matrix = matrix / np.linalg.norm(matrix)
        scale = np.column_stack([pixels, np.ones(4)]) @ matrix[2]
        if scale.min() <= 0 <= scale.max():
            raise ConfigError(
                f"corners: no camera sees a table with corners {metres.tolist()} m at {pixels.tolist()} px; "
                "give them in the same order round the table"
            )
        return cls(matrix * np.sign(scale[0]), plane_z_m)

    def project(self, points_m: ArrayLike) -> Array:
        points = as_points(points_m, 3, "points_m")
        flat = np.column_stack([points[:, :2], np.ones(len(points))])
        pixels = np.linalg.solve(self.H_table_px, flat.T).T
        if not (pixels[:, 2] > 1e-12).all():
            raise ValueError("points_m: a point lies behind the camera")
        return np.asarray(pixels[:, :2] / pixels[:, 2:])

    def deproject(self, points_px: ArrayLike, depth_m: ArrayLike) -> Array:
        raise ConfigError("four corners give the table plane only; depth needs a calibrated camera (--camera FILE)")

    def on_plane(self, points_px: ArrayLike, z_m: float) -> Array:
        points = as_points(points_px, 2, "points_px")
        table = np.column_stack([points, np.ones(len(points))]) @ self.H_table_px.T
        if not (table[:, 2] > 1e-12).all():
            beyond = points[~(table[:, 2] > 1e-12)].round(1).tolist()
            raise ValueError(f"pixels {beyond} lie above the table's horizon: their rays never meet the table")
        flat = table[:, :2] / table[:, 2:]
        # A homography knows nothing of height: points above the table are read as if they lay on it.
        return np.column_stack([flat, np.full(len(points), z_m)])
