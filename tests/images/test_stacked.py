"""Whether heights matter in a picture of a table: something lies over what another picture shows in its place."""

from __future__ import annotations

import numpy as np

from wonderful_team.core.values import View
from wonderful_team.images.stacked import lies_over

RED, BLUE = (190, 40, 45), (40, 60, 170)
Thing = tuple[int, int, tuple[int, int, int]]


def table(*things: Thing, size: tuple[int, int] = (320, 160), side: int = 30) -> View:
    """Square things at their corners, later ones on top."""
    rgb = np.full((size[1], size[0], 3), (222, 219, 211), np.uint8)
    for x, y, colour in things:
        rgb[y : y + side, x : x + side] = colour
    return View("v", "top", 0.0, rgb)


def test_a_thing_put_on_another_lies_over_it() -> None:
    assert lies_over(table((40, 40, RED), (200, 60, BLUE)), table((40, 40, RED), (45, 45, BLUE)))


def test_what_moves_turns_swaps_or_stays_lies_over_nothing() -> None:
    start = table((40, 40, RED), (200, 60, BLUE))
    assert not lies_over(start, start)
    assert not lies_over(start, table((40, 40, RED), (120, 100, BLUE)))
    assert not lies_over(start, table((200, 60, RED), (40, 40, BLUE)))
    assert not lies_over(start, table((52, 44, RED), (200, 60, BLUE)))


def test_what_is_only_missing_lies_under_nothing() -> None:
    assert not lies_over(table((40, 40, RED), (200, 60, BLUE)), table((120, 100, RED)))


def test_pictures_that_cannot_be_compared_may_show_anything() -> None:
    assert lies_over(table(), table(size=(640, 320)))
