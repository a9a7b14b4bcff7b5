"""The classical detector finds things by words from pixels alone, with boxes and masks, and nothing that is not there."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from wonderful_team.core.values import Detection
from wonderful_team.detectors import detect
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.detector import ClassicalDetector

YY, XX = np.mgrid[0:360, 0:480]


def table(*, stripes: bool = False) -> np.ndarray:
    """A grey table with a red square, a blue disc and a green bar."""
    rgb = np.full((360, 480, 3), 190, np.uint8)
    rgb[60:120, 80:140] = (200, 30, 30)
    if stripes:
        rgb[60:120, 80:140][:, (np.arange(60) // 6) % 2 == 0] = (240, 240, 240)
    rgb[np.hypot(XX + 0.5 - 330, YY + 0.5 - 110) < 40] = (30, 60, 200)
    rgb[250:280, 100:260] = (30, 150, 50)
    return rgb


def look(rgb: np.ndarray, *words: str) -> tuple[Detection, ...]:
    return asyncio.run(detect(ClassicalDetector(), rgb, words))


def test_things_are_found_by_colour_with_tight_boxes_and_masks() -> None:
    rgb = table()
    red, blue, green = look(rgb, "red block", "blue circle", "green object")
    for one, true in ((red, rgb[:, :, 0] == 200), (blue, rgb[:, :, 2] == 200), (green, rgb[:, :, 1] == 150)):
        rows, columns = np.nonzero(true)
        box = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        assert one.box.as_tuple == pytest.approx(box, abs=3)
        assert one.mask is not None
        assert (one.mask & true).sum() / (one.mask | true).sum() > 0.9
        assert 0.4 <= one.score <= 1


def test_masks_of_large_pictures_have_the_size_of_the_picture() -> None:
    """They are looked at in a smaller size; boxes and masks are the picture's own."""
    rgb = np.repeat(np.repeat(table(), 4, axis=0), 4, axis=1)
    (red,) = look(rgb, "red block")
    assert red.mask is not None
    assert red.mask.shape == rgb.shape[:2]
    assert red.box.as_tuple == pytest.approx((320, 240, 560, 480), abs=12)
    true = rgb[:, :, 0] == 200
    assert (red.mask & true).sum() / (red.mask | true).sum() > 0.9


def test_patterns_tell_apart() -> None:
    assert [one.words for one in look(table(stripes=True), "striped block", "dotted ring")] == ["striped block"]


def test_what_is_not_there_is_not_found() -> None:
    assert look(table(), "yellow block", "purple star") == ()
    assert look(np.full((100, 100, 3), 90, np.uint8), "red block") == ()


def test_free_places_are_no_things() -> None:
    assert look(table(), "free area left of the red block") == ()


def test_unknown_words_are_refused_by_name() -> None:
    with pytest.raises(NotUnderstoodError, match="do not know: mug"):
        look(table(), "mug")
    with pytest.raises(NotUnderstoodError, match="reads words alone"):
        look(table(), "{dragged_obj}")
