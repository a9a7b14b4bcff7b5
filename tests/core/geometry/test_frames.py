"""Frames: pixels of a picture that was sent and pixels of the view it was cut from, there and back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wonderful_team.core.geometry import Box, Frame

HURRY = settings(max_examples=100, derandomize=True, deadline=None, database=None)
VIEW = (640, 480)
SIZES = st.tuples(st.integers(1, 1024), st.integers(1, 1024))
POINTS = st.lists(st.tuples(st.floats(-50, 700), st.floats(-50, 700)), min_size=1, max_size=5)


@st.composite
def windows(draw: st.DrawFn) -> Box:
    """A part of the view that may reach beyond its edges, and shares at least a pixel with it."""
    x0, y0 = draw(st.floats(-200, VIEW[0] - 1)), draw(st.floats(-200, VIEW[1] - 1))
    x1, y1 = draw(st.floats(max(x0, 0) + 1, VIEW[0] + 200)), draw(st.floats(max(y0, 0) + 1, VIEW[1] + 200))
    return Box(x0, y0, x1, y1)


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    if draw(st.booleans()):
        return Frame.whole("top", VIEW, draw(st.floats(0.01, 8)))
    return Frame.window("top", VIEW, draw(windows()), draw(SIZES))


@HURRY
@given(frame=frames(), points=POINTS)
def test_there_and_back_is_the_same_point(frame: Frame, points: list[tuple[float, float]]) -> None:
    assert frame.to_picture(frame.to_view(points)) == pytest.approx(np.array(points), abs=1e-6)
    assert frame.to_view(frame.to_picture(points)) == pytest.approx(np.array(points), abs=1e-6)
    assert frame.point_to_view(frame.point_to_picture(points[0])) == pytest.approx(points[0], abs=1e-6)


@HURRY
@given(frame=frames())
def test_a_box_goes_there_and_back_and_keeps_its_direction(frame: Frame) -> None:
    whole = frame.whole_box
    there = frame.box_to_view(whole)
    assert frame.box_to_picture(there).as_tuple == pytest.approx(whole.as_tuple, abs=1e-6)
    # Never flipped, never mirrored: the top left corner stays the top left corner.
    assert frame.point_to_view((0.0, 0.0)) == pytest.approx((there.x0, there.y0), abs=1e-6)


@HURRY
@given(window=windows(), size=SIZES)
def test_a_window_shows_what_it_names_and_knows_where_the_view_ends(window: Box, size: tuple[int, int]) -> None:
    frame = Frame.window("top", VIEW, window, size)
    assert frame.box_to_view(frame.whole_box).as_tuple == pytest.approx(window.as_tuple, abs=1e-6)
    seen = window.intersection(Box(0, 0, *VIEW))
    assert seen is not None
    assert frame.box_to_view(frame.valid).as_tuple == pytest.approx(seen.as_tuple, abs=1e-6)
    assert frame.scale**2 == pytest.approx(size[0] * size[1] / window.area)


@HURRY
@given(outer=windows(), size=SIZES, inner=SIZES, point=st.tuples(st.floats(0, 1), st.floats(0, 1)))
def test_a_crop_of_a_crop_is_a_crop_of_the_view(
    outer: Box, size: tuple[int, int], inner: tuple[int, int], point: tuple[float, float]
) -> None:
    """Maps one after the other are one map: a picture cut from a picture names the same view pixels."""
    first = Frame.window("top", VIEW, outer, size)
    middle = Box(size[0] * 0.25, size[1] * 0.25, size[0] * 0.75, size[1] * 0.75)
    second = Frame.window("crop", size, middle, inner)
    at = (point[0] * inner[0], point[1] * inner[1])
    composed = first.T_view_picture @ second.T_view_picture
    assert first.to_view(second.to_view(at))[0] == pytest.approx((composed @ (*at, 1.0))[:2], abs=1e-6)
    if first.box_to_view(middle).intersection(Box(0, 0, *VIEW)) is not None:
        direct = Frame.window("top", VIEW, first.box_to_view(middle), inner)
        assert direct.T_view_picture == pytest.approx(composed, abs=1e-6)


@pytest.mark.parametrize("zoom", [0.001, 0.1, 1.0, 2.5])
def test_a_whole_view_has_a_picture_at_every_zoom(zoom: float) -> None:
    frame = Frame.whole("top", VIEW, zoom)
    assert frame.box_to_view(frame.whole_box).as_tuple == pytest.approx((0, 0, *VIEW))


@pytest.mark.parametrize(
    ("matrix", "size", "says"),
    [
        (np.zeros((3, 3)), (4, 4), "last row must be"),
        (np.diag([1.0, 0.0, 1.0]), (4, 4), "cannot be inverted"),
        (np.diag([1.0, np.nan, 1.0]), (4, 4), "finite"),
        (np.eye(4), (4, 4), r"expected shape \(3, 3\)"),
        (np.eye(3), (0, 4), "at least 1"),
    ],
)
def test_a_map_that_is_none_is_refused(matrix: np.ndarray, size: tuple[int, int], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Frame("top", matrix, size, Box(0, 0, 4, 4))


def test_a_window_beside_the_view_is_refused() -> None:
    with pytest.raises(ValueError, match=r"lies outside the view of \(640, 480\) px"):
        Frame.window("top", VIEW, Box(640, 0, 700, 10), (60, 10))
