"""Straight lines through points of which some are wrong and some are cut off at the end of a range. Pure numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry.arrays import Array

_NEAR = 40.0
"""Residuals up to here (per mille of the diagonal) may take part in a fit."""
_TIGHTEST = 2.0
"""The fit never trims closer than this (per mille of the diagonal)."""
_EDGE = 0.0025
"""A number so close to the edge (share of the side) counts as being there: 999 of 1000, the last pixel."""
_ENDS = 2
"""So many equal numbers at an end of the range look like clamping."""
_MOST_HELD = 0.4
"""Largest share of all answers that may lie at one end of the range and still count as held back by it."""


@dataclass(frozen=True)
class Line:
    """said = scale * expected + offset + offset_px * per_px, and what is left over.

    Attributes:
        residual: In the model's unit, shape (N,).
        held: Numbers at the end of the model's range whose expected value lies beyond it, shape (N,).
    """

    scale: float
    offset: float
    offset_px: float
    residual: Array
    held: Array


def robust_line(
    expected: Array, said: Array, per_px: Array, per_mille: Array, far: Array, scaled: bool, shift: str
) -> Line | None:
    """A line through (expected, said) along one axis, robust against outliers and clamped numbers.

    Args:
        expected: What a model without errors would say, shape (N,).
        said: What it said, shape (N,).
        per_px: The model's units per pixel of the picture sent, shape (N,).
        per_mille: Per mille of the picture's diagonal per pixel, shape (N,).
        far: The number that stands for the picture's far edge, shape (N,).
        scaled: The scale is free; else it is 1.
        shift: "unit" or "px": that offset is free; "": none is.

    Returns:
        None when the numbers hardly depend on the place.
    """
    ends = at_ends(said, far)
    held = np.zeros(len(said), dtype=bool)
    line = None
    for _ in range(3):
        line = _trimmed(expected, said, per_px, per_mille, scaled, shift, ~held)
        if line is None:
            return None
        model = line.scale * expected + line.offset + line.offset_px * per_px
        beyond = ((ends > 0) & (model > said)) | ((ends < 0) & (model < said))
        if np.array_equal(beyond, held):
            break
        held = beyond
    assert line is not None
    return Line(line.scale, line.offset, line.offset_px, line.residual, held)


def at_ends(said: Array, far: Array) -> Array:
    """+1 where a number is the upper end of a range, -1 where it is the lower end, else 0; shape (N,).

    Ends are the picture's own (0 and `far`), and the largest and smallest number of all when several answers share it.
    """
    high, low = said.max(), said.min()
    ends = np.zeros(len(said))
    for edge, sign in ((far, 1.0), (np.zeros_like(far), -1.0)):
        there = np.abs(said - edge) <= _EDGE * far
        # When most answers crowd at one end, the unit is wrong, not the model held back.
        if there.mean() <= _MOST_HELD:
            ends[there] = sign
    for value, sign in ((high, 1.0), (low, -1.0)):
        same = np.isclose(said, value, rtol=0, atol=1e-6 * max(1.0, abs(high - low)))
        if _ENDS <= same.sum() < len(said):
            ends[same] = sign
    return ends


def clamp_bounds(said: Array, held: Array) -> tuple[float | None, float | None] | None:
    """The least and the largest number that it says, each None where nothing was held back by it; None without any.

    Args:
        said: Shape (N, 2).
        held: Numbers that were held back, shape (N, 2).
    """
    if not held.any():
        return None
    middle = (said.max() + said.min()) / 2
    low, high = said[held & (said < middle)], said[held & (said >= middle)]
    return (float(low.min()) if len(low) else None), (float(high.max()) if len(high) else None)


def repeated_median_slope(x: Array, y: Array) -> float | None:
    """Siegel's repeated median: right even when almost half the points are wrong. None without spread along x.

    Source: Siegel 1982, Biometrika 69(1).
    """
    dx, dy = x[None, :] - x[:, None], y[None, :] - y[:, None]
    apart = np.abs(dx) > 1e-3 * max(1e-12, float(np.ptp(x)))
    if apart.sum() < 2:
        return None
    # Pairs without spread sort to the end; the median of each row is that of the others.
    slopes = np.sort(np.where(apart, dy / np.where(apart, dx, 1.0), np.inf), axis=1)
    counts = apart.sum(axis=1)
    rows = np.nonzero(counts)[0]
    low, high = slopes[rows, (counts[rows] - 1) // 2], slopes[rows, counts[rows] // 2]
    return float(np.median((low + high) / 2))


def _trimmed(
    expected: Array, said: Array, per_px: Array, per_mille: Array, scaled: bool, shift: str, use: Array
) -> Line | None:
    scale: float = 1.0
    if scaled:
        slope = repeated_median_slope(expected[use], said[use]) if use.sum() >= 4 else None
        if slope is None or slope <= 0:
            return None
        scale = slope
    offset = offset_px = 0.0
    if shift == "unit":
        offset = float(np.median((said - scale * expected)[use]))
    elif shift == "px":
        offset_px = float(np.median(((said - scale * expected) / per_px)[use]))
    for _ in range(4):
        left = said - scale * expected - offset - offset_px * per_px
        off = np.abs(left / (scale * per_px)) * per_mille
        limit = min(_NEAR, max(_TIGHTEST, 3.5 * float(np.median(off[use]))))
        near = use & (off <= limit)
        if near.sum() < 4 or not (scaled or shift):
            break
        columns = ([expected] if scaled else []) + ([np.ones_like(expected)] if shift == "unit" else [])
        columns += [per_px] if shift == "px" else []
        weight = (per_mille / per_px)[near]
        design = np.stack(columns, axis=1)[near] * weight[:, None]
        target = (said if scaled else said - expected)[near] * weight
        solved = list(np.linalg.lstsq(design, target, rcond=None)[0])
        scale = float(solved.pop(0)) if scaled else 1.0
        if scale <= 0:
            return None
        offset = float(solved.pop(0)) if shift == "unit" else 0.0
        offset_px = float(solved.pop(0)) if shift == "px" else 0.0
    left = said - scale * expected - offset - offset_px * per_px
    return Line(scale, offset, offset_px, left, ~use)
