"""Two methods on the same seeds: the exact test, the interval of the difference, and the trials that tell them apart."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from wonderful_team.core.intervals import Z_95, wilson_interval
from wonderful_team.evals.trials import Condition, Row

Scene: TypeAlias = tuple[str, int, int]
"""Task, seed, repeat: what two conditions have in common."""


_Z_POWER = 0.8416212335729143
"""Quantile of the normal distribution for a power of 80 %."""
FEWEST_DISCORDANT = 6
"""So many discordant pairs, all one way, are the fewest with an exact two-sided p below 5 % (2 / 2**6)."""


WHOLE_BINOMIALS = 1000
"""Up to so many discordant pairs binomials are whole numbers."""


def mcnemar_exact(only_first: int, only_second: int) -> float:
    """Two-sided exact p of McNemar's test: the discordant pairs against a fair coin.

    Args:
        only_first: Pairs in which just the first succeeded.
        only_second: Pairs in which just the second succeeded.

    Source: McNemar 1947, Psychometrika 12(2); exact form by the binomial distribution.
    """
    if only_first < 0 or only_second < 0:
        raise ValueError(f"counts must not be negative, got {only_first} and {only_second}")
    n = only_first + only_second
    fewer = range(min(only_first, only_second) + 1)
    if n <= WHOLE_BINOMIALS:
        return min(1.0, float(2 * sum(math.comb(n, k) for k in fewer) / 2**n))
    # Whole numbers of thousands of digits take minutes: the same terms by their logarithms.
    logs = (math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1) - n * math.log(2) for k in fewer)
    return min(1.0, 2 * math.fsum(map(math.exp, logs)))


def newcombe_paired(both: int, only_first: int, only_second: int, neither: int, z: float = Z_95) -> tuple[float, float]:
    """Interval of the difference of two paired rates, first less second.

    Raises:
        ValueError: There is no pair at all.

    Source: Newcombe 1998, Statistics in Medicine 17, 2635-2650, method 10 (Wilson scores, continuity-corrected phi).
    """
    n = both + only_first + only_second + neither
    if n < 1:
        raise ValueError("a difference needs at least one pair")
    first, second = both + only_first, both + only_second
    p1, p2 = first / n, second / n
    (l1, u1), (l2, u2) = wilson_interval(first, n, z), wilson_interval(second, n, z)
    phi = _phi(both, only_first, only_second, neither)
    down = math.sqrt(max(0.0, (p1 - l1) ** 2 - 2 * phi * (p1 - l1) * (u2 - p2) + (u2 - p2) ** 2))
    up = math.sqrt(max(0.0, (u1 - p1) ** 2 - 2 * phi * (u1 - p1) * (p2 - l2) + (p2 - l2) ** 2))
    return p1 - p2 - down, p1 - p2 + up


def _phi(both: int, only_first: int, only_second: int, neither: int) -> float:
    """Correlation of the pairs, corrected for continuity where it is positive; 0 where a margin is empty."""
    n = both + only_first + only_second + neither
    margins = (both + only_first) * (only_second + neither) * (both + only_second) * (only_first + neither)
    if margins == 0:
        return 0.0
    cross = both * neither - only_first * only_second
    corrected = max(cross - n / 2, 0) if cross > 0 else cross
    return corrected / math.sqrt(margins)


def pairs_needed(only_first: float, only_second: float) -> int | None:
    """About how many pairs McNemar's test needs to see this gap (5 % two-sided, power 80 %); None without a gap.

    Args:
        only_first: Share of the pairs in which just the first succeeds.
        only_second: The same for the second.

    Source: Connor 1987, Biometrics 43(1), 207-211.
    """
    discordant, gap = only_first + only_second, abs(only_first - only_second)
    if gap == 0:
        return None
    root = Z_95 * math.sqrt(discordant) + _Z_POWER * math.sqrt(max(0.0, discordant - gap * gap))
    # However clear the gap, the exact test needs some discordant pairs before it can say so.
    return max(math.ceil((root / gap) ** 2), math.ceil(FEWEST_DISCORDANT / discordant))


def visible_gap(n: int, discordant: float = 0.3) -> float | None:
    """The smallest gap that n pairs show (5 % two-sided, power 80 %), if that share of pairs is discordant.

    Returns:
        A share, or None where n pairs cannot show any gap.
    """
    for points in range(1, 101):
        gap = points / 100
        share = max(discordant, gap)
        needed = pairs_needed((share + gap) / 2, (share - gap) / 2)
        if needed is not None and needed <= n:
            return gap
    return None


@dataclass(frozen=True)
class Pair:
    """Two conditions on the scenes that both have scored.

    Attributes:
        discordant: Scenes in which just one succeeded, with the name of that one ("first" or "second").
        unpaired: Scenes that only one of them has scored.
    """

    first: Condition
    second: Condition
    both: int
    only_first: int
    only_second: int
    neither: int
    discordant: tuple[tuple[Scene, str], ...]
    unpaired: int

    @property
    def n(self) -> int:
        return self.both + self.only_first + self.only_second + self.neither

    @property
    def difference(self) -> float | None:
        """First less second, over the pairs; None without pairs."""
        return (self.only_first - self.only_second) / self.n if self.n else None

    @property
    def interval(self) -> tuple[float, float] | None:
        if not self.n:
            return None
        return newcombe_paired(self.both, self.only_first, self.only_second, self.neither)

    @property
    def p(self) -> float | None:
        """Exact two-sided McNemar; None without pairs."""
        return mcnemar_exact(self.only_first, self.only_second) if self.n else None

    def sentence(self) -> str:
        """The answer in a sentence, or that it cannot be told and what it would take."""
        one, other = self.first.label, self.second.label
        if self.interval is None or self.difference is None or self.p is None:
            return f"{one} against {other}: no data: they have no scored scene in common."
        low, high = (100 * bound for bound in self.interval)
        gap = 100 * self.difference
        found = f"difference {gap:+.1f} points, 95 % interval {low:+.1f} to {high:+.1f}, n = {self.n} pairs, exact p = {self.p:.3g}"
        if self.p < 0.05:
            return f"{one} succeeds {'more' if gap > 0 else 'less'} often than {other}: {found}."
        needed = pairs_needed(self.only_first / self.n, self.only_second / self.n)
        more = (
            f"if this gap is real, about {max(needed, self.n + 1)} pairs would show it" if needed else "no gap was seen"
        )
        return f"Cannot tell {one} from {other}: {found}; {more}."


def pair(first: Condition, second: Condition, rows: Sequence[Row]) -> Pair:
    """Compare two conditions over the scenes that both have scored."""
    one, other = scored(first, rows), scored(second, rows)
    shared = sorted(one.keys() & other.keys())
    counts = {(True, True): 0, (True, False): 0, (False, True): 0, (False, False): 0}
    discordant: list[tuple[Scene, str]] = []
    for scene in shared:
        counts[one[scene], other[scene]] += 1
        if one[scene] != other[scene]:
            discordant.append((scene, "first" if one[scene] else "second"))
    return Pair(
        first,
        second,
        counts[True, True],
        counts[True, False],
        counts[False, True],
        counts[False, False],
        tuple(discordant),
        len(one.keys() ^ other.keys()),
    )


def scored(condition: Condition, rows: Sequence[Row]) -> Mapping[Scene, bool]:
    """Whether each scored scene of a condition succeeded; errors and unscored trials are not in it."""
    return {
        (row.spec.task, row.spec.seed, row.spec.repeat): row.result.outcome == "success"
        for row in rows
        if row.spec.condition == condition and row.result is not None and row.result.outcome in ("success", "failure")
    }
