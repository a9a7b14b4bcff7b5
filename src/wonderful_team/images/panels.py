"""Several pictures side by side in one, each group under its name: things from several cameras, before and after."""

from __future__ import annotations

from functools import lru_cache
from typing import TypeAlias

import numpy as np

from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Panel, Picture
from wonderful_team.images.canvas import INK, WHITE, Canvas
from wonderful_team.images.lettering import plain

Group: TypeAlias = tuple[str, tuple[Picture, ...]]
"""A name and the pictures that stand above it."""

GAP_PX, APART_PX = 8, 28
"""Between two pictures of a group, and between two groups."""
NAME_PX = 16
_STRIP_PX = 28
_GREY = 205
"""Of the gaps, and of what is left below a lower picture."""


def width_px(groups: tuple[Group, ...]) -> int:
    """How wide `side_by_side` makes a picture of these groups."""
    return sum(_cell_px(group) for group in groups) + APART_PX * (len(groups) - 1)


@lru_cache(maxsize=64)
def side_by_side(groups: tuple[Group, ...], name: str) -> Picture:
    """One picture that holds these from left to right, tops in line, each group's name below it.

    What came from where stands in its `panels`; its frame is that of the first. The same picture for the same groups.

    Raises:
        ValueError: No pictures, or one with marks.
    """
    pictures = [picture for _, held in groups for picture in held]
    if not pictures or any(picture.marks for picture in pictures):
        raise ValueError("side_by_side needs at least one picture, and none with marks")
    height = max(picture.size_px[1] for picture in pictures)
    size = (width_px(groups), height + _STRIP_PX)
    canvas = Canvas.over(np.full((size[1], size[0], 3), _GREY, np.uint8))
    panels, left = [], 0
    for group in groups:
        x = left
        for picture in group[1]:
            across, down = picture.size_px
            canvas.rgb[:down, x : x + across] = picture.rgb
            panels.append(Panel(picture, (x, 0)))
            x += across + GAP_PX
        canvas.plate(plain(group[0]), left, height + 2, colour=WHITE, back=INK, font_px=NAME_PX, alpha=1.0)
        left += _cell_px(group) + APART_PX
    first = pictures[0].frame
    frame = Frame(first.view_id, first.T_view_picture, size, first.valid)
    return Picture(name, canvas.rgb, frame, panels=tuple(panels))


def _cell_px(group: Group) -> int:
    name, pictures = group
    letters = Canvas.over(np.zeros((1, 1, 3), np.uint8)).plate_size(plain(name), NAME_PX)[0]
    return max(letters, sum(picture.size_px[0] for picture in pictures) + GAP_PX * (len(pictures) - 1))
