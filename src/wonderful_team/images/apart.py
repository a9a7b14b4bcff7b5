"""Where two pictures, or a picture and a colour, are apart; and the middle colour of pixels. In whole levels, so exact and quick."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array

_LEVELS = np.arange(256, dtype=np.float64)


def apart(rgb: Array, other: Array, most: float) -> Array:
    """Which pixels differ from a picture of the same size, or from a colour, by more than `most` levels in some channel.

    Args:
        rgb: Shape (H, W, 3), uint8.
        other: A picture, the same; or a colour, shape (3,).
        most: Levels (0 to 255).

    Returns:
        Shape (H, W), bool.
    """
    if other.ndim == 1:
        far = (np.abs(_LEVELS[:, None] - other) > most).astype(np.uint8)
        channels = cv2.split(cv2.LUT(np.ascontiguousarray(rgb), far[None]))
        return np.asarray(cv2.max(cv2.max(*channels[:2]), channels[2]) > 0)
    channels = cv2.split(cv2.absdiff(np.ascontiguousarray(rgb), np.ascontiguousarray(other)))
    return np.asarray(cv2.max(cv2.max(*channels[:2]), channels[2]) > most)


def middle_colour(pixels: Array) -> Array:
    """The median of each channel, as numpy's `median` has it, of pixels of shape (N, 3), uint8; shape (3,)."""
    count = len(pixels)
    below = [np.cumsum(np.bincount(pixels[:, channel], minlength=256)) for channel in range(pixels.shape[1])]
    middle = [np.searchsorted(sums, ((count - 1) // 2, count // 2), side="right") for sums in below]
    return np.asarray(np.mean(middle, axis=1))
