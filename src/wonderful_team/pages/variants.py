"""Pictures that differ from another one in a few places, such as one view with other marks: a page holds those places alone."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import Kept

BLOCK_PX = 16
"""Places are made of JPEG's blocks: coded alone they come out as they do in the whole picture."""
MOST_SHARE = 0.4
"""Of a picture: beyond that it is coded whole."""
GOOD_SHARE = 0.1
"""With a base that differs in so little, no other one is looked for."""
MOST_PATCHES = 24
_NEAR = np.ones((9, 9), np.uint8)
"""Places within so many blocks of each other become one, where they would be too many."""
_FILLED = 0.5
_RIM_PX = 2
"""Kept round what differs, so that its edge is smooth at any scale."""
MOST_BASES = 6
"""So many pictures of one size are compared with."""
MOST_BYTES = 48_000_000
"""Of the pictures that are compared with, of all sizes: those whose size came up last."""

Patch = tuple[int, int, int, int]
"""x0, y0, x1, y1 [px]."""


class Bases:
    """Pictures so far that others may be variants of."""

    def __init__(self) -> None:
        self._numbers: dict[tuple[int, ...], list[int]] = {}
        self._held: Kept[tuple[tuple[int, ...], int], Array] = Kept(
            MOST_BYTES, lambda rgb: rgb.nbytes, lambda key, _: self._numbers[key[0]].remove(key[1])
        )

    def place(self, number: int, rgb: Array) -> tuple[int, tuple[Patch, ...]] | None:
        """The picture that this one is a variant of, and where they differ; None when it has to be held whole."""
        known = self._numbers.setdefault(rgb.shape, [])
        best: tuple[int, tuple[Patch, ...]] | None = None
        # The newest first: one question after the other shows the same, with one more mark.
        for base in reversed(known):
            other = self._held.get((rgb.shape, base))
            places = None if other is None else patches(rgb, other)
            if places is not None and (best is None or _area(places) < _area(best[1])):
                best = base, places
                if _area(places) < GOOD_SHARE * rgb.shape[0] * rgb.shape[1]:
                    return best
        # What takes some room itself may be the base of others.
        if len(known) < MOST_BASES:
            known.append(number)
            self._held.keep((rgb.shape, number), rgb)
        return best


def _area(places: Sequence[Patch]) -> int:
    return sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in places)


def patches(rgb: Array, base: Array) -> tuple[Patch, ...] | None:
    """Where two pictures of one size, shape (H, W, 3), differ; None when that is too much, or in too many places."""
    height, width = rgb.shape[:2]
    if (rgb[::BLOCK_PX, ::BLOCK_PX] != base[::BLOCK_PX, ::BLOCK_PX]).any(axis=2).mean() > MOST_SHARE:
        return None
    rows, columns = -(-height // BLOCK_PX), -(-width // BLOCK_PX)
    differs = np.zeros((rows * BLOCK_PX, columns * BLOCK_PX * 3), dtype=bool)
    np.not_equal(rgb.reshape(height, -1), base.reshape(height, -1), out=differs[:height, : 3 * width])
    in_rows = _blocks(differs, BLOCK_PX, _RIM_PX)
    cells = _blocks(in_rows.T.copy(), 3 * BLOCK_PX, 3 * _RIM_PX).T
    if cells.mean() > MOST_SHARE:
        return None
    found = _places(cells.astype(np.uint8))
    if len(found) > MOST_PATCHES:
        # The ticks along an edge are one place.
        found = _places(cv2.morphologyEx(cells.astype(np.uint8), cv2.MORPH_CLOSE, _NEAR))
        if len(found) > MOST_PATCHES or _area(found) > MOST_SHARE * rows * columns:
            return None
    scaled = [(x0 * BLOCK_PX, y0 * BLOCK_PX, x1 * BLOCK_PX, y1 * BLOCK_PX) for x0, y0, x1, y1 in found]
    return tuple((x0, y0, min(x1, width), min(y1, height)) for x0, y0, x1, y1 in scaled)


def _places(cells: Array) -> list[Patch]:
    """Rectangles that cover all that is set, shape (rows, columns), uint8."""
    count, labels = cv2.connectedComponents(cells, connectivity=8)
    return [place for label in range(1, count) for place in _covering(labels == label)]


def _blocks(differs: Array, size: int, rim: int) -> Array:
    """Along the first axis, blocks that hold a difference or have one within the rim, shape (N / size, M)."""
    parts = differs.reshape(-1, size, differs.shape[1])
    found: Array = np.asarray(parts.any(axis=1))
    found[:-1] |= parts[1:, :rim].any(axis=1)
    found[1:] |= parts[:-1, -rim:].any(axis=1)
    return found


def _covering(cells: Array) -> list[Patch]:
    """Rectangles that cover connected cells: one round them, or the strips that a hollow frame is made of."""
    ys, xs = np.nonzero(cells)
    x0, y0, x1, y1 = int(xs.min()), int(ys.min()), int(xs.max()) + 1, int(ys.max()) + 1
    if len(xs) >= _FILLED * (x1 - x0) * (y1 - y0):
        return [(x0, y0, x1, y1)]
    done: list[Patch] = []
    growing: dict[tuple[int, int], int] = {}
    for y in range(y0, y1 + 1):
        row = cells[y, x0:x1] if y < y1 else np.zeros(x1 - x0, dtype=bool)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], row.astype(int), [0]]))) + x0
        runs = {(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)}
        done += [(a, start, b, y) for (a, b), start in growing.items() if (a, b) not in runs]
        growing = {run: growing.get(run, y) for run in runs}
    return done
