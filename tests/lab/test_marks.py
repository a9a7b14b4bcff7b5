"""Probe pictures: where they say a mark is, it is."""

from __future__ import annotations

import numpy as np
import pytest

from tests.servers.odd import find_colour
from wonderful_team.lab.marks import BACKGROUNDS, COLOURS, marked_scene
from wonderful_team.lab.probe import CHECK_SIZES, FIT_SIZES


@pytest.mark.parametrize("size", [*FIT_SIZES, *CHECK_SIZES])
@pytest.mark.parametrize("background", BACKGROUNDS)
def test_a_stranger_finds_every_mark_by_its_colour(size: tuple[int, int], background: str) -> None:
    """Another piece of code, which knows colours by hue alone, measures the same boxes."""
    scene = marked_scene(size[0], size, background=background)
    assert len(scene.marks) == len(COLOURS)
    for mark in scene.marks:
        found = find_colour(scene.picture.rgb, mark.words.split()[0])
        assert found == pytest.approx(mark.box.as_tuple, abs=1e-9), mark.words
        assert mark.centre == mark.box.centre


def test_marks_reach_all_corners_and_never_touch() -> None:
    for seed in range(20):
        scene = marked_scene(seed, (640, 480))
        places = np.array([mark.centre for mark in scene.marks]) / (640, 480)
        for corner in ((0, 0), (1, 0), (0, 1), (1, 1)):
            assert np.abs(places - corner).max(axis=1).min() < 0.3
        boxes = [mark.box for mark in scene.marks]
        assert all(a.iou(b) == 0 for k, a in enumerate(boxes) for b in boxes[:k])
        assert all(0 <= box.x0 and 0 <= box.y0 and box.x1 <= 640 and box.y1 <= 480 for box in boxes)


def test_a_seed_gives_one_picture() -> None:
    assert marked_scene(5, (300, 200)).picture.hash == marked_scene(5, (300, 200)).picture.hash
    assert marked_scene(5, (300, 200)).picture.hash != marked_scene(6, (300, 200)).picture.hash


def test_absent_things_are_not_in_the_picture() -> None:
    scene = marked_scene(3, (640, 480), absent=3)
    assert len(scene.marks) == len(COLOURS) - 3
    for words in scene.absent:
        assert find_colour(scene.picture.rgb, words.split()[0]) is None
    assert [target.id for target in scene.targets()] == [f"T{k}" for k in range(1, 6)]


def test_a_picture_too_small_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 96 px"):
        marked_scene(0, (80, 400))
