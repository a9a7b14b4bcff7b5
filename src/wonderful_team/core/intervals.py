"""Rates of counts, with their intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

Z_95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal distribution."""


def wilson_interval(successes: int, n: int, z: float = Z_95) -> tuple[float, float]:
    """Wilson score interval of a rate.

    Args:
        successes: How many of the trials succeeded.
        n: How many trials there were; at least 1.
        z: Quantile; 1.96 for 95 %.

    Raises:
        ValueError: n is not positive, or successes lies outside 0..n. No trials is "no data", not a rate.

    Source: Wilson 1927, Journal of the American Statistical Association 22(158).
    """
    if n < 1 or not 0 <= successes <= n:
        raise ValueError(f"successes must lie in 0..n and n be at least 1, got {successes} of {n}")
    share = successes / n
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    # At the ends the bounds are 0 and 1 exactly; rounding must not push them past.
    low = 0.0 if successes == 0 else middle - half
    high = 1.0 if successes == n else middle + half
    return low, high


def mean_interval(rates: Sequence[Rate], weights: Sequence[float]) -> tuple[float, float, float]:
    """A weighted mean of independent rates, with its 95 % interval.

    Each rate's distance to its own Wilson bounds stands for its spread, so that rates of 0 and 1 keep one.

    Args:
        rates: Each with trials.
        weights: One for each; their sum is 1.

    Returns:
        Mean, lower and upper bound.

    Source: Zou, Huang & Zhang 2009, Computational Statistics & Data Analysis 53, 1080-1085 (variance estimates recovery).
    """
    shares = [rate.successes / rate.n for rate in rates]
    bounds = [wilson_interval(rate.successes, rate.n) for rate in rates]
    mean = math.fsum(weight * share for weight, share in zip(weights, shares, strict=True))
    down = math.hypot(*(w * (share - low) for w, share, (low, _) in zip(weights, shares, bounds, strict=True)))
    up = math.hypot(*(w * (high - share) for w, share, (_, high) in zip(weights, shares, bounds, strict=True)))
    return mean, mean - down, mean + up


@dataclass(frozen=True)
class Rate:
    """So many of so many; prints with its 95 % interval, and as "no data" without trials."""

    successes: int
    n: int

    @property
    def share(self) -> float | None:
        return self.successes / self.n if self.n else None

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 %; None without trials."""
        return wilson_interval(self.successes, self.n) if self.n else None

    def __str__(self) -> str:
        if not self.n:
            return "no data"
        low, high = wilson_interval(self.successes, self.n)
        return f"{100 * self.successes / self.n:.1f} % ({self.successes}/{self.n}; 95 % interval {100 * low:.1f} to {100 * high:.1f})"
