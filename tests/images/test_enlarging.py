"""Enlarged pictures: worked on in bands, and the same as at once."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from wonderful_team.images import resample


def plainly(cut: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The same without bands, in numpy."""
    nearest, own = cv2.INTER_NEAREST_EXACT, (cut.shape[1], cut.shape[0])
    around = np.ones((3, 3), np.uint8)
    low = cv2.resize(cv2.erode(cut, around), size, interpolation=nearest)
    high = cv2.resize(cv2.dilate(cut, around), size, interpolation=nearest)
    image = np.clip(cv2.resize(cut, size, interpolation=cv2.INTER_CUBIC), low, high)
    if size[0] % own[0] or size[1] % own[1]:
        return image
    image = image.astype(np.float32)
    for _ in range(2):
        gap = cut - cv2.resize(image, own, interpolation=cv2.INTER_AREA)
        image = np.clip(image + cv2.resize(gap, size, interpolation=nearest), low, high)
    return np.rint(image).astype(np.uint8)


@pytest.mark.parametrize("band_px", [1, 999, 100_000])
@pytest.mark.parametrize(("height", "width", "zoom"), [(37, 53, 2), (41, 30, 5), (1, 7, 3), (60, 80, 1.5), (48, 64, 4)])
def test_bands_change_no_pixel(
    band_px: int, height: int, width: int, zoom: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(resample, "_BAND_PX", band_px)
    cut = np.random.default_rng(height).integers(0, 256, (height, width, 3), np.uint8)
    size = (round(width * zoom), round(height * zoom))
    assert np.array_equal(resample._enlarged(cut, size), plainly(cut, size))


@pytest.mark.parametrize("zoom", [2, 3, 7])
@pytest.mark.parametrize("even", [0.0, 0.4, 0.6, 0.97, 1.0])
def test_pixels_that_equal_their_neighbours_are_left_out_of_the_work_and_nothing_changes(
    even: float, zoom: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(resample, "_BAND_PX", 500)
    cut = np.random.default_rng(zoom).integers(0, 256, (40, 50, 3), np.uint8)
    cut[: round(even * 40)] = (200, 10, 90)
    kept = cut.copy()
    size = (50 * zoom, 40 * zoom)
    assert np.array_equal(resample._enlarged(cut, size), plainly(cut, size))
    assert np.array_equal(cut, kept)
