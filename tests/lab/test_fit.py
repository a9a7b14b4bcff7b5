"""The fit finds every convention of the table, odd ones too, and says so when nothing fits."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wonderful_team.lab.fit import Fit, Sighting, fit_convention
from wonderful_team.lab.marks import marked_scene
from wonderful_team.lab.probe import FIT_SIZES
from wonderful_team.models.conventions import CONVENTIONS, Convention, Resize, Size

OTHER_SIZES: tuple[Size, ...] = ((640, 480), (512, 1024), (1000, 1000), (1280, 720), (448, 448))
"""Sizes that were not fitted on."""

ODD: dict[str, Convention] = {
    "y first": Convention("odd", "yx", "thousandths"),
    "offset in its unit": Convention("odd", "xy", "thousandths", offset=(25.0, -18.0)),
    "offset in px": Convention("odd", "xy", "pixels", offset_px=(12.0, -9.0)),
    "wrong scale": Convention("odd", "xy", "pixels", scale=(0.9, 0.9)),
    "unequal scale, y first": Convention("odd", "yx", "thousandths", scale=(1.024, 0.95)),
    "always 448 x 448": Convention("odd", "xy", "thousandths", scale=(0.448, 0.448)),
    "longest side 1024": Convention("odd", "xy", "pixels", Resize(longest_side=1024)),
    "longest side 700, y first": Convention("odd", "yx", "pixels", Resize(longest_side=700)),
    "longest side 768 and an offset": Convention("odd", "xy", "pixels", Resize(longest_side=768), offset=(10.0, 5.0)),
    "longest side always 1000": Convention("odd", "xy", "pixels", Resize(longest_side=1000, always=True)),
    "multiples of 28 in 1280 tiles": Convention("odd", "xy", "pixels", Resize(max_pixels=1280 * 784, multiple=28)),
    "multiples of 32": Convention("odd", "xy", "pixels", Resize(multiple=32)),
    "400 000 pixels at most": Convention("odd", "yx", "pixels", Resize(max_pixels=400_000)),
    "between two areas": Convention("odd", "xy", "pixels", Resize(max_pixels=602_112, min_pixels=401_408, multiple=28)),
    "half": Convention("odd", "xy", "pixels", scale=(0.5, 0.5)),
}


def answers(
    say: Callable[[np.ndarray, Size], np.ndarray], *, noise: float = 0.0, wild: float = 0.0, seed: int = 0
) -> list[Sighting]:
    """What a model would say of three pictures; `noise` and `wild` as in OddEyes."""
    rng = np.random.default_rng(seed)
    sightings = []
    for k, size in enumerate(FIT_SIZES):
        points = _places(seed % 40 + k, size)
        meant = points + rng.normal(0, noise * math.hypot(*size), points.shape)
        lost = rng.random(len(points)) < wild
        meant[lost] = rng.uniform(0, 1, (int(lost.sum()), 2)) * size
        sightings.append(Sighting(size, points, say(meant, size)))
    return sightings


@cache
def _places(seed: int, size: Size) -> np.ndarray:
    return np.array([mark.centre for mark in marked_scene(seed, size, background="plain").marks])


def spoken(convention: Convention) -> Callable[[np.ndarray, Size], np.ndarray]:
    """A model of that convention, rounding as such models do."""
    digits = {"unit": 4, "percent": 1}.get(convention.unit, 0)
    return lambda meant, size: np.round(convention.to_model(meant, size), digits)


def error_in_use(fit: Fit, truth: Convention) -> float:
    """Largest error over other sizes when pictures are sent as the fitted convention has it (share of the diagonal)."""
    worst = 0.0
    for size in OTHER_SIZES:
        sent_size = fit.convention.seen_size(size)
        points = np.array([(0.0, 0.0), size, (0.3 * size[0], 0.8 * size[1])])
        to_sent = np.array(sent_size) / np.array(size)
        said = truth.to_model(points * to_sent, sent_size)
        found = fit.convention.to_px(said, sent_size) / to_sent
        worst = max(worst, float(np.abs(found - points).max()) / math.hypot(*size))
    return worst


@pytest.mark.parametrize("name", [*CONVENTIONS, *ODD])
def test_finds_each_convention_from_rounded_answers(name: str) -> None:
    truth = CONVENTIONS.get(name) or ODD[name]
    fit = fit_convention(answers(spoken(truth)))
    assert fit.good, fit.why
    assert fit.convention.order == truth.order
    assert fit.outliers == 0
    assert fit.median_px < 1.5
    assert error_in_use(fit, truth) < 0.002


@settings(max_examples=15, deadline=None)
@given(name=st.sampled_from(sorted(CONVENTIONS)), seed=st.integers(0, 500))
def test_finds_rows_of_the_table_through_noise_and_wild_answers(name: str, seed: int) -> None:
    truth = CONVENTIONS[name]
    fit = fit_convention(answers(spoken(truth), noise=0.003, wild=0.08, seed=seed))
    assert fit.good, fit.why
    assert fit.convention.order == truth.order
    assert error_in_use(fit, truth) < 0.02


@settings(max_examples=15, deadline=None)
@given(
    order=st.sampled_from(["xy", "yx"]),
    unit=st.sampled_from(["pixels", "thousandths", "percent", "unit"]),
    scale=st.floats(0.7, 1.4),
    shift=st.floats(-0.06, 0.06),
    seed=st.integers(0, 500),
)
def test_finds_scale_and_offset_of_any_size(order: str, unit: str, scale: float, shift: float, seed: int) -> None:
    span = {"pixels": 800.0, "thousandths": 1000.0, "percent": 100.0, "unit": 1.0}[unit]
    truth = Convention("odd", order, unit, scale=(scale, scale), offset=(shift * span, -shift * span))  # type: ignore[arg-type]
    fit = fit_convention(answers(lambda meant, size: truth.to_model(meant, size), noise=0.001, seed=seed))
    assert fit.good, fit.why
    assert fit.convention.order == order
    assert error_in_use(fit, truth) < 0.006


def _padded(meant: np.ndarray, size: Size) -> np.ndarray:
    """Counts in a square in whose middle the picture lies: no convention here can say that."""
    factor = 1000 / max(size)
    return meant * factor + (1000 - np.array(size) * factor) / 2


NONSENSE: dict[str, Callable[[np.ndarray, Size], np.ndarray]] = {
    "anywhere": lambda meant, size: np.random.default_rng(3).uniform(0, 1000, meant.shape),
    "always the middle": lambda meant, size: np.full(meant.shape, 500.0),
    "y upwards": lambda meant, size: np.stack([meant[:, 0], size[1] - meant[:, 1]], axis=1),
    "now this order, now that": lambda meant, size: np.where(np.arange(len(meant))[:, None] % 2, meant, meant[:, ::-1]),
    "in a padded square": _padded,
    "very noisy": lambda meant, size: meant + np.random.default_rng(5).normal(0, 0.04 * math.hypot(*size), meant.shape),
}


@pytest.mark.parametrize("name", NONSENSE)
def test_says_so_when_nothing_fits(name: str) -> None:
    fit = fit_convention(answers(NONSENSE[name]))
    assert not fit.good
    assert "answers" in fit.why


def test_two_answers_in_three_pictures_decide_nothing() -> None:
    sightings = answers(spoken(CONVENTIONS["gemini"]))
    sparse = [Sighting(s.size_px, s.points_px, np.where(np.arange(8)[:, None] < 1, s.said, np.nan)) for s in sightings]
    fit = fit_convention(sparse)
    assert not fit.good
    assert fit.why == "only 3 of 24 marks were answered"


def test_no_answer_at_all_is_no_fit() -> None:
    sightings = answers(lambda meant, size: np.full(meant.shape, np.nan))
    assert fit_convention(sightings).why == "only 0 of 24 marks were answered"


def test_clamped_numbers_are_found_and_left_out() -> None:
    fit = fit_convention(answers(lambda meant, size: np.clip(np.round(meant + (45, -50)), 0, np.array(size) - 1)))
    assert fit.good, fit.why
    assert fit.clamped is not None
    assert fit.clamped[1] is None or fit.clamped[1] >= 600
    assert fit.median_px < 1.0
    shift = fit.convention.offset if fit.convention.offset != (0.0, 0.0) else fit.convention.offset_px
    assert shift == pytest.approx((45, -50), abs=1.5)


def test_outliers_are_counted_and_do_not_bend_the_fit() -> None:
    truth = CONVENTIONS["qwen3-vl"]
    fit = fit_convention(answers(spoken(truth), wild=0.2, seed=4))
    assert fit.good, fit.why
    assert fit.outliers >= 2
    assert fit.convention.scale == (1.0, 1.0)
    assert error_in_use(fit, truth) < 0.001
