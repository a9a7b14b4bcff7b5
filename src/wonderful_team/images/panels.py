"""Several pictures side by side in one, each group under its name: things from several cameras, before and after."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from wonderful_team.core.geometry import Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import Kept
from wonderful_team.core.pictures import Panel, Picture, checked_rgb
from wonderful_team.core.values import LaterPicture, Pixels
from wonderful_team.images.canvas import INK, WHITE, Canvas
from wonderful_team.images.lettering import plain

Group: TypeAlias = tuple[str, tuple[Picture, ...]]
"""A name and the pictures that stand above it."""

GAP_PX, APART_PX = 8, 28
"""Between two pictures of a group, and between two groups."""
NAME_PX = 16
MOST_ACROSS_PX, MOST_DOWN_PX = 1280, 768
"""Several groups make no picture larger than this: families that tile pictures shrink those with a longer short side."""
_STRIP_PX = 28
_GREY = 205
"""Of the gaps, and of what is left below a lower picture."""


def fit(groups: tuple[Group, ...]) -> bool:
    """Whether `side_by_side` puts these groups into a picture that no common model shrinks."""
    width, height = _size_px(_rows(groups))
    return width <= MOST_ACROSS_PX and height <= MOST_DOWN_PX


_MOST_BYTES = 48_000_000
_kept: Kept[tuple[tuple[Group, ...], str], Picture] = Kept(
    _MOST_BYTES,
    lambda made: sum(3 * math.prod(one.size_px) for one in (made, *(panel.picture for panel in made.panels))),
)


def side_by_side(groups: tuple[Group, ...], name: str) -> Picture:
    """One picture that holds these from left to right, row by row, tops in line, each group's name below it; drawn when it is looked at.

    What came from where stands in its `panels`; its frame is that of the first. The same picture for the same groups.

    Raises:
        ValueError: No pictures, or one with marks.
    """
    made = _kept.get((groups, name))
    return made if made is not None else _kept.keep((groups, name), _beside(groups, name))


def _beside(groups: tuple[Group, ...], name: str) -> Picture:
    pictures = [picture for _, held in groups for picture in held]
    if not pictures or any(picture.marks for picture in pictures):
        raise ValueError("side_by_side needs at least one picture, and none with marks")
    rows = _rows(groups)
    size = _size_px(rows)
    panels, names, top = list[Panel](), list[tuple[str, int, int]](), 0
    for row in rows:
        left, high = 0, _high_px(row)
        for group in row:
            x = left
            for picture in group[1]:
                panels.append(Panel(picture, (x, top)))
                x += picture.size_px[0] + GAP_PX
            names.append((plain(group[0]), left, top + high + 2))
            left += _cell_px(group) + APART_PX
        top += high + _STRIP_PX
    first = pictures[0].frame
    frame = Frame(first.view_id, first.T_view_picture, size, first.valid)
    return LaterPicture(name, frame, Pixels(lambda: (_drawn(size, panels, names), None)), panels=panels)


def _drawn(size: tuple[int, int], panels: list[Panel], names: list[tuple[str, int, int]]) -> Array:
    """The pixels, read-only: the panels, and each name with its left end and its top below its group."""
    canvas = Canvas.over(np.full((size[1], size[0], 3), _GREY, np.uint8))
    for panel in panels:
        (x, top), (across, down) = panel.origin_px, panel.picture.size_px
        canvas.rgb[top : top + down, x : x + across] = panel.picture.rgb
    for words, x, y in names:
        canvas.plate(words, x, y, colour=WHITE, back=INK, font_px=NAME_PX, alpha=1.0)
    return checked_rgb(canvas.rgb)


def _rows(groups: tuple[Group, ...]) -> list[list[Group]]:
    """The groups in rows that are no wider than they may be; at least one in each."""
    rows: list[list[Group]] = []
    for group in groups:
        if rows and _wide_px([*rows[-1], group]) <= MOST_ACROSS_PX:
            rows[-1].append(group)
        else:
            rows.append([group])
    return rows


def _size_px(rows: list[list[Group]]) -> tuple[int, int]:
    return max(map(_wide_px, rows)), sum(_high_px(row) + _STRIP_PX for row in rows)


def _wide_px(row: list[Group]) -> int:
    return sum(map(_cell_px, row)) + APART_PX * (len(row) - 1)


def _high_px(row: list[Group]) -> int:
    return max(picture.size_px[1] for _, held in row for picture in held)


def _cell_px(group: Group) -> int:
    name, pictures = group
    letters = Canvas.over(np.zeros((1, 1, 3), np.uint8)).plate_size(plain(name), NAME_PX)[0]
    return max(letters, sum(picture.size_px[0] for picture in pictures) + GAP_PX * (len(pictures) - 1))
