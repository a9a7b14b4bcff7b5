"""Small geometry on numpy alone: corners of a body, their hull, and the pixel deepest inside a mask."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

BOX, MESH = 3, 5
"""Numbers of the physics engine for kinds of shapes."""
DEEPEST_PX = 40


def corners_of(physics: Any, body: int, client: int) -> Any:
    """Points that span a body in its own frame, shape (N, 3) [m]: corners of its boxes, points of its mesh."""
    found: list[Any] = []
    for shape in physics.getVisualShapeData(body, physicsClientId=client):
        link, kind, size, position, turned = shape[1], shape[2], shape[3], shape[5], shape[6]
        if link != -1:
            continue
        if kind == BOX:
            local = 0.5 * np.array(size) * np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
            matrix = np.array(physics.getMatrixFromQuaternion(turned), dtype=float).reshape(3, 3)
            found.append(local @ matrix.T + np.array(position))
        elif kind == MESH:
            points = np.array(physics.getMeshData(body, -1, physicsClientId=client)[1], dtype=float)
            if points.size:
                found.append(points.reshape(-1, 3))
    return np.concatenate(found) if found else _bounding_corners(physics, body, client)


def _bounding_corners(physics: Any, body: int, client: int) -> Any:
    """Corners of the box round a body of another kind, in its own frame."""
    low, high = (np.array(corner, dtype=float) for corner in physics.getAABB(body, physicsClientId=client))
    position, turned = physics.getBasePositionAndOrientation(body, physicsClientId=client)
    matrix = np.array(physics.getMatrixFromQuaternion(turned), dtype=float).reshape(3, 3)
    unit = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, 8).T
    return (low + unit * (high - low) - np.array(position)) @ matrix


def hull(points: Any) -> list[list[float]]:
    """Corners of the convex hull, counter-clockwise. Source: Andrew 1979, monotone chain."""
    ordered = sorted({(round(float(x), 6), round(float(y), 6)) for x, y in points})
    if len(ordered) < 3:
        return [list(point) for point in ordered]
    return [list(point) for point in (*_chain(ordered), *_chain(ordered[::-1]))]


def _chain(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    kept: list[tuple[float, float]] = []
    for x, y in points:
        while len(kept) > 1:
            (ax, ay), (bx, by) = kept[-2], kept[-1]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            kept.pop()
        kept.append((x, y))
    return kept[:-1]


def middle_of(mask: Any, near: tuple[float, float]) -> tuple[float, float] | None:
    """Row and column of the pixel deepest inside a mask, the one nearest to `near` among equals; None when empty."""
    left = np.asarray(mask, dtype=bool)
    if not left.any():
        return None
    for _ in range(DEEPEST_PX):
        smaller = _eroded(left)
        if not smaller.any():
            break
        left = smaller
    rows, columns = np.nonzero(left)
    best = int(np.argmin((rows - near[0]) ** 2 + (columns - near[1]) ** 2))
    return float(rows[best]), float(columns[best])


def _eroded(mask: Any) -> Any:
    padded = np.pad(mask, 1)
    shifted = (padded[1:-1, 1:-1], padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:])
    return np.logical_and.reduce(shifted)
