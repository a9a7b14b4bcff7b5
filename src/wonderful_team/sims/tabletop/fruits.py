"""Fruits as simple curved solids: bodies of revolution with a flat foot so that they stay put, and a bent banana."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from shapely import LineString, Point
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.solids import Mesh

NAMES = ("apple", "lime", "orange", "banana", "plum", "blueberry")
RADIUS_M = {"apple": 0.037, "lime": 0.03, "orange": 0.036, "plum": 0.03, "blueberry": 0.026}
STRETCH = {"lime": 1.35, "plum": 1.2}
"""How much longer than wide a fruit is."""
FOOT = 0.12
"""Share of the height that is cut off flat at the bottom."""
BANANA_ARC_M = 0.085
BANANA_THICK_M = 0.019
BANANA_HALF_ANGLE = math.radians(52)


@dataclass(frozen=True, eq=False)
class FruitBody:
    """Geometry of one fruit; fields as in `shapes.Shape`."""

    footprint: BaseGeometry
    height_m: float
    mesh: Mesh
    pieces: tuple[Array, ...]
    grasp_ab: tuple[float, float]


def fruit(name: str) -> FruitBody:
    """The body of a fruit."""
    return _banana() if name == "banana" else _round(name)


def _round(name: str) -> FruitBody:
    radius, stretch = RADIUS_M[name], STRETCH.get(name, 1.0)
    heights, around = np.linspace(-1, 1, 17), np.linspace(0, 2 * math.pi, 33)
    rings = []
    for angle in heights * math.pi / 2:
        reach, z = math.cos(angle), math.sin(angle)
        if name == "apple":
            # A dimple at the top and narrower towards the foot.
            reach, z = reach * (1 + 0.08 * z), z - 0.28 * math.exp(-((reach / 0.28) ** 2)) * (z > 0)
        if name == "lime":
            stretch_here = stretch + 0.12 * max(0.0, 1 - reach)
        else:
            stretch_here = stretch
        ring = np.column_stack([reach * np.cos(around), stretch_here * reach * np.sin(around), np.full(33, z)])
        rings.append(ring * radius)
    grid = np.stack(rings)
    foot = -radius * (1 - 2 * FOOT)
    grid[:, :, 2] = np.maximum(grid[:, :, 2], foot) - foot
    points = grid.reshape(-1, 3)
    circle = Point(0, 0).buffer(radius)
    footprint = circle if stretch == 1.0 else _stretched(radius, stretch)
    return FruitBody(footprint, float(points[:, 2].max()), _grid_mesh(grid), (_thinned(points),), (0.0, 0.0))


def _stretched(radius_m: float, stretch: float) -> BaseGeometry:
    angles = np.linspace(0, 2 * math.pi, 49)[:-1]
    return LineString(np.column_stack([stretch * radius_m * np.sin(angles), radius_m * np.cos(angles)])).convex_hull


def _banana() -> FruitBody:
    spread = np.linspace(-1, 1, 15)
    around = np.linspace(0, 2 * math.pi, 17)
    shift = BANANA_ARC_M * math.sin(BANANA_HALF_ANGLE) / BANANA_HALF_ANGLE
    rings, middle = [], []
    for k, s in enumerate((-1.0, *spread, 1.0)):
        angle = s * BANANA_HALF_ANGLE
        # The first and the last ring are points, so that the ends are closed.
        taper = 0.0 if k in (0, len(spread) + 1) else BANANA_THICK_M * math.sqrt(max(1.0 - 0.94 * abs(s) ** 3.0, 0.03))
        radial = BANANA_ARC_M + taper * np.cos(around)
        ring = np.column_stack([radial * math.cos(angle) - shift, radial * math.sin(angle), taper * np.sin(around)])
        rings.append(ring)
        middle.append((BANANA_ARC_M * math.sin(angle), -(BANANA_ARC_M * math.cos(angle) - shift), taper))
    grid = np.stack(rings)
    foot = -BANANA_THICK_M * 0.8
    grid[:, :, 2] = np.maximum(grid[:, :, 2], foot) - foot
    pieces = tuple(_thinned(grid[k : k + 4].reshape(-1, 3)) for k in range(1, 13, 3))
    parts = [Point(a, b).buffer(width) for a, b, width in middle[1:-1]]
    footprint = parts[0]
    for before, after in zip(parts, parts[1:], strict=False):
        footprint = footprint.union(before.union(after).convex_hull)
    body = FruitBody(
        footprint, float(grid[:, :, 2].max()), _grid_mesh(grid, closed_ends=True), pieces, (middle[8][0], middle[8][1])
    )
    return body


def _thinned(points: Array) -> Array:
    return np.unique(np.round(points, 6), axis=0)


def _grid_mesh(grid: Array, *, closed_ends: bool = False) -> Mesh:
    """Triangles over a grid of rings, shape (R, C, 3), whose first and last column coincide; smooth normals."""
    rows, columns = grid.shape[:2]
    r, c = (index.ravel() for index in np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij"))
    first = np.stack([r, c, r, c + 1, r + 1, c + 1], axis=1).reshape(-1, 3, 2)
    second = np.stack([r, c, r + 1, c + 1, r + 1, c], axis=1).reshape(-1, 3, 2)
    corners = np.concatenate([first, second])
    at = grid[corners[..., 0], corners[..., 1]]
    faces = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    # The ends of a long body close against a ring further in, so that they face outward too.
    rings = grid.mean(axis=1)[np.clip(corners[:, 0, 0], 2, rows - 3)]
    outward = at.mean(axis=1) - (rings if closed_ends else grid.reshape(-1, 3).mean(axis=0))
    inverted = np.sum(faces * outward, axis=1) < 0
    corners[inverted], faces[inverted] = corners[inverted][:, ::-1], -faces[inverted]
    normals = np.zeros_like(grid)
    np.add.at(normals, (corners[..., 0], corners[..., 1]), faces[:, None, :])
    normals[:, 0] = normals[:, -1] = normals[:, 0] + normals[:, -1]
    flat_foot = grid[:, :, 2] < 1e-9
    normals[flat_foot] = (0, 0, -1)
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    normals = np.where(lengths > 1e-12, normals / np.maximum(lengths, 1e-12), np.array([0.0, 0.0, 1.0]))
    index = corners.reshape(-1, 2)
    points = grid[index[:, 0], index[:, 1]]
    return Mesh(points, normals[index[:, 0], index[:, 1]], np.column_stack([points[:, 1], -points[:, 0]]))
