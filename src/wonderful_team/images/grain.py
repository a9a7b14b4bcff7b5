"""Whether a picture has the grain of a photo."""

from __future__ import annotations

import numpy as np

from wonderful_team.core.geometry.arrays import Array

PHOTO_BELOW = 0.7
"""A picture is a photo when less than this share of its bytes equals the byte above: renderings and drawings have 0.9 and more,
photos 0.1, and 0.5 when they are enlarged."""
_SAMPLED_ROWS = 32


def is_photo(rgb: Array) -> bool:
    """Whether a picture, shape (H, W, 3), uint8, has the grain of a photo."""
    rows = np.arange(1, len(rgb), max(1, len(rgb) // _SAMPLED_ROWS))
    if not len(rows):
        return False
    equal = rgb[rows] == rgb[rows - 1]
    return bool(np.count_nonzero(equal) / equal.size < PHOTO_BELOW)
