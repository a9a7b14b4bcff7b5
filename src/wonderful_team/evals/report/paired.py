"""A paired comparison as words: what every table of comparisons holds."""

from __future__ import annotations

from wonderful_team.evals.pairing import Pair


def paired_figures(one: Pair) -> tuple[str, ...]:
    """Difference in points, its interval, exact p, pairs, and the scenes in which just one succeeded."""
    counts = (str(one.n), str(one.only_first), str(one.only_second))
    if one.difference is None or one.interval is None or one.p is None:
        return ("no data", "no data", "no data", *counts)
    low, high = one.interval
    return (f"{100 * one.difference:+.1f}", f"{100 * low:+.1f} to {100 * high:+.1f}", f"{one.p:.3g}", *counts)
