"""The benchmark's two cameras: so far away that they are affine. Fitted once; pictures are 256 x 128 px."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.core.geometry import AffineCamera

CAMERA_NAMES = ("top", "front")
HALF_PX = 0.5
"""The fits count pixels by whole numbers; ours are continuous, with centres at one half."""
TOP_PX_M, FRONT_PX_M, FRONT_DOWN_PX_M = 250.98, 251.43, 177.80
COLUMN_0, TOP_ROW_0, FRONT_ROW_0 = 128.0, 63.0, 79.0
MIDDLE_X_M = 0.5
TOP_AT_M, FRONT_AT_M = 1.0, 1.2
"""How far from the table's middle depth is counted; the true cameras are 1000 m away, and no depth is given."""


def camera(name: str) -> AffineCamera:
    """The camera of that name, base frame to continuous pixels: top looks straight down, front at 45 degrees from +x."""
    if name == "top":
        return AffineCamera(
            np.array(
                [
                    (0.0, TOP_PX_M, 0.0, COLUMN_0 + HALF_PX),
                    (TOP_PX_M, 0.0, 0.0, TOP_ROW_0 + HALF_PX - TOP_PX_M * MIDDLE_X_M),
                    (0.0, 0.0, -1.0, TOP_AT_M),
                ]
            )
        )
    half = math.sqrt(0.5)
    return AffineCamera(
        np.array(
            [
                (0.0, FRONT_PX_M, 0.0, COLUMN_0 + HALF_PX),
                (FRONT_DOWN_PX_M, 0.0, -FRONT_DOWN_PX_M, FRONT_ROW_0 + HALF_PX - FRONT_DOWN_PX_M * MIDDLE_X_M),
                (-half, 0.0, -half, FRONT_AT_M + half * MIDDLE_X_M),
            ]
        )
    )
