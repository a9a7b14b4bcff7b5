"""Whether a picture really shows what it claims to show: pixels against pixels, tolerant of noise but not of a shift.

Compared at the view's own resolution, tile by tile, so that a small thing that was painted over counts as much as a
picture that was moved.
"""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.images import resampled

NOISE = 4.0
"""Mean difference over all pixels and channels (0 to 255) that still counts as noise of storing or scaling a picture."""
FINE_NOISE = 8.0
"""The same for the pixels as they are shown: enlarging must not let noise average out."""
TILE_PX = 16
"""Side of a tile [view px]."""
TILE_NOISE = 12.0
"""The same for one tile: stored pictures err most where there is most to see."""
SHIFT_PX = 2.0
"""A picture moved by this much is another picture [view px]."""
SHIFT_SHARE = 0.5
"""A tile may differ by this share of what moving it would change."""
ODD_TILES = 0.004
"""Share of tiles that may differ by more."""
MOST = 1.5
"""No tile at all may differ by more than this many times its limit: nothing was painted over or put in."""


def expected(rgb: Array, frame: Frame) -> Array | None:
    """What a frame of a view must look like, shape (height, width, 3); None for a frame that is turned."""
    matrix = frame.T_view_picture
    if matrix[0, 1] or matrix[1, 0]:
        return None
    mirrored_x, mirrored_y = matrix[0, 0] < 0, matrix[1, 1] < 0
    if not (mirrored_x or mirrored_y):
        return _resampled(rgb, frame)
    width, height = frame.size_px
    upright = matrix @ np.array(
        [
            [-1.0 if mirrored_x else 1.0, 0.0, width if mirrored_x else 0.0],
            [0.0, -1.0 if mirrored_y else 1.0, height if mirrored_y else 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
    valid = frame.valid
    x0, x1 = (width - valid.x1, width - valid.x0) if mirrored_x else (valid.x0, valid.x1)
    y0, y1 = (height - valid.y1, height - valid.y0) if mirrored_y else (valid.y0, valid.y1)
    image = _resampled(rgb, Frame(frame.view_id, upright, frame.size_px, Box(x0, y0, x1, y1)))
    return None if image is None else image[:: -1 if mirrored_y else 1, :: -1 if mirrored_x else 1]


def _resampled(rgb: Array, frame: Frame) -> Array | None:
    try:
        return resampled(rgb, frame)
    except ValueError:
        return None


def difference(shown: Array, right: Array, scale: float) -> float | None:
    """How far two pictures of the same size differ; None when they do not show the same.

    Args:
        shown: Shape (height, width, 3), uint8.
        right: The same.
        scale: Picture pixels per view pixel.
    """
    if shown.shape != right.shape:
        return None
    if np.array_equal(shown, right):
        return 0.0
    shown, right = np.ascontiguousarray(shown), np.ascontiguousarray(right)
    if float(cv2.absdiff(shown, right).mean()) > FINE_NOISE:
        return None
    a, b = _at_view_scale(shown, scale), _at_view_scale(right, scale)
    apart = np.abs(a - b).mean(axis=2)
    overall = float(apart.mean())
    if overall > NOISE:
        return None
    limit = np.maximum(TILE_NOISE, SHIFT_SHARE * _tiles(_if_moved(b)))
    tiles = _tiles(apart)
    odd = int((tiles > limit).sum())
    return overall if odd <= ODD_TILES * limit.size and not (tiles > MOST * limit).any() else None


def _at_view_scale(image: Array, scale: float) -> Array:
    height, width = image.shape[:2]
    if scale > 1.0:
        size = (max(1, round(width / scale)), max(1, round(height / scale)))
        image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA))
    return image.astype(np.float32)


def _if_moved(image: Array) -> Array:
    """What a small shift would change at each pixel, averaged over the four directions, shape (height, width)."""
    step = max(1, round(SHIFT_PX))
    total = np.zeros(image.shape[:2], np.float32)
    padded = np.pad(image, ((step, step), (step, step), (0, 0)), mode="edge")
    height, width = image.shape[:2]
    for dy, dx in ((0, -step), (0, step), (-step, 0), (step, 0)):
        moved = padded[step + dy : step + dy + height, step + dx : step + dx + width]
        total += np.abs(moved - image).mean(axis=2)
    return total / 4


def _tiles(values: Array) -> Array:
    """Means over tiles, shape (rows, columns)."""
    height, width = values.shape
    size = (max(1, -(-width // TILE_PX)), max(1, -(-height // TILE_PX)))
    return np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_AREA))
