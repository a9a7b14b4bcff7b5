"""Intervals for counts and medians."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wonderful_team.core.intervals import wilson_interval
from wonderful_team.models.error_profile import QUANTILES, Count, Distribution

_RESAMPLES = 1000


def counted(count: int, n: int) -> Count:
    """A count with its 95 % Wilson interval; without an interval when there is nothing to count."""
    if n == 0:
        return Count(count=0, n=0)
    low, high = wilson_interval(count, n)
    return Count(count=count, n=n, low=low, high=high)


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
