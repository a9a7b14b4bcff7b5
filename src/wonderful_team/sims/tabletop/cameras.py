"""The two cameras over the table: orthographic, so that a metre is as many pixels everywhere in the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry import AffineCamera, Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import ConfigError

TABLE_LOW_M = (0.25, -0.5, 0.0)
TABLE_HIGH_M = (0.75, 0.5, 0.3)
SIZE_PX = (640, 320)
SEEN_WIDTH_M = 640 / 600
"""Width of what a camera sees [m]: the table and a margin of 33 mm on either side."""
CAMERA_NAMES = ("top", "front")
FAR_M = 1000.0
"""Rays start this far away: from there they are as good as parallel (0.03 px over the whole table) [m]."""


@dataclass(frozen=True, eq=False)
class Lens:
    """Where an orthographic camera stands and how it looks.

    Attributes:
        position_m: Centre of the picture at zero depth, shape (3,) [m].
        right, down, forward: Unit axes of the camera in the base frame, shape (3,) each.
        seen_width_m: How much of the scene is as wide as the picture [m].
        wrong_m, wrong_rad: How far off planners are told that it stands, along its own right and down, and how it is
            rolled: a calibration error.
    """

    name: str
    position_m: Array
    right: Array
    down: Array
    forward: Array
    size_px: tuple[int, int]
    seen_width_m: float = SEEN_WIDTH_M
    wrong_m: tuple[float, float] = (0.0, 0.0)
    wrong_rad: float = 0.0

    @property
    def scale_px_m(self) -> float:
        """Pixels per metre."""
        return self.size_px[0] / self.seen_width_m

    @property
    def seen_height_m(self) -> float:
        return self.size_px[1] / self.scale_px_m

    def told(self) -> tuple[Array, Array, Array]:
        """Right, down and position that planners are told, as far as the calibration goes, shape (3,) each."""
        right, down, position = self.right, self.down, self.position_m
        if self.wrong_rad or any(self.wrong_m):
            position = position + self.wrong_m[0] * right + self.wrong_m[1] * down
            turn, across = math.cos(self.wrong_rad), math.sin(self.wrong_rad)
            right, down = turn * right + across * down, turn * down - across * right
        return right, down, position

    @property
    def camera(self) -> Camera:
        """The same camera for planners, as far as its calibration goes: base frame to pixels and depth."""
        width, height = self.size_px
        right, down, position = self.told()
        rows = []
        for axis, offset, scale in (
            (right, width / 2, self.scale_px_m),
            (down, height / 2, self.scale_px_m),
            (self.forward, 0.0, 1.0),
        ):
            rows.append([*(axis * scale), offset - scale * float(axis @ position)])
        return AffineCamera(np.array(rows))

    def rays(self) -> tuple[Array, Array]:
        """Where the pixels' rays start, shape (3,) [m], and where they go, unit vectors of shape (H, W, 3)."""
        width, height = self.size_px
        u, v = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
        aim = (u[..., None] * self.right + v[..., None] * self.down) / self.scale_px_m + self.forward * (FAR_M + 1.0)
        return self.position_m - self.forward * FAR_M, aim / np.linalg.norm(aim, axis=-1, keepdims=True)


def lens(name: str, size_px: tuple[int, int] = SIZE_PX) -> Lens:
    """The camera of that name: top looks straight down, front looks down at 45 degrees from the +x side.

    Raises:
        ConfigError: The picture is not twice as wide as high, or too small or large to be of use.
    """
    width, height = size_px
    if width != 2 * height or not 128 <= width <= 2048:
        raise ConfigError(f"size_px: expected (2 n, n) with a width from 128 to 2048 px, got {size_px}")
    right = np.array([0.0, 1.0, 0.0])
    if name == "top":
        return Lens(name, np.array([0.5, 0.0, 1.0]), right, np.array([1.0, 0, 0]), np.array([0, 0, -1.0]), size_px)
    half = math.sqrt(0.5)
    forward = np.array([-half, 0.0, -half])
    middle = np.array([0.5, 0.0, 0.03])
    return Lens(name, middle - 1.2 * forward, right, np.array([half, 0.0, -half]), forward, size_px)
