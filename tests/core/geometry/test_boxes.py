"""Boxes: what two share, what holds points, and how edges move. Edges are real numbers, x right and y down."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wonderful_team.core.geometry import Box

HURRY = settings(max_examples=100, derandomize=True, deadline=None, database=None)
EDGES = st.integers(-400, 400).map(lambda number: number / 4)
"""Quarters of a pixel: their sums and differences are exact, so that equality may be asked for."""
POINTS = st.tuples(EDGES, EDGES)


@st.composite
def boxes(draw: st.DrawFn) -> Box:
    x0, y0 = draw(POINTS)
    return Box(x0, y0, x0 + draw(st.integers(1, 400)) / 4, y0 + draw(st.integers(1, 400)) / 4)


@HURRY
@given(a=boxes(), b=boxes(), point=POINTS)
def test_what_two_boxes_share_is_what_lies_in_both(a: Box, b: Box, point: tuple[float, float]) -> None:
    shared = a.intersection(b)
    assert shared == b.intersection(a)
    if shared is None:
        # At most an edge or a corner is shared.
        assert a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0
    else:
        assert shared.contains(point) == (a.contains(point) and b.contains(point))
        assert shared.intersection(a) == shared.intersection(b) == shared


@HURRY
@given(a=boxes(), b=boxes(), c=boxes())
def test_cutting_in_any_order_gives_the_same(a: Box, b: Box, c: Box) -> None:
    first, second = a.intersection(b), b.intersection(c)
    assert (first.intersection(c) if first else None) == (a.intersection(second) if second else None)


@HURRY
@given(a=boxes(), b=boxes())
def test_overlap_is_the_shared_part_of_the_whole(a: Box, b: Box) -> None:
    assert a.iou(a) == 1
    assert a.iou(b) == b.iou(a)
    assert 0 <= a.iou(b) <= 1
    assert (a.iou(b) == 0) == (a.intersection(b) is None)
    assert (a.iou(b) == 1) == (a == b)


@HURRY
@given(points=st.lists(POINTS, min_size=2, max_size=8))
def test_the_bounding_box_is_the_smallest_that_holds_every_point(points: list[tuple[float, float]]) -> None:
    xs, ys = zip(*points, strict=True)
    if min(xs) == max(xs) or min(ys) == max(ys):
        with pytest.raises(ValueError, match="x0 < x1 and y0 < y1"):
            Box.bounding(points)
        return
    box = Box.bounding(points)
    assert all(box.contains(point) for point in points)
    assert box.as_tuple == (min(xs), min(ys), max(xs), max(ys))
    assert Box.bounding(box.corners) == box


@HURRY
@given(box=boxes(), by=st.tuples(*[EDGES] * 4))
def test_grown_edges_go_back_where_they_came_from(box: Box, by: tuple[float, float, float, float]) -> None:
    assert box.shifted(by[0], by[1]).shifted(-by[0], -by[1]) == box
    if by[0] + by[2] > -box.width and by[1] + by[3] > -box.height:
        assert box.grown(*by).grown(*(-amount for amount in by)) == box
    else:
        with pytest.raises(ValueError, match="x0 < x1 and y0 < y1"):
            box.grown(*by)


@HURRY
@given(box=boxes(), factor=st.floats(0.1, 10))
def test_a_scaled_box_keeps_its_centre(box: Box, factor: float) -> None:
    scaled = box.scaled(factor)
    assert scaled.centre == pytest.approx(box.centre)
    assert (scaled.width, scaled.height) == pytest.approx((box.width * factor, box.height * factor))
    assert Box.around(box.centre, box.width, box.height).as_tuple == pytest.approx(box.as_tuple)


@pytest.mark.parametrize("edges", [(0, 0, 0, 1), (0, 1, 1, 1), (2, 0, 1, 1), (0, 2, 1, 1)])
def test_a_box_that_holds_nothing_is_refused(edges: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="x0 < x1 and y0 < y1"):
        Box(*edges)


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", range(4))
def test_an_edge_that_is_no_number_is_refused(number: float, place: int) -> None:
    edges = [0.0, 0.0, 1.0, 1.0]
    edges[place] = number
    with pytest.raises(ValueError, match="finite"):
        Box(*edges)
