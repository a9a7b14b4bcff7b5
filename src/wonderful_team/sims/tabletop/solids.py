"""Solids made of outlines: triangle meshes to look at and convex pieces to collide with.

Everything is in the body's frame: the outline's a axis (right in the top picture) is +y, its b axis (up) is -x, and
z = 0 is the bottom.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.geometry.arrays import Array

CHAMFER_M = 0.003
"""How far the top edge is cut back, so that edges catch light [m]."""
SMOOTH_COS = math.cos(math.radians(35))
"""Neighbouring side faces that meet at less than 35 degrees are shaded as one curved face."""

ANNULUS_PIECES = 16


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with their own corners: shape (T * 3, 3) for points and normals, (T * 3, 2) for texture, in metres."""

    points_m: Array
    normals: Array
    texture_m: Array


def polygons(shape: BaseGeometry) -> list[Polygon]:
    """The polygons of a shape, one by one."""
    if isinstance(shape, Polygon):
        return [shape]
    return [part for part in getattr(shape, "geoms", ()) if isinstance(part, Polygon)]


def to_body(points_ab: Array) -> Array:
    """Outline coordinates (a right, b up), shape (N, 2), as body x and y."""
    return np.column_stack([-points_ab[:, 1], points_ab[:, 0]])


def extruded(shape: BaseGeometry, low_m: float, high_m: float, chamfer_m: float = CHAMFER_M) -> Mesh:
    """The mesh of an outline standing from `low_m` to `high_m`, its top edge cut back by `chamfer_m`."""
    parts: list[tuple[Array, Array, Array]] = []
    for polygon in polygons(shape):
        rings = [_ring(polygon.exterior, True), *(_ring(hole, False) for hole in polygon.interiors)]
        inner = [_set_back(ring, chamfer_m) for ring in rings]
        top = Polygon(inner[0], inner[1:])
        cut = chamfer_m
        if chamfer_m <= 0 or not top.is_valid or top.area < 0.5 * polygon.area:
            inner, top, cut = rings, Polygon(rings[0], rings[1:]), 0.0
        parts.append(_cap(top, high_m, 1.0))
        parts.append(_cap(polygon, low_m, -1.0))
        for ring, back in zip(rings, inner, strict=True):
            parts.append(_wall(ring, ring, low_m, high_m - cut))
            if cut:
                parts.append(_wall(ring, back, high_m - cut, high_m))
    points, normals, texture = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Mesh(points, normals, texture)


def joined(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one."""
    return Mesh(
        np.concatenate([m.points_m for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.texture_m for m in meshes]),
    )


def convex_pieces(shape: BaseGeometry, tolerance_m: float = 0.0015) -> list[Polygon]:
    """Convex polygons that together fill an outline, simplified by at most `tolerance_m`."""
    pieces: list[Polygon] = []
    for polygon in polygons(shape):
        if _is_annulus(polygon):
            pieces.extend(_annulus(polygon))
            continue
        simple = polygon.simplify(tolerance_m)
        if abs(simple.convex_hull.area - simple.area) < 1e-3 * simple.area:
            pieces.append(simple.convex_hull)
            continue
        pieces.extend(_merged(polygons(shapely.constrained_delaunay_triangles(simple))))
    return pieces


def _is_annulus(polygon: Polygon) -> bool:
    """Whether a polygon is a disc with a round hole in its middle."""
    if len(polygon.interiors) != 1:
        return False
    rings = [np.asarray(ring.coords)[:-1] for ring in (polygon.exterior, polygon.interiors[0])]
    reaches = [np.linalg.norm(ring - rings[0].mean(axis=0), axis=1) for ring in rings]
    return all(len(reach) > 16 and np.ptp(reach) < 1e-3 * reach.mean() for reach in reaches)


def _annulus(polygon: Polygon) -> list[Polygon]:
    """Sixteen straight pieces round the hole."""
    middle = np.asarray(polygon.exterior.coords)[:-1].mean(axis=0)
    outer, inner = (
        float(np.linalg.norm(np.asarray(ring.coords)[0] - middle)) for ring in (polygon.exterior, polygon.interiors[0])
    )
    angles = [2 * math.pi * k / ANNULUS_PIECES for k in range(ANNULUS_PIECES + 1)]
    rays = [np.array([math.cos(a), math.sin(a)]) for a in angles]
    return [
        Polygon([middle + inner * a, middle + outer * a, middle + outer * b, middle + inner * b])
        for a, b in zip(rays, rays[1:], strict=False)
    ]


def prism(piece: Polygon, low_m: float, high_m: float) -> Array:
    """Corners of a convex piece standing from `low_m` to `high_m`, shape (2 N, 3) [m]."""
    corners = to_body(np.asarray(piece.exterior.coords)[:-1])
    return np.vstack([np.column_stack([corners, np.full(len(corners), z)]) for z in (low_m, high_m)])


def _merged(triangles: list[Polygon]) -> list[Polygon]:
    """Join neighbours while what they make stays convex."""
    pieces = list(triangles)
    joined_any = True
    while joined_any:
        joined_any = False
        for i in range(len(pieces)):
            for j in range(i + 1, len(pieces)):
                both = shapely.union(pieces[i], pieces[j])
                if isinstance(both, Polygon) and both.convex_hull.area - both.area < 1e-3 * both.area:
                    pieces[i] = both
                    del pieces[j]
                    joined_any = True
                    break
            if joined_any:
                break
    return pieces


def _ring(ring: BaseGeometry, counter_clockwise: bool) -> Array:
    points = np.asarray(ring.coords)[:-1]
    area = float(np.sum(points[:, 0] * np.roll(points[:, 1], -1) - np.roll(points[:, 0], -1) * points[:, 1]))
    return points if (area > 0) == counter_clockwise else points[::-1]


def _outward(ring: Array) -> Array:
    """Unit normals of a ring's edges, pointing out of the material; edge k runs from point k to k + 1."""
    along = np.roll(ring, -1, axis=0) - ring
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    return np.column_stack([along[:, 1], -along[:, 0]])


def _set_back(ring: Array, by_m: float) -> Array:
    """The ring moved into the material by `by_m`, corner by corner."""
    edge = _outward(ring)
    before = np.roll(edge, 1, axis=0)
    spread = np.maximum(1.0 + np.sum(edge * before, axis=1, keepdims=True), 0.3)
    return np.asarray(ring - by_m * (edge + before) / spread)


def _cap(polygon: Polygon, z_m: float, up: float) -> tuple[Array, Array, Array]:
    corners = [
        np.asarray(part.exterior.coords)[:3] for part in polygons(shapely.constrained_delaunay_triangles(polygon))
    ]
    oriented = []
    for triangle in corners:
        (ax, ay), (bx, by), (cx, cy) = triangle
        positive = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0
        oriented.append(triangle if positive == (up > 0) else triangle[::-1])
    flat = np.concatenate(oriented)
    points = np.column_stack([to_body(flat), np.full(len(flat), z_m)])
    return points, np.tile((0.0, 0.0, up), (len(flat), 1)), flat


def _wall(low: Array, high: Array, z_low_m: float, z_high_m: float) -> tuple[Array, Array, Array]:
    """The faces between two rings of equally many points."""
    flat = _outward(low)
    lean = 0.0 if np.array_equal(low, high) else 1.0
    starts, ends = _shared_normals(flat)
    points, normals, texture = [], [], []
    reach = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.roll(low, -1, axis=0) - low, axis=1))])
    for k in range(len(low)):
        n = (k + 1) % len(low)
        quad = (
            (low[k], z_low_m, starts[k], 0),
            (low[n], z_low_m, ends[k], 1),
            (high[n], z_high_m, ends[k], 1),
            (high[k], z_high_m, starts[k], 0),
        )
        for corner in (0, 1, 2, 0, 2, 3):
            at, z, normal, end = quad[corner]
            points.append((-at[1], at[0], z))
            normals.append((-normal[1], normal[0], lean))
            # A slanted face continues the top's texture; a wall unrolls it along its edge.
            texture.append(at if lean else (reach[k + end], z))
    directions = np.asarray(normals)
    return np.asarray(points), directions / np.linalg.norm(directions, axis=1, keepdims=True), np.asarray(texture)


def _shared_normals(flat: Array) -> tuple[Array, Array]:
    """Normals at the start and the end of each edge, shared between neighbours that make a curve."""
    before, after = np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0)
    curved_before = np.sum(flat * before, axis=1, keepdims=True) > SMOOTH_COS
    curved_after = np.sum(flat * after, axis=1, keepdims=True) > SMOOTH_COS
    starts = np.where(curved_before, flat + before, flat)
    ends = np.where(curved_after, flat + after, flat)
    return (
        starts / np.linalg.norm(starts, axis=1, keepdims=True),
        ends / np.linalg.norm(ends, axis=1, keepdims=True),
    )
