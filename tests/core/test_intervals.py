"""Intervals against published values, and confusion matrices by hand."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wonderful_team.core.intervals import mean_interval
from wonderful_team.evals import Rate, wilson_interval


@pytest.mark.parametrize(
    ("successes", "n", "low", "high"),
    # Newcombe 1998, Statistics in Medicine 17, table I, method 3 (Wilson score, no continuity correction).
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_published_intervals(successes, n, low, high):
    assert wilson_interval(successes, n) == pytest.approx((low, high), abs=5e-5)


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_holds_the_rate_and_stays_a_rate(case):
    successes, n = case
    low, high = wilson_interval(successes, n)
    assert 0 <= low <= successes / n <= high <= 1


def test_no_trials_is_no_data_never_zero():
    assert str(Rate(0, 0)) == "no data"
    with pytest.raises(ValueError, match="at least 1"):
        wilson_interval(0, 0)


def test_a_mean_of_rates_has_the_interval_of_its_parts():
    # Of one rate it is Wilson's; of two independent ones the difference's in Newcombe 1998, table II: 56/70 less 48/80, method 10.
    assert mean_interval([Rate(15, 148)], [1.0])[1:] == pytest.approx(wilson_interval(15, 148))
    mean, low, high = mean_interval([Rate(56, 70), Rate(80 - 48, 80)], [0.5, 0.5])
    assert 2 * mean - 1 == pytest.approx(0.2)
    assert (2 * low - 1, 2 * high - 1) == pytest.approx((0.0524, 0.3339), abs=5e-5)
    # Rates of 0 and 1 are no certainty.
    assert mean_interval([Rate(0, 10), Rate(10, 10)], [0.5, 0.5])[1] < 0.45
