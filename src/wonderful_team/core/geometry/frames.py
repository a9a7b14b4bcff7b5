"""Frame: how the pixels of a picture that was sent map to the pixels of the view it was cut from, and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from wonderful_team.core.geometry.arrays import Array, as_points, frozen_array
from wonderful_team.core.geometry.boxes import Box


@dataclass(frozen=True, eq=False)
class Frame:
    """One class for whole views, enlargements, crops, zooms and strips.

    Attributes:
        view_id: Which view the picture was cut from.
        T_view_picture: Homogeneous map from picture pixels to view pixels, shape (3, 3); last row (0, 0, 1).
        size_px: Width and height of the picture.
        valid: The part of the picture [picture px] that shows the view; the rest is padding.

    Raises:
        ValueError: The map is not affine or cannot be inverted.
    """

    view_id: str
    T_view_picture: Array
    size_px: tuple[int, int]
    valid: Box

    def __post_init__(self) -> None:
        matrix = frozen_array(self.T_view_picture, (3, 3), "T_view_picture")
        if not np.array_equal(matrix[2], (0.0, 0.0, 1.0)):
            raise ValueError(f"T_view_picture: last row must be (0, 0, 1), got {matrix[2].tolist()}")
        if abs(np.linalg.det(matrix[:2, :2])) < 1e-12:
            raise ValueError("T_view_picture: the map cannot be inverted")
        width, height = (int(v) for v in self.size_px)
        if width < 1 or height < 1:
            raise ValueError(f"size_px: width and height must be at least 1, got {self.size_px}")
        object.__setattr__(self, "T_view_picture", matrix)
        object.__setattr__(self, "size_px", (width, height))

    @classmethod
    def whole(cls, view_id: str, size_px: tuple[int, int], zoom: float = 1.0) -> Frame:
        """The frame of a whole view of `size_px`, enlarged `zoom` times; at least one pixel each way."""
        width, height = (max(1, round(side * zoom)) for side in size_px)
        matrix = np.diag([size_px[0] / width, size_px[1] / height, 1.0])
        return cls(view_id, matrix, (width, height), Box(0, 0, width, height))

    @classmethod
    def window(cls, view_id: str, view_size_px: tuple[int, int], window: Box, size_px: tuple[int, int]) -> Frame:
        """The frame of a picture of `size_px` that shows the box `window` [view px], which may leave the view.

        Raises:
            ValueError: The window shares nothing with the view.
        """
        sx, sy = window.width / size_px[0], window.height / size_px[1]
        matrix = np.array([[sx, 0, window.x0], [0, sy, window.y0], [0, 0, 1.0]])
        seen = window.intersection(Box(0, 0, *view_size_px))
        if seen is None:
            raise ValueError(f"window {window.as_tuple} lies outside the view of {view_size_px} px")
        valid = Box(
            (seen.x0 - window.x0) / sx,
            (seen.y0 - window.y0) / sy,
            (seen.x1 - window.x0) / sx,
            (seen.y1 - window.y0) / sy,
        )
        return cls(view_id, matrix, size_px, valid)

    @property
    def scale(self) -> float:
        """Picture pixels per view pixel (geometric mean over both axes)."""
        return float(1.0 / np.sqrt(abs(np.linalg.det(self.T_view_picture[:2, :2]))))

    def to_view(self, points_px: ArrayLike) -> Array:
        """Picture pixels to view pixels, shape (N, 2)."""
        points = as_points(points_px, 2, "points_px")
        return np.asarray(points @ self.T_view_picture[:2, :2].T + self.T_view_picture[:2, 2])

    def to_picture(self, points_px: ArrayLike) -> Array:
        """View pixels to picture pixels, shape (N, 2)."""
        points = as_points(points_px, 2, "points_px")
        return np.asarray(np.linalg.solve(self.T_view_picture[:2, :2], (points - self.T_view_picture[:2, 2]).T).T)

    def point_to_view(self, point: tuple[float, float]) -> tuple[float, float]:
        x, y = self.to_view(point)[0]
        return float(x), float(y)

    def point_to_picture(self, point: tuple[float, float]) -> tuple[float, float]:
        x, y = self.to_picture(point)[0]
        return float(x), float(y)

    def box_to_view(self, box: Box) -> Box:
        return Box.bounding([(float(x), float(y)) for x, y in self.to_view(box.corners)])

    def box_to_picture(self, box: Box) -> Box:
        return Box.bounding([(float(x), float(y)) for x, y in self.to_picture(box.corners)])

    @property
    def whole_box(self) -> Box:
        """The whole picture [picture px]."""
        return Box(0, 0, *self.size_px)
