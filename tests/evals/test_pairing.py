"""The paired statistics, against figures of the literature and numbers worked out by hand."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

from tests.evals.runners import quick, toy_plan
from wonderful_team.evals.pairing import mcnemar_exact, newcombe_paired, pair, pairs_needed, visible_gap
from wonderful_team.evals.trials import Condition, Row, TrialRow, TrialSpec


def test_mcnemar_is_the_exact_binomial() -> None:
    assert mcnemar_exact(0, 0) == 1.0
    assert mcnemar_exact(5, 5) == 1.0
    assert mcnemar_exact(6, 0) == pytest.approx(2 / 64)
    assert mcnemar_exact(1, 8) == mcnemar_exact(8, 1) == pytest.approx(2 * (1 + 9) / 512)
    with pytest.raises(ValueError, match="negative"):
        mcnemar_exact(-1, 2)


def test_newcombe_matches_his_published_example() -> None:
    """Newcombe 1998, Statistics in Medicine 17, 2635-2650: cells 36, 12, 2, 0 of 50 give 0.0569 to 0.3404 by method 10."""
    low, high = newcombe_paired(36, 12, 2, 0)
    assert low == pytest.approx(0.0569, abs=5e-5)
    assert high == pytest.approx(0.3404, abs=5e-5)


def test_newcombe_covers_the_truth_about_as_often_as_it_says() -> None:
    rng = np.random.default_rng(7)
    shares = (0.4, 0.25, 0.1, 0.25)
    draws = rng.multinomial(40, shares, size=1500)
    held = 0
    for cells in draws:
        low, high = newcombe_paired(*(int(count) for count in cells))
        held += low <= shares[1] - shares[2] <= high
    assert 0.93 <= held / len(draws) <= 0.98


def test_the_interval_lies_around_the_difference_and_within_bounds() -> None:
    for both, one, other, neither in itertools.product((0, 3, 20), repeat=4):
        if both + one + other + neither == 0:
            continue
        low, high = newcombe_paired(both, one, other, neither)
        difference = (one - other) / (both + one + other + neither)
        assert -1 - 1e-9 <= low <= difference + 1e-9 <= high + 2e-9 <= 1 + 3e-9


def test_more_scenes_show_smaller_gaps() -> None:
    few, many = visible_gap(20), visible_gap(200)
    assert few is not None
    assert many is not None
    assert many < few
    assert visible_gap(2) is None
    needed = pairs_needed(0.3, 0.1)
    assert needed is not None
    assert 70 <= needed <= 80  # Connor's formula by hand: ((1.96 sqrt(0.4) + 0.8416 sqrt(0.36)) / 0.2)^2 = 76.1


def _row(method: str, seed: int, outcome: str) -> Row:
    return Row(TrialSpec("toy/a", seed, Condition(method, "m")), TrialRow(outcome))  # type: ignore[arg-type]


def test_a_pair_uses_shared_scored_scenes_only_and_lists_the_discordant_ones() -> None:
    rows = [_row("a", seed, "success") for seed in range(8)] + [_row("b", seed, "failure") for seed in range(6)]
    rows += [_row("b", 6, "error"), _row("b", 7, "success")]
    found = pair(Condition("a", "m"), Condition("b", "m"), rows)
    assert (found.n, found.both, found.only_first, found.only_second, found.neither) == (7, 1, 6, 0, 0)
    assert found.unpaired == 1
    assert [scene[1] for scene, _ in found.discordant] == list(range(6))
    assert found.p == pytest.approx(2 / 64)
    assert "more often" in found.sentence()


def test_no_scene_in_common_is_no_data_and_little_data_cannot_tell() -> None:
    a, b = Condition("a", "m"), Condition("b", "m")
    assert "no data" in pair(a, b, [_row("a", 1, "success"), _row("b", 2, "success")]).sentence()
    rows = [_row("a", seed, "success") for seed in range(4)] + [_row("b", seed, "failure") for seed in range(3)]
    sentence = pair(a, b, [*rows, _row("b", 3, "success")]).sentence()
    assert sentence.startswith("Cannot tell")
    assert "pairs would show it" in sentence


def test_the_plan_keeps_the_trials_of_a_scene_together_in_one_shard() -> None:
    whole = {spec.key for spec in toy_plan().trials()}
    parts = [list(toy_plan(shard=(part, 3)).trials()) for part in (1, 2, 3)]
    assert sum(len(part) for part in parts) == len(whole) == 40
    assert {spec.key for part in parts for spec in part} == whole
    for part in parts:
        scenes = {(spec.task, spec.seed) for spec in part}
        assert len(part) == 2 * len(scenes)
    assert quick(parts[0][0], None).outcome in ("success", "failure")  # type: ignore[arg-type]


def test_many_discordant_pairs_are_tested_as_exactly_as_few() -> None:
    for first, second in ((700, 620), (1005, 1005), (2000, 1700), (0, 1500)):
        whole = sum(math.comb(first + second, k) for k in range(min(first, second) + 1))
        right = min(1.0, float(Fraction(2 * whole, 2 ** (first + second))))
        assert mcnemar_exact(first, second) == pytest.approx(right, rel=1e-9)
