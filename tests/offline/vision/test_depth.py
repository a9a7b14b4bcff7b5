"""Depth as a sensor gives it: noise and lost readings are taken out, edges stay, exact depth is not touched."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.offline.vision.depth import noise_m, steady

EXACT = np.full((120, 160), 1.15, np.float32)
EXACT[40:80, 50:100] = 1.105


def sensed(noise: float) -> np.ndarray:
    rng = np.random.default_rng(0)
    read = np.round((EXACT + rng.normal(0, noise, EXACT.shape)) / 0.001) * 0.001
    read[rng.random(EXACT.shape) < 0.1] = np.nan
    return read.astype(np.float32)


def test_exact_depth_stays_as_it_is() -> None:
    assert steady(EXACT) is EXACT


@pytest.mark.parametrize("noise", [0.001, 0.002, 0.003])
def test_noise_is_taken_out_and_edges_stay(noise: float) -> None:
    read = sensed(noise)
    assert noise_m(read) == pytest.approx(noise, rel=0.25)
    settled = steady(read)
    off = np.abs(settled - EXACT)
    assert np.isfinite(settled).all()
    assert np.quantile(off, 0.99) < 0.6 * noise + 0.0005
    assert off[42:78, 52:98].max() < 0.01, "the block is as high as it is up to two pixels from its edge"


def test_a_hole_stays_a_hole() -> None:
    read = sensed(0.002)
    read[10:30, 10:30] = np.nan
    assert np.isnan(steady(read)[15:25, 15:25]).all()
