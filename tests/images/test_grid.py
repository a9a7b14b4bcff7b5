"""A grid of tiles, and points of two things: drawn so that the picture stays seen, and the same in another size."""

from __future__ import annotations

import numpy as np

from wonderful_team.agents.rendering import mark_words
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Candidates, Grid, Picture
from wonderful_team.images import draw
from wonderful_team.models.wire.showing import scaled


def plain(*marks: Grid | Candidates) -> Picture:
    return Picture("top", np.full((400, 800, 3), 128, np.uint8), Frame.whole("top", (800, 400)), marks=marks)


def test_lines_and_names_stand_at_the_edges_of_tiles_and_leave_their_middles_alone() -> None:
    grid = Grid(5, 5)
    changed = (draw(plain(grid)) != 128).any(axis=-1)
    assert changed.mean() < 0.12
    for name in grid.names:
        tile = grid.tile(name, (800, 400))
        middle = np.s_[int(tile.y0) + 30 : int(tile.y1) - 4, int(tile.x0) + 45 : int(tile.x1) - 4]
        assert not changed[middle].any(), name
        # Its name, in the upper left corner.
        assert changed[int(tile.y0) + 3 : int(tile.y0) + 20, int(tile.x0) + 3 : int(tile.x0) + 30].mean() > 0.5, name


def test_points_of_two_things_are_told_apart_by_letter_and_colour() -> None:
    held, other = Candidates(((200.0, 200.0),), "P"), Candidates(((600.0, 200.0), (640.0, 300.0)), "Q")
    drawn = draw(plain(held, other))
    assert tuple(drawn[200, 200]) != tuple(drawn[200, 600])
    assert [mark_words(mark) for mark in (held, other, Candidates(((1.0, 1.0), (2.0, 2.0))))] == [
        "one point P1",
        "points Q1 to Q2",
        "points numbered 1 to 2",
    ]


def test_in_another_size_letters_and_tiles_stay() -> None:
    half = scaled(plain(Grid(5, 4), Candidates(((200.0, 100.0),), "P")), (400, 200))
    assert half.mark(Candidates) == [Candidates(((100.0, 50.0),), "P")]
    assert half.mark(Grid) == [Grid(5, 4)]
