"""Synthetic views of blocks on a table with exact depth, for cameras of several kinds."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from wonderful_team.core.geometry import AffineCamera, Box, Camera, PinholeCamera, PlanarCamera, Pose
from wonderful_team.core.values import GroundedTarget, Limits, Target, View

LIMITS = Limits((0.25, -0.5, 0.0), (0.75, 0.5, 0.3), clearance_m=0.2)
SIZE = (256, 128)


def affine_top() -> AffineCamera:
    """Right is +y, down is +x, one metre above the table."""
    return AffineCamera(np.array([[0, 240.0, 0, 128], [240.0, 0, 0, -56], [0, 0, -1.0, 1.0]]))


def looking_down(height_m: float = 0.9, tilt_deg: float = 0.0, pan_deg: float = 0.0) -> PinholeCamera:
    """A pinhole over the middle of the table, tilted towards the viewer's side and panned about the vertical."""
    flat = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).T
    t, p = math.radians(tilt_deg), math.radians(pan_deg)
    tilt = np.array([[1, 0, 0], [0, math.cos(t), -math.sin(t)], [0, math.sin(t), math.cos(t)]])
    pan = np.array([[math.cos(p), -math.sin(p), 0], [math.sin(p), math.cos(p), 0], [0, 0, 1]])
    rotation = pan @ flat @ tilt
    middle = np.array([0.5, 0.0, 0.0])
    position = middle - height_m * rotation[:, 2]
    K = np.array([[220.0, 0, 128], [0, 220.0, 64], [0, 0, 1]])
    return PinholeCamera(K, Pose(position, _quaternion(rotation)))


def planar() -> PlanarCamera:
    """The table's four corners, marked in the picture of `affine_top`."""
    return PlanarCamera.from_corners(
        [(8, 4), (248, 4), (248, 124), (8, 124)], [(0.25, -0.5), (0.25, 0.5), (0.75, 0.5), (0.75, -0.5)]
    )


def cameras() -> dict[str, Any]:
    return {
        "affine": affine_top(),
        "pinhole": looking_down(),
        "tilted": looking_down(tilt_deg=25),
        "panned": looking_down(tilt_deg=10, pan_deg=70),
    }


@dataclass(frozen=True)
class Block:
    """A block on the table: footprint (x0, y0, x1, y1) [m] and height [m]."""

    x0: float
    y0: float
    x1: float
    y1: float
    height: float = 0.05

    @property
    def centre(self) -> tuple[float, float]:
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    def top(self, across: float = 0.5, along: float = 0.5) -> tuple[float, float, float]:
        """A point of its top face, by shares of its sides."""
        return self.x0 + (self.x1 - self.x0) * across, self.y0 + (self.y1 - self.y0) * along, self.height


def scene(camera: Camera | None, *blocks: Block, depth: bool = True, size: tuple[int, int] = SIZE) -> View:
    """A view with exact depth of the blocks' top faces and the table."""
    rgb = np.zeros((size[1], size[0], 3), np.uint8)
    if camera is None or not depth or isinstance(camera, PlanarCamera):
        return View("top", "top", 0.0, rgb, camera=camera)
    columns, rows = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    px = np.column_stack([columns.ravel(), rows.ravel()])
    points = camera.on_plane(px, 0.0)
    for block in sorted(blocks, key=lambda block: block.height):
        on_top = camera.on_plane(px, block.height)
        hit = (
            (on_top[:, 0] >= block.x0)
            & (on_top[:, 0] <= block.x1)
            & (on_top[:, 1] >= block.y0)
            & (on_top[:, 1] <= block.y1)
        )
        points[hit] = on_top[hit]
    return View("top", "top", 0.0, rgb, distances(camera, points).reshape(rows.shape), camera)


def distances(camera: Camera, points: Any) -> Any:
    """Distance along the optical axis [m]."""
    if isinstance(camera, AffineCamera):
        return points @ camera.matrix[2, :3] + camera.matrix[2, 3]
    assert isinstance(camera, PinholeCamera)
    return camera.T_base_cam.inverse().apply(points)[:, 2]


def found(
    camera: Camera, name: str, block: Block, points: dict[str, tuple[float, float]] | None = None
) -> GroundedTarget:
    """A block as a grounded target: its top face's box; points by shares of the top face's sides."""
    corners = [block.top(a, b) for a in (0, 1) for b in (0, 1)]
    pixels = [(float(x), float(y)) for x, y in camera.project(corners)]
    shares = {"pick": (0.5, 0.5)} if points is None else points
    placed = {}
    for role, (across, along) in shares.items():
        x, y = camera.project([block.top(across, along)])[0]
        placed[role] = (float(x), float(y))
    return GroundedTarget(Target(name, "object", f"block {name}"), "found", "top", Box.bounding(pixels), placed)


def area(name: str, px: tuple[float, float], role: str = "place") -> GroundedTarget:
    return GroundedTarget(Target(name, "area", "free space"), "found", "top", Box.around(px, 20, 20), {role: px})


def aslant_in_a_bowl(camera: Camera) -> tuple[View, dict[str, GroundedTarget]]:
    """A thing T1 that lies aslant in a bowl T2, held where it is low; where the bowl is pointed at, it shows higher. A1 is free."""
    floor, wall, low, high, count = 0.002, 0.045, 0.038, 0.060, 12
    x0, x1, y0, y1 = 0.45, 0.55, 0.09, 0.16
    wide, rise = (x1 - x0) / count, (high - low) / (count - 1)
    strips = [Block(x0 + k * wide, y0, x0 + (k + 1) * wide, y1, low + k * rise) for k in range(count)]
    bowl = Block(0.38, 0.05, 0.62, 0.20, wall)
    walls = [replace(bowl, x1=0.40), replace(bowl, x0=0.60), replace(bowl, y1=0.06), replace(bowl, y0=0.19)]
    view = scene(camera, replace(bowl, height=floor), *walls, *strips)
    held, shown, free = camera.project([strips[3].top(), strips[8].top(), (0.5, -0.3, 0.0)])
    thing = found(camera, "T1", Block(x0, y0, x1, y1, (low + high) / 2))
    return view, {
        "T1": replace(thing, points={"pick": (float(held[0]), float(held[1]))}),
        "T2": replace(found(camera, "T2", bowl), points={"place": (float(shown[0]), float(shown[1]))}),
        "A1": area("A1", (float(free[0]), float(free[1]))),
    }


def _quaternion(rotation: Any) -> Any:
    """Wxyz of a rotation matrix, by its eigenvector."""
    r = rotation
    K = np.array(
        [
            [r[0, 0] - r[1, 1] - r[2, 2], 0, 0, 0],
            [r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], 0, 0],
            [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1], 0],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], r[0, 0] + r[1, 1] + r[2, 2]],
        ]
    )
    values, vectors = np.linalg.eigh(K / 3)
    x, y, z, w = vectors[:, np.argmax(values)]
    return np.array([w, x, y, z])
