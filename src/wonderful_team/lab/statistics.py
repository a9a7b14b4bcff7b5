"""Intervals for counts and medians."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from wonderful_team.models.error_profile import QUANTILES, Count, Distribution

_Z_95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal distribution."""
_RESAMPLES = 1000


def counted(count: int, n: int) -> Count:
    """A count with its 95 % Wilson interval; without an interval when there is nothing to count.

    Source: Wilson 1927, Journal of the American Statistical Association 22(158).
    """
    if n == 0:
        return Count(count=0, n=0)
    share, spread = count / n, _Z_95**2 / n
    middle = (share + spread / 2) / (1 + spread)
    half = _Z_95 / (1 + spread) * math.sqrt(share * (1 - share) / n + spread / (4 * n))
    return Count(count=count, n=n, low=max(0.0, middle - half), high=min(1.0, middle + half))


def distributed(values: Sequence[float], seed: int = 0) -> Distribution:
    """Quantiles of values, with a 95 % bootstrap interval of their median."""
    if not len(values):
        return Distribution(n=0)
    held = np.asarray(values, dtype=float)
    rng = np.random.default_rng(seed)
    medians = np.median(held[rng.integers(0, len(held), size=(_RESAMPLES, len(held)))], axis=1)
    low, high = (float(np.quantile(medians, q)) for q in (0.025, 0.975))
    return Distribution(
        n=len(held),
        quantiles=[round(float(np.quantile(held, q)), 6) for q in QUANTILES],
        median_low=round(low, 6),
        median_high=round(high, 6),
    )
