"""How much a region of a view has changed: for the staleness check before something moves."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import checked_rgb

CHANGED = 0.25
"""From this value on something has moved; noise, JPEG and a slow drift of the light stay well below."""
_SHORT_SIDE_PER_SIGMA_PX = 320.0  # the smoothing grows with the picture
_FLOOR_LEVELS, _SPAN_LEVELS = 8.0, 32.0  # grey levels after smoothing: below is noise; floor + span counts as 1
_MOST_CHANGED_SHARE = 0.04  # a thin crescent where an object left or came is enough
_MAX_DRIFT_LEVELS = 25.0  # brightness of the whole picture may drift by so many levels


def region_change(before_rgb: Array, after_rgb: Array, box: Box) -> float:
    """How much a region differs between two images of the same camera: 0 the same, 1 plainly changed.

    Both are smoothed, a common drift of brightness is taken off, and the most changed 4 % of the region decide; so
    an object that was nudged stands out and single noisy pixels do not.

    Args:
        before_rgb: Shape (H, W, 3), uint8.
        after_rgb: The same size, later.
        box: The region [view px]; the part inside the view counts.

    Raises:
        ValueError: The sizes differ, or the box lies outside the view.
    """
    before, after = checked_rgb(before_rgb, "before_rgb"), checked_rgb(after_rgb, "after_rgb")
    if before.shape != after.shape:
        raise ValueError(f"images to compare must have one size, got {before.shape} and {after.shape}")
    height, width = before.shape[:2]
    seen = box.intersection(Box(0, 0, width, height))
    if seen is None:
        raise ValueError(f"box {box.as_tuple} lies outside the view of ({width}, {height}) px")
    x0, y0 = int(np.floor(seen.x0)), int(np.floor(seen.y0))
    x1, y1 = int(np.ceil(seen.x1)), int(np.ceil(seen.y1))
    drift = _drift(before, after)
    sigma = 1.3 * min(max(min(width, height) / _SHORT_SIDE_PER_SIGMA_PX, 0.7), 2.5)
    reach = int(np.ceil(6 * sigma))
    rows, columns = slice(max(0, y0 - reach), y1 + reach), slice(max(0, x0 - reach), x1 + reach)
    first, second = (_smooth(image[rows, columns], sigma) for image in (before, after))
    levels = np.abs(second - first - drift).max(axis=2)
    top, left = y0 - rows.start, x0 - columns.start
    region = np.sort(levels[top : top + y1 - y0, left : left + x1 - x0], axis=None)
    most = region[-max(1, round(region.size * _MOST_CHANGED_SHARE)) :]
    return float(np.clip((most.mean() - _FLOOR_LEVELS) / _SPAN_LEVELS, 0.0, 1.0))


def _smooth(rgb: Array, sigma: float) -> Array:
    """Brightness and, twice as smooth, the two colour channels: JPEG keeps colour at half the resolution."""
    parts = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2YCrCb).astype(np.float32)
    light = cv2.GaussianBlur(parts[..., 0], (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
    colour = cv2.GaussianBlur(parts[..., 1:], (0, 0), 2 * sigma, borderType=cv2.BORDER_REPLICATE)
    return np.dstack([light, colour])


def _drift(before: Array, after: Array) -> Array:
    """Median change of brightness over the whole image (automatic exposure, daylight), shape (3,) float32."""
    step = max(1, min(before.shape[:2]) // 120)
    pair = [np.ascontiguousarray(image[::step, ::step]) for image in (before, after)]
    first, second = (cv2.cvtColor(image, cv2.COLOR_RGB2YCrCb).astype(np.int16) for image in pair)
    middle = np.median((second - first).reshape(-1, 3), axis=0)
    return np.asarray(np.clip(middle, -_MAX_DRIFT_LEVELS, _MAX_DRIFT_LEVELS), np.float32)
