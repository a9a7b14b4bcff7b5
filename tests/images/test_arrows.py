"""Arrows of steps: a colour for each, numbers where they start, and no two on each other."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point
from wonderful_team.images import draw
from wonderful_team.images.arrows import STEP_COLOURS, bows, step_colour
from wonderful_team.images.canvas import ORANGE

SIZE = (640, 320)
A, B, C = (100.0, 160.0), (500.0, 160.0), (300.0, 160.0)


def grey(*marks: PathMark | BoxMark) -> Array:
    return draw(Picture("p", np.full((SIZE[1], SIZE[0], 3), 150, np.uint8), Frame.whole("v", SIZE), marks=marks))


def middles(paths: list[tuple[Point, Point]]) -> list[Point]:
    return [way[len(way) // 2] for way in bows(paths, SIZE, [True] * len(paths))]


def test_there_and_back_collinear_and_repeated_arrows_part() -> None:
    for paths in ([(A, B), (B, A)], [(A, B), (C, B)], [(A, B), (A, B)], [(A, C), (C, B), (B, A)]):
        found = middles(paths)
        gaps = [math.dist(one, two) for k, one in enumerate(found) for two in found[:k]]
        assert min(gaps) > 15


def test_a_bow_keeps_its_ends_and_stays_in_the_picture() -> None:
    for start, end in (((20.0, 5.0), (600.0, 5.0)), ((600.0, 315.0), (20.0, 315.0)), (A, B)):
        (way,) = bows([(start, end)], SIZE, [True])
        assert way[0] == start
        assert way[-1] == end
        assert all(0 <= x <= SIZE[0] and 0 <= y <= SIZE[1] for x, y in way)


def test_a_path_that_is_followed_or_pushed_along_stays_as_it_is() -> None:
    assert bows([(A, B)], SIZE, [False]) == [[A, B]]
    assert bows([(A, C, B)], SIZE, [True]) == [[A, C, B]]


def test_each_step_has_its_colour_and_none_that_of_boxes() -> None:
    assert len(set(STEP_COLOURS)) == len(STEP_COLOURS)
    assert ORANGE not in STEP_COLOURS
    drawn = grey(
        PathMark((A, B), "1", bowed=True), PathMark((B, A), "2", bowed=True), PathMark((A, C), "3", bowed=True)
    )
    for number in (1, 2, 3):
        assert (drawn == step_colour(number)).all(axis=2).sum() > 100


def test_numbers_stand_where_steps_start_beside_the_things_box() -> None:
    box = Box(60, 120, 140, 200)
    plain, numbered = (grey(BoxMark(box), PathMark((A, B), label, bowed=True)) for label in ("", "1"))
    rows, columns = np.nonzero((plain != numbered).any(axis=2))
    plate = Box(columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
    assert math.dist(plate.centre, A) < math.dist(plate.centre, B)
    inside = (plain != numbered).any(axis=2)[int(box.y0) : int(box.y1), int(box.x0) : int(box.x1)]
    assert inside.mean() < 0.05  # no more than a leader line crosses the thing


def test_a_head_is_not_hidden_by_a_step_that_starts_there() -> None:
    alone, both = (
        grey(PathMark((A, C), "", bowed=True)),
        grey(PathMark((A, C), "", bowed=True), PathMark((C, B), "", bowed=True)),
    )
    head = np.s_[150:165, 284:300]
    colour = step_colour(1)
    assert (both[head] == colour).all(axis=2).sum() > 0.8 * (alone[head] == colour).all(axis=2).sum()
