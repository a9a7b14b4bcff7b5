"""A detection holds what it says: a box, a score from 0 to 1, a mask of the picture's shape; and masks become run lengths and back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Detection, mask_from_runs, mask_to_runs

BOX = Box(1, 1, 3, 4)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"words": " "}, "words ' '"),
        ({"box": (1, 1, 3, 4)}, r"box \(1, 1, 3, 4\): valid is a wt.Box"),
        ({"score": 1.2}, r"score 1.2 of 'cup': valid is 0 to 1"),
        ({"score": float("nan")}, "score nan"),
        ({"mask": np.ones((4, 5))}, r"bool array of shape \(H, W\).*float64 \(4, 5\)"),
        ({"mask": np.ones((4, 5, 1), bool)}, r"bool \(4, 5, 1\)"),
        ({"mask": np.zeros((4, 5), bool)}, "without a pixel in it"),
    ],
)
def test_what_is_no_detection_is_refused_with_its_value(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Detection(**{"words": "cup", "box": BOX, "score": 0.5, **changes})


def test_a_mask_cannot_be_changed_afterwards() -> None:
    mask = np.ones((4, 5), bool)
    held = Detection("cup", BOX, 1, mask)
    mask[:] = False
    assert held.mask is not None
    assert held.mask.all()
    with pytest.raises(ValueError, match="read-only"):
        held.mask[0, 0] = False


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("size", [(1, 1), (7, 3), (40, 30)])
def test_masks_come_back_from_their_runs(share: float, size: tuple[int, int]) -> None:
    mask = np.random.default_rng(3).random((size[1], size[0])) < share
    assert np.array_equal(mask_from_runs(mask_to_runs(mask), size), mask)


def test_runs_are_cocos() -> None:
    """Down the columns, pixels outside first (pycocotools: `counts` of an uncompressed mask)."""
    mask = np.array([[False, True], [False, True], [True, False]])
    assert mask_to_runs(mask) == [2, 3, 1]
    assert mask_to_runs(~mask) == [0, 2, 3, 1]


@pytest.mark.parametrize("runs", [[2, 3], [7, -1], [6, 1]])
def test_runs_that_do_not_fill_the_picture_are_refused(runs: list[int]) -> None:
    with pytest.raises(ValueError, match="do not fill a picture of 2 x 3 px"):
        mask_from_runs(runs, (2, 3))
