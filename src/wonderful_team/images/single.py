"""Single things cut out of pictures that show nothing else, and pairs of pictures cut to what differs between them.

A picture of one thing on an even background is mostly background: the thing alone, enlarged, is seen better and costs less.
Things that belong together are enlarged by one factor, so that their sizes can be compared.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import View
from wonderful_team.images.apart import apart
from wonderful_team.images.cut import whole
from wonderful_team.images.resample import picture_of, whole_pixels

LONG_SIDE_PX = 256
"""A cut-out's long side has at least about this many pixels."""
LARGEST_PX = 420
"""The common factor makes no cut-out larger than this."""
FACTOR_STEP = 0.25
"""The common factor is a multiple of this."""
SMALLER = 3.0
"""Things smaller than the largest one by more than this factor are enlarged by another factor than it, one for all of them."""
MARGIN, LEAST_MARGIN_PX = 0.12, 6
"""Background left round a thing: this share of its longer side, at least so many view pixels."""
MOST_SHARE = 0.7
"""A thing that fills more than this share of the picture's width and height is shown with the whole picture."""
EVEN_LEVELS = 6.0
"""The background is even when 98 % of the picture's border lie this near to its median (0 to 255)."""
_BORDER_PX = 2


def thing_window(view: View) -> Box | None:
    """The window round the one thing that stands on an even background [view px]; None when the background is not even."""
    rgb = view.rgb
    edges = (rgb[:_BORDER_PX], rgb[-_BORDER_PX:], rgb[:, :_BORDER_PX], rgb[:, -_BORDER_PX:])
    border = np.concatenate([part.reshape(-1, 3) for part in edges]).astype(np.int16)
    background = np.median(border, axis=0)
    uneven = float(np.percentile(np.abs(border - background).max(axis=1), 98))
    if uneven > EVEN_LEVELS:
        return None
    stands_out = apart(rgb, background, max(2.0, 3.0 * uneven))
    if uneven > 1.0:
        stands_out = cv2.morphologyEx(stands_out.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) > 0
    return _window(stands_out, view.size_px)


def changed_window(before: View, after: View) -> Box | None:
    """The window round what differs between two pictures of one camera [view px]; None when nothing or most of it does."""
    if before.size_px != after.size_px:
        return None
    differs = apart(before.rgb, after.rgb, 4 * EVEN_LEVELS)
    tidy = cv2.morphologyEx(differs.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) > 0
    return _window(tidy, before.size_px)


def _window(shows: Array, size_px: tuple[int, int]) -> Box | None:
    rows, columns = np.flatnonzero(shows.any(axis=1)), np.flatnonzero(shows.any(axis=0))
    if not len(rows):
        return None
    box = Box(columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)
    if box.width > MOST_SHARE * size_px[0] and box.height > MOST_SHARE * size_px[1]:
        return None
    room = max(MARGIN * max(box.width, box.height), LEAST_MARGIN_PX)
    return whole_pixels(box.grown(room, room, room, room)).intersection(Box(0, 0, *size_px))


def cut_outs(shots: Sequence[Sequence[tuple[str, View]]]) -> list[tuple[Picture, ...]]:
    """Pictures of single things, cut out and enlarged: one factor for all of them where their sizes allow.

    Args:
        shots: For each thing its views with the pictures' names.

    Returns:
        For each thing its pictures; a view without an even background is shown whole.
    """
    windows = [[thing_window(view) for _, view in views] for views in shots]
    sides = [[max(box.width, box.height) for box in boxes if box is not None] for boxes in windows]
    longest = [max(found) for found in sides if found]
    small = [side for side in longest if SMALLER * side < max(longest)]
    large = [side for side in longest if side not in small]
    made = []
    for views, boxes, found in zip(shots, windows, sides, strict=True):
        zoom = _factor(small if found and max(found) in small else large)
        made.append(tuple(_cut(view, name, box, zoom) for (name, view), box in zip(views, boxes, strict=True)))
    return made


def _factor(sides: Sequence[float]) -> float:
    """One factor for things with these longer sides [view px]."""
    if not sides:
        return 1.0
    within = math.floor(LARGEST_PX / max(sides) / FACTOR_STEP) * FACTOR_STEP
    return float(max(1, min(math.ceil(LONG_SIDE_PX / min(sides)), within)))


def changed_pair(before: tuple[str, View], after: tuple[str, View]) -> tuple[Picture, Picture] | None:
    """The same window of two pictures, round what differs between them; None where `changed_window` finds none."""
    window = changed_window(before[1], after[1])
    if window is None:
        return None
    zoom = float(max(1, math.ceil(LONG_SIDE_PX / max(window.width, window.height))))
    first, second = (_cut(view, name, window, zoom) for name, view in (before, after))
    return first, second


def _cut(view: View, name: str, window: Box | None, zoom: float) -> Picture:
    if window is None:
        return whole(view, name)
    long = max(window.width, window.height)
    zoom = min(zoom, max(LARGEST_PX / long, 1.0)) if long <= LARGEST_PX else LARGEST_PX / long
    size = (max(1, round(window.width * zoom)), max(1, round(window.height * zoom)))
    return picture_of(view, Frame.window(view.id, view.size_px, window, size), name)
