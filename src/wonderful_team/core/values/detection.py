"""What a detector finds in a picture: one thing, with its box, how sure it is, and where it has them its pixels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values.observation import View


@dataclass(frozen=True, eq=False)
class Detection:
    """One thing that was found; coordinates are pixels of the picture that was looked at.

    Attributes:
        words: Which of the words that were asked for it fits, exactly as they were asked.
        box: Round the thing [px].
        score: How sure the detector is, 0 to 1, on a scale of its own.
        mask: Its pixels, shape (H, W) of the picture, bool, read-only; None where the detector gives boxes alone.

    Raises:
        ValueError: Words that are empty, no box, a score outside of 0 to 1, or a mask that is not (H, W) bool or empty.
    """

    words: str
    box: Box
    score: float
    mask: Array | None = None

    def mask_in(self, size_px: tuple[int, int]) -> Array:
        """Its pixels in the picture of that width and height, shape (H, W), bool; all of its box where it has no mask."""
        if self.mask is not None:
            return self.mask
        width, height = size_px
        mask = np.zeros((height, width), bool)
        mask[int(self.box.y0) : math.ceil(self.box.y1), int(self.box.x0) : math.ceil(self.box.x1)] = True
        return mask

    def __post_init__(self) -> None:
        if not isinstance(self.words, str) or not self.words.strip():
            raise ValueError(f"words {self.words!r}: valid is the text that was asked for")
        if not isinstance(self.box, Box):
            raise ValueError(f"box {self.box!r}: valid is a wt.Box(x0, y0, x1, y1) [px]")
        score = float(self.score)
        if not (math.isfinite(score) and 0.0 <= score <= 1.0):
            raise ValueError(f"score {self.score!r} of {self.words!r}: valid is 0 to 1")
        object.__setattr__(self, "score", score)
        object.__setattr__(self, "mask", _checked_mask(self.mask, self.words))


def _checked_mask(mask: Array | None, words: str) -> Array | None:
    if mask is None:
        return None
    array = np.asarray(mask)
    if array.ndim != 2 or array.dtype != np.bool_ or not array.any():
        shows = ", without a pixel in it" if array.dtype == np.bool_ and not array.any() else ""
        raise ValueError(
            f"mask of {words!r}: expected a bool array of shape (H, W) with at least one pixel, "
            f"got {array.dtype} {array.shape}{shows}"
        )
    if array.flags.writeable:
        array = array.copy()
        array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class DetectorRun:
    """One look of a detector at a view, as it is told to subscribers.

    Attributes:
        detector: Its name, and what it says of itself: weights, thresholds, device.
        words: What was looked for.
        found: In the order of the words, the surest first; boxes in pixels of the view.
        seconds: How long it took [s].
        refused: Why it could not be asked for these words; "" where it looked.
        failed: How it broke; "" where it did not.
    """

    detector: Mapping[str, str]
    view: View
    words: tuple[str, ...]
    found: tuple[Detection, ...]
    seconds: float
    refused: str = ""
    failed: str = ""


def mask_to_runs(mask: Array) -> list[int]:
    """A mask as the lengths of its runs down its columns, pixels outside first: COCO's uncompressed run lengths."""
    flat = np.asarray(mask, dtype=np.uint8).ravel(order="F")
    ends = np.flatnonzero(np.diff(flat)) + 1
    runs = np.diff(np.concatenate([[0], ends, [flat.size]])).tolist()
    return [0, *runs] if flat.size and flat[0] else runs


def mask_from_runs(runs: list[int], size_px: tuple[int, int]) -> Array:
    """The mask of these runs, shape (H, W), bool.

    Args:
        runs: As `mask_to_runs` made them.
        size_px: Width and height of the picture.

    Raises:
        ValueError: The runs do not fill the picture.
    """
    width, height = size_px
    if any(run < 0 for run in runs) or sum(runs) != width * height:
        raise ValueError(f"runs of {sum(runs)} pixels do not fill a picture of {width} x {height} px")
    flat = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    return flat.reshape((height, width), order="F")
