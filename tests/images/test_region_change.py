"""The staleness measure: a nudge of a centimetre stands out, noise and light do not."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.images.scenes import table
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.images import CHANGED, region_change

# Size, the block's box, and one centimetre in pixels when the view is one metre wide.
SIZES = [(256, 128, 2.5), (640, 480, 6.4), (1280, 960, 12.8)]


def block(width: int, height: int) -> Box:
    half = 38 * min(width, height) / 480
    return Box.around((width * 0.25, height * 0.55), 2 * half, 2 * half)


def noisy(rgb: Array, sigma: float, seed: int) -> Array:
    noise = np.random.default_rng(seed).normal(0, sigma, rgb.shape)
    return np.clip(rgb + noise, 0, 255).astype(np.uint8)


def jpeg(rgb: Array, quality: int) -> Array:
    data = cv2.imencode(".jpg", rgb, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR))


@pytest.mark.parametrize(("width", "height", "one_cm_px"), SIZES)
def test_a_nudge_of_one_centimetre_stands_out(width: int, height: int, one_cm_px: float) -> None:
    before = table(width, height)
    for dx, dy in ((one_cm_px, 0), (-one_cm_px, 0), (0, one_cm_px), (0.7 * one_cm_px, 0.7 * one_cm_px)):
        after = table(width, height, shift=(dx, dy))
        assert region_change(before, after, block(width, height)) > 2 * CHANGED
        assert region_change(noisy(before, 4, 1), noisy(after, 4, 2), block(width, height)) > 2 * CHANGED


@pytest.mark.parametrize(("width", "height", "one_cm_px"), SIZES)
def test_noise_jpeg_and_light_do_not(width: int, height: int, one_cm_px: float) -> None:
    before, box = table(width, height), block(width, height)
    assert region_change(before, before, box) == 0
    assert region_change(noisy(before, 6, 1), noisy(before, 6, 2), box) < CHANGED / 2
    assert region_change(before, jpeg(before, 70), box) < CHANGED / 2
    brighter = np.clip(before.astype(int) + 12, 0, 255).astype(np.uint8)
    assert region_change(before, brighter, box) < CHANGED / 2


def test_only_the_region_counts() -> None:
    before, after = table(), table(shift=(30, 0))
    assert region_change(before, after, Box(378, 131, 518, 271)) < CHANGED / 2
    assert region_change(before, after, block(640, 480)) == 1


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(ValueError, match="one size"):
        region_change(table(), table(320, 240), Box(0, 0, 10, 10))
    with pytest.raises(ValueError, match="lies outside the view"):
        region_change(table(), table(), Box(700, 0, 710, 10))
