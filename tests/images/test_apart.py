"""Where pictures are apart, and middle colours, against numpy in the plain way."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.images.apart import apart, middle_colour


@pytest.mark.parametrize("most", [0, 2.0, 5.5, 24.0])
@pytest.mark.parametrize("seed", range(4))
def test_what_is_apart_in_some_channel(seed: int, most: float) -> None:
    rng = np.random.default_rng(seed)
    one = rng.integers(0, 256, (31, 45, 3), np.uint8)
    other = np.clip(one.astype(int) + rng.integers(-8, 9, one.shape), 0, 255).astype(np.uint8)
    colour = np.array([117.5, 3.0, 250.25]) if seed % 2 else rng.integers(0, 256, 3)
    far = np.abs(one.astype(float) - other).max(axis=2) > most
    assert np.array_equal(apart(one, other, most), far)
    assert np.array_equal(apart(one[::2, 1:], other[::2, 1:], most), far[::2, 1:])
    assert np.array_equal(apart(one, colour, most), np.abs(one.astype(float) - colour).max(axis=2) > most)


@pytest.mark.parametrize("count", [1, 2, 3, 10, 1001, 4096])
def test_the_middle_colour_is_the_median(count: int) -> None:
    pixels = np.random.default_rng(count).integers(0, 256, (count, 3), np.uint8)
    assert np.array_equal(middle_colour(pixels), np.median(pixels, axis=0))
