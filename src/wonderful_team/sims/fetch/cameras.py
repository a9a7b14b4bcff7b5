"""The cameras of the Fetch world: one straight above the table, clear of the robot's head, and one that sees the robot."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.arms.cameras import PinholeLens

SIZE_PX = (640, 480)
CAMERA_NAMES = ("top", "front")
TOP_M = (0.25, 0.0, 1.15)
SEEN_WIDTH_M = 0.78
"""What the top camera sees of the table from left to right [m]."""
FRONT_FROM_M, FRONT_AT_M, FRONT_FOCAL_PX = (1.15, 0.0, 0.62), (0.2, 0.0, 0.12), 640.0


def lenses() -> dict[str, PinholeLens]:
    """Both cameras in the base frame; up in the top view is towards the robot."""
    right = np.array([0.0, 1.0, 0.0])
    focal = SIZE_PX[0] * TOP_M[2] / SEEN_WIDTH_M
    down, below = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])
    top = PinholeLens("top", np.array(TOP_M), right, down, below, SIZE_PX, focal_px=focal)
    forward = np.array(FRONT_AT_M) - np.array(FRONT_FROM_M)
    forward = forward / np.linalg.norm(forward)
    front = PinholeLens(
        "front", np.array(FRONT_FROM_M), right, np.cross(forward, right), forward, SIZE_PX, focal_px=FRONT_FOCAL_PX
    )
    return {"top": top, "front": front}
