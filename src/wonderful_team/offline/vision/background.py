"""The room round a table: a band of one colour along the picture's edges, which is no thing.

A camera that sees a little more than the table shows the floor or a wall beside it. Things may reach into that band.
"""

from __future__ import annotations

import numpy as np

from wonderful_team.core.geometry.arrays import Array

_NEAR = 6.0
"""CIELAB distance up to which a pixel has the room's colour."""

_APART = 12.0
"""CIELAB distance that a room must have from the table at least; nearer ones are shading."""

_ALONG = 0.6
"""Share of a side along which the room must show."""

_DEEPEST = 0.45
"""Share of the picture's height or width that a band may cover."""

_SEAM = 3
"""Working pixels on each side of the table's edge in which the two colours may mix."""


def room_distance(lab: Array, valid: Array, surface: Array, spread: Array) -> Array | None:
    """Distance of each pixel from the room's colour within the bands that the room covers; infinite elsewhere.

    On the seam between table and room every mixture of the two colours counts as background.

    Args:
        lab: CIELAB, shape (H, W, 3).
        valid: Pixels that show the view, shape (H, W), bool.
        surface: The table's colour at each pixel, shape (H, W, 3).
        spread: Standard deviation of the table's L, a, b, shape (3,).

    Returns:
        Shape (H, W), in standard deviations; None when the table reaches every edge.
    """
    rows, columns = np.flatnonzero(valid.any(axis=1)), np.flatnonzero(valid.any(axis=0))
    inner = np.s_[int(rows[0]) : int(rows[-1]) + 1, int(columns[0]) : int(columns[-1]) + 1]
    image, table = lab[inner], surface[inner]
    distance = np.full(valid.shape, np.inf, np.float32)
    inside = distance[inner]
    found = False
    for side in range(4):
        turned, below, out = (np.rot90(item, side) for item in (image, table, inside))
        depth, colour = _band(turned, below)
        if not depth:
            continue
        found = True
        end = min(depth + _SEAM, len(out))
        start = max(depth - _SEAM, 0)
        far = np.sqrt(((((turned[:end] - colour) / spread) ** 2).sum(axis=-1)) / 1.5)
        far[start:] = np.minimum(far[start:], _from_mixture(turned[start:end], below[start:end], colour, spread))
        out[:end] = np.minimum(out[:end], far)
    return distance if found else None


def _band(image: Array, table: Array) -> tuple[int, Array]:
    """Depth of the band along the top of an image [rows] and its colour; 0 without one."""
    edge = image[0]
    colour = np.median(edge, axis=0)
    off_table = np.sqrt(((edge - table[0]) ** 2).sum(axis=-1)) > _APART
    near = np.sqrt(((edge - colour) ** 2).sum(axis=-1)) < _NEAR
    if (off_table & near).mean() < _ALONG:
        return 0, colour
    colour = np.median(edge[off_table & near], axis=0)
    deepest = int(_DEEPEST * len(image))
    alike = np.sqrt(((image[: deepest + 1] - colour) ** 2).sum(axis=-1)) < _NEAR
    depths = np.argmin(np.vstack([alike, np.zeros((1, alike.shape[1]), dtype=bool)]), axis=0)
    depth = int(np.median(depths[depths > 0]))
    return (depth, colour) if depth <= deepest else (0, colour)


def _from_mixture(image: Array, table: Array, colour: Array, spread: Array) -> Array:
    """Distance from the nearest mixture of table and room, in standard deviations."""
    way = (colour - table) / spread
    gap = (image - table) / spread
    share = np.clip((gap * way).sum(axis=-1) / np.maximum((way**2).sum(axis=-1), 1e-9), 0, 1)
    return np.asarray(np.sqrt(((gap - share[..., None] * way) ** 2).sum(axis=-1) / 1.5))
