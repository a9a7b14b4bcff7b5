"""Poses in the robot base frame. Angles are radians inside; quaternions are wxyz."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from wonderful_team.core.geometry.arrays import Array, as_points, frozen_array


def wrap_angle(angle_rad: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle_rad, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid pose.

    Attributes:
        position_m: Shape (3,) [m].
        quaternion_wxyz: Unit quaternion, shape (4,); normalised when built.
    """

    position_m: Array
    quaternion_wxyz: Array

    def __post_init__(self) -> None:
        quaternion = np.asarray(self.quaternion_wxyz, dtype=np.float64)
        if quaternion.shape != (4,):
            raise ValueError(f"quaternion_wxyz: expected shape (4,), got {quaternion.shape}")
        norm = math.sqrt(quaternion.dot(quaternion))
        if norm < 1e-9:
            raise ValueError("quaternion_wxyz: length must not be zero")
        # What is of length 1 already stays as it is, so that a pose survives its file to the last digit.
        norm = 1.0 if abs(norm - 1.0) < 1e-12 else norm
        object.__setattr__(self, "position_m", frozen_array(self.position_m, (3,), "position_m"))
        object.__setattr__(self, "quaternion_wxyz", frozen_array(quaternion / norm, (4,), "quaternion_wxyz"))

    @classmethod
    def at(cls, position_m: ArrayLike, yaw_rad: float = 0.0) -> Pose:
        """A pose turned by `yaw_rad` about the vertical axis."""
        return cls(np.asarray(position_m), np.array([math.cos(yaw_rad / 2), 0, 0, math.sin(yaw_rad / 2)]))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Pose:
        """The pose that a homogeneous matrix, shape (4, 4), describes.

        Raises:
            ValueError: Another shape or last row, or its 3 x 3 part is not a rotation.
        """
        T = np.array(matrix, dtype=np.float64)
        if T.shape != (4, 4) or not np.allclose(T[3], (0, 0, 0, 1)):
            raise ValueError(f"expected a 4 x 4 pose with last row 0 0 0 1, got shape {T.shape}")
        r = T[:3, :3]
        if not np.allclose(r @ r.T, np.eye(3), atol=1e-3) or np.linalg.det(r) < 0:
            raise ValueError("its 3 x 3 part is not a rotation")
        # The quaternion is the eigenvector of the largest eigenvalue (Bar-Itzhack 2000): well conditioned everywhere.
        profile = np.array(
            [
                [r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
                [r[2, 1] - r[1, 2], r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
                [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], r[1, 2] + r[2, 1]],
                [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1]],
            ]
        )
        return cls(T[:3, 3], np.linalg.eigh(profile)[1][:, -1])

    @property
    def rotation(self) -> Array:
        """Rotation matrix, shape (3, 3)."""
        w, x, y, z = self.quaternion_wxyz
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )

    @property
    def yaw_rad(self) -> float:
        """Heading of the x axis about the vertical, counter-clockwise from above, in (-pi, pi]."""
        matrix = self.rotation
        return math.atan2(matrix[1, 0], matrix[0, 0])

    def apply(self, points_m: ArrayLike) -> Array:
        """Points given in this pose's frame, in its parent's frame, shape (N, 3)."""
        return np.asarray(as_points(points_m, 3, "points_m") @ self.rotation.T + self.position_m)

    def inverse(self) -> Pose:
        w, x, y, z = self.quaternion_wxyz
        return Pose(-self.rotation.T @ self.position_m, np.array([w, -x, -y, -z]))

    def __matmul__(self, other: Pose) -> Pose:
        w1, x1, y1, z1 = self.quaternion_wxyz
        w2, x2, y2, z2 = other.quaternion_wxyz
        product = np.array(
            [
                w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
                w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
                w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
                w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
            ]
        )
        return Pose(self.apply(other.position_m)[0], product)
