"""The cameras of an arm's table: pinholes, a depth sensor with its faults, a calibration with its error."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from wonderful_team.core.geometry import Camera, PinholeCamera, Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.appearance import aslant
from wonderful_team.sims.tabletop.cameras import Lens

SIZE_PX = (640, 400)
REACH_LOW_M, REACH_HIGH_M = (0.25, -0.37, 0.0), (0.71, 0.37, 0.4)
"""The workspace: what the arm reaches with its fingers pointing down [m]."""
TABLE_CENTRE_M = (0.48, 0.0, 0.0)
TOP_HEIGHT_M = 1.15
SEEN_WIDTH_M = 0.94
"""What the top camera sees of the table from left to right [m]."""
FRONT_FROM_M = (1.28, 0.0, 0.62)
FRONT_AT_M = (0.46, 0.0, 0.06)
FRONT_FOCAL_PX = 560.0


@dataclass(frozen=True, eq=False)
class PinholeLens(Lens):
    """Where a pinhole camera stands and how it looks.

    Attributes:
        focal_px: Focal length [px].
    """

    focal_px: float = 600.0

    @property
    def fovy_deg(self) -> float:
        """Vertical field of view [degrees]."""
        return math.degrees(2 * math.atan(self.size_px[1] / 2 / self.focal_px))

    @property
    def camera(self) -> Camera:
        """The same camera for planners, as far as its calibration goes: base frame to pixels and depth."""
        width, height = self.size_px
        right, down, position = self.told()
        K = np.array([[self.focal_px, 0.0, width / 2], [0.0, self.focal_px, height / 2], [0.0, 0.0, 1.0]])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = np.column_stack([right, down, self.forward]), position
        return PinholeCamera(K, Pose.from_matrix(T))

    def rays(self) -> tuple[Array, Array]:
        width, height = self.size_px
        u, v = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
        aim = (u[..., None] * self.right + v[..., None] * self.down) / self.focal_px + self.forward
        return self.position_m, aim / np.linalg.norm(aim, axis=-1, keepdims=True)


def lenses(size_px: tuple[int, int] = SIZE_PX) -> dict[str, Lens]:
    """The top camera, which looks straight down, and the front camera, which sees the arm from beyond the table."""
    scale = size_px[0] / SIZE_PX[0]
    right = np.array([0.0, 1.0, 0.0])
    above = np.array(TABLE_CENTRE_M) + np.array([0.0, 0.0, TOP_HEIGHT_M])
    focal = size_px[0] * TOP_HEIGHT_M / SEEN_WIDTH_M
    top = PinholeLens(
        "top", above, right, np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]), size_px, focal_px=focal
    )
    forward = np.array(FRONT_AT_M) - np.array(FRONT_FROM_M)
    forward = forward / np.linalg.norm(forward)
    front = PinholeLens(
        "front",
        np.array(FRONT_FROM_M),
        right,
        np.cross(forward, right),
        forward,
        size_px,
        focal_px=FRONT_FOCAL_PX * scale,
    )
    return {"top": top, "front": front}


CLEAR_M, MARGIN = 0.12, 1.02
"""A camera that was moved sees all that the arm reaches, and what stands there up to this high [m], with so much to spare."""


def moved(usual: PinholeLens, rng: np.random.Generator, tier: int) -> PinholeLens:
    """The top camera tilted, rolled and looking past where it looked, by as much as our tabletop's; planners are told where it stands.

    Args:
        usual: Where it stands else.
        rng: Draws how.
        tier: 1 to 3.
    """
    aside, (right, down, forward) = aslant(usual, rng, tier - 1)
    position = np.array(TABLE_CENTRE_M) + aside - TOP_HEIGHT_M * forward
    ends = zip(REACH_LOW_M[:2], REACH_HIGH_M[:2], strict=True)
    corners = np.array([(x, y, z) for x, y in itertools.product(*ends) for z in (0.0, CLEAR_M)]) - position
    half = np.array(usual.size_px) / 2
    across = np.abs(np.column_stack([corners @ right, corners @ down])) / (corners @ forward)[:, None]
    focal = min(usual.focal_px, float((half / across.max(axis=0)).min()) / MARGIN)
    return replace(usual, position_m=position, right=right, down=down, forward=forward, focal_px=focal)


NOISE_M = (0.001, 0.002, 0.003)
"""Standard deviation of one depth reading, by tier [m], at the table's distance; it grows with its square."""
QUANTUM_M = 0.001
"""Depth comes in steps of a millimetre."""
EDGE_M = 0.02
"""Neighbouring depths that differ by more are an edge: what is read there is lost, or lies anywhere between the two [m]."""
EDGE_LOST = (0.3, 0.5, 0.7)
"""Share of the readings at edges that are lost, by tier; half of the others are mixed."""
HOLES = (1, 3, 6)
"""Holes of a picture, by tier: patches that shine or swallow the light."""
HOLE_PX = (4, 12)
"""Their radius, least and most [px]."""


def sensed(depth_m: Array, tier: int, rng: np.random.Generator) -> Array:
    """What a depth sensor reads, shape (H, W) [m]: noise, steps, mixed and lost readings at edges, holes; NaN where lost.

    Args:
        depth_m: True distance along the optical axis.
        tier: 1 to 3.
        rng: Draws the faults.
    """
    step = tier - 1
    read = depth_m.astype(np.float64)
    read = read + rng.normal(0.0, NOISE_M[step], read.shape) * (read / TOP_HEIGHT_M) ** 2
    near = cv2.erode(depth_m.astype(np.float32), np.ones((3, 3), np.uint8))
    far = cv2.dilate(depth_m.astype(np.float32), np.ones((3, 3), np.uint8))
    edge, chance = far - near > EDGE_M, rng.random(read.shape)
    lost = edge & (chance < EDGE_LOST[step])
    mixed = edge & ~lost & (chance < (1 + EDGE_LOST[step]) / 2)
    read[mixed] = (near + rng.random(read.shape) * (far - near))[mixed]
    height, width = read.shape
    rows, columns = np.ogrid[:height, :width]
    for _ in range(HOLES[step]):
        x, y, radius = rng.uniform(0, width), rng.uniform(0, height), rng.uniform(*HOLE_PX)
        lost |= (columns - x) ** 2 + (rows - y) ** 2 < radius**2
    read = np.round(read / QUANTUM_M) * QUANTUM_M
    read[lost] = np.nan
    return read.astype(np.float32)
