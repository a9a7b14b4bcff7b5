"""A picture of twice the size is worked out in whole numbers, and one that many pictures show is hashed once: to the same bits."""

from __future__ import annotations

import gc

import cv2
import numpy as np
import pytest

from wonderful_team.core import pictures
from wonderful_team.core.pictures import pixels_hash
from wonderful_team.images import resample


@pytest.mark.parametrize("size", [(1, 1), (3, 40), (97, 61), (300, 400)])
def test_whole_numbers_give_what_fractions_give(size: tuple[int, int]) -> None:
    rng = np.random.default_rng(sum(size))
    cut = rng.integers(0, 256, (*size, 3)).astype(np.uint8)
    around = np.ones((3, 3), np.uint8)
    low, high = cv2.erode(cut, around), cv2.dilate(cut, around)
    enlarged = rng.integers(0, 256, (2 * size[0], 2 * size[1], 3)).astype(np.uint8)
    doubled = enlarged.copy()
    resample._keep_bands_inplace(enlarged, cut, low, high)
    resample._keep_doubled_inplace(doubled, cut, low, high)
    assert np.array_equal(doubled, enlarged)


def test_a_hash_is_kept_for_as_long_as_its_image_lives() -> None:
    rgb = np.random.default_rng(0).integers(0, 256, (20, 30, 3)).astype(np.uint8)
    first = pixels_hash(rgb)
    rgb[0, 0] += 1
    assert pixels_hash(rgb) != first, "an image that may change is looked at each time"
    rgb.setflags(write=False)
    key = id(rgb)
    assert pixels_hash(rgb) == pixels_hash(rgb) == pixels_hash(rgb.copy())
    assert key in pictures._hashes
    del rgb
    gc.collect()
    assert key not in pictures._hashes
