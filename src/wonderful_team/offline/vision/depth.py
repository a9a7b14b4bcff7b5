"""A depth picture as a sensor gives it, made steady: noise, and readings that are lost or mixed at edges, taken out."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array

QUIET_M = 0.0004
"""Noise up to which a depth picture is taken as it is [m]: exact ones, and those that come in steps of a millimetre."""
TIMES = 2
"""How often the median of five by five pixels is taken."""
LEAST_KNOWN = 0.3
"""Share of the readings round a pixel that have to be there for its depth to be known."""
SAME_M = 0.003
"""Readings that differ by about so much are of one surface [m]."""
_FAR_M = 1e4


def steady(depth_m: Array) -> Array:
    """Depth with its noise taken out, where there is any, shape (H, W) [m]; NaN where it is not known.

    Args:
        depth_m: Distance along the optical axis, shape (H, W); NaN or 0 where unknown.
    """
    known = np.isfinite(depth_m) & (depth_m > 0)
    if noise_m(np.where(known, depth_m, np.nan)) <= QUIET_M:
        return depth_m
    rows, columns = np.indices(depth_m.shape)
    # What is lost counts for near and for far in turn, so that the median is that of what is known.
    lost = np.where((rows + columns) % 2, _FAR_M, 0.0)
    for _ in range(TIMES):
        settled = cv2.medianBlur(np.where(known, depth_m, lost).astype(np.float32), 5)
        share = cv2.blur(known.astype(np.float32), (5, 5))
        known = (share >= LEAST_KNOWN) & (settled > 0) & (settled < _FAR_M / 2)
        depth_m = np.where(known, settled, np.nan).astype(np.float32)
    # Medians of readings in steps are in steps, too.
    even = cv2.bilateralFilter(np.where(known, depth_m, 0.0).astype(np.float32), 5, SAME_M, 2.0)
    return np.where(known, even, np.nan).astype(np.float32)


def noise_m(depth_m: Array) -> float:
    """Standard deviation of single readings [m], by how far they lie off the middle of their two neighbours; 0 when too few are known."""
    bend = depth_m[:, 2:] - 2 * depth_m[:, 1:-1] + depth_m[:, :-2]
    bend = np.abs(bend[np.isfinite(bend)])
    return 1.4826 * float(np.median(bend)) / np.sqrt(6.0) if bend.size else 0.0
