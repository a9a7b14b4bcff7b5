"""Frames and cuts: every picture pixel shows the view pixel that its frame names, padding is known, nothing is turned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.images.scenes import crop_pair, view
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import BoxMark, LineMark, Picture
from wonderful_team.core.values import View
from wonderful_team.core.values.later_picture import LaterPicture
from wonderful_team.images import across_edge, beside_points, crop, edge_strips, inside_points, picture_of, whole

SIZES = st.tuples(st.integers(20, 260), st.integers(20, 260))


def coordinates(width: int, height: int) -> View:
    """A view whose colours say where each pixel is (blocks of 8, so that enlarging keeps flat middles)."""
    rgb = np.zeros((height, width, 3), np.uint8)
    rgb[..., 0] = (np.arange(width) // 8 * 7 % 256)[None, :]
    rgb[..., 1] = (np.arange(height) // 8 * 7 % 256)[:, None]
    depth = 1 + np.arange(width * height, dtype=np.float32).reshape(height, width) / (width * height)
    return View("v", "top", 0.0, rgb, depth)


def assert_shows_the_view(picture: Picture, source: View) -> None:
    """At the middle of every picture pixel, colour and depth are those of the view pixel that the frame names."""
    width, height = picture.size_px
    xs, ys = np.meshgrid(np.arange(0, width, 7) + 0.5, np.arange(0, height, 5) + 0.5)
    at = np.column_stack([xs.ravel(), ys.ravel()])
    seen = picture.frame.to_view(at)
    valid = picture.frame.valid
    real = np.array([valid.contains((x, y)) for x, y in at])
    columns, rows = np.floor(seen - 1e-9).astype(int).T
    picked = (np.floor(at[:, 1]).astype(int), np.floor(at[:, 0]).astype(int))
    assert picture.depth_m is not None
    assert source.depth_m is not None
    assert np.isnan(picture.depth_m[picked][~real]).all()
    if picture.frame.scale >= 1:
        assert np.array_equal(picture.depth_m[picked][real], source.depth_m[rows[real], columns[real]])
        flat = real & (columns % 8 > 1) & (columns % 8 < 6) & (rows % 8 > 1) & (rows % 8 < 6)
        assert np.array_equal(picture.rgb[picked][flat], source.rgb[rows[flat], columns[flat]])


@settings(max_examples=40, deadline=None, derandomize=True)
@given(size=SIZES, low=st.integers(10, 200), span=st.integers(1, 4))
def test_whole_views_keep_exact_frames(size: tuple[int, int], low: int, span: int) -> None:
    source = coordinates(*size)
    picture = whole(source, "top", min_side_px=low, max_side_px=max(low * span, 60))
    assert max(picture.size_px) <= max(low * span, 60)
    assert picture.frame.valid == picture.frame.whole_box
    assert_shows_the_view(picture, source)
    assert picture.frame.box_to_view(picture.frame.whole_box).as_tuple == pytest.approx((0, 0, *size))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    size=SIZES,
    corner=st.tuples(st.floats(-0.2, 0.95), st.floats(-0.2, 0.95)),
    sides=st.tuples(st.floats(0.06, 1.2), st.floats(0.06, 1.2)),
    margin=st.floats(0, 1.5),
)
def test_crops_keep_exact_frames_even_past_the_edge(
    size: tuple[int, int], corner: tuple[float, float], sides: tuple[float, float], margin: float
) -> None:
    source = coordinates(*size)
    x0, y0 = corner[0] * size[0], corner[1] * size[1]
    box = Box(x0, y0, x0 + sides[0] * size[0], y0 + sides[1] * size[1])
    if box.intersection(Box(0, 0, *size)) is None:
        return
    picture = crop(source, box, "crop", margin=margin, min_side_px=120, max_side_px=500)
    assert_shows_the_view(picture, source)
    shown = picture.frame.box_to_picture(box)
    assert picture.frame.whole_box.grown(1e-6, 1e-6, 1e-6, 1e-6).intersection(shown).as_tuple == pytest.approx(  # type: ignore[union-attr]
        shown.as_tuple, abs=1e-6
    )
    back = picture.frame.box_to_view(shown)
    assert back.as_tuple == pytest.approx(box.as_tuple, abs=1e-6)
    assert max(picture.size_px) <= 500


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    corner=st.tuples(st.floats(-30, 230), st.floats(-30, 110)), sides=st.tuples(st.floats(2, 120), st.floats(2, 120))
)
def test_strips_lie_along_their_edges_the_right_way_up(corner: tuple[float, float], sides: tuple[float, float]) -> None:
    source = coordinates(256, 128)
    box = Box(*corner, corner[0] + sides[0], corner[1] + sides[1])
    for (edge, side), picture in edge_strips(source, box).items():
        assert_shows_the_view(picture, source)
        matrix = picture.frame.T_view_picture
        assert matrix[0, 0] == pytest.approx(matrix[1, 1])
        assert matrix[0, 0] > 0  # neither turned nor mirrored
        (line,) = picture.marks
        assert isinstance(line, LineMark)
        ends = [picture.frame.point_to_view(point) for point in (line.start, line.end)]
        across, value = (
            (0, {"left": box.x0, "right": box.x1})
            if edge in ("left", "right")
            else (1, {"top": box.y0, "bottom": box.y1})
        )
        assert [point[across] for point in ends] == pytest.approx([value[edge]] * 2)
        middle = picture.frame.point_to_view((picture.size_px[0] / 2, picture.size_px[1] / 2))[across]
        inwards = 1 if edge in ("left", "top") else -1
        assert (middle - value[edge]) * inwards * (1 if side == "inside" else -1) > -0.5


@settings(max_examples=40, deadline=None, derandomize=True)
@given(size=SIZES, where=st.tuples(*[st.floats(0.02, 0.98)] * 4))
def test_the_strips_of_an_edge_are_joined_where_both_lie_in_the_view(
    size: tuple[int, int], where: tuple[float, float, float, float]
) -> None:
    source = coordinates(*size)
    (x0, x1), (y0, y1) = (sorted(pair) for pair in (where[:2], where[2:]))
    box = Box(x0 * size[0], y0 * size[1], max(x1 * size[0], x0 * size[0] + 3), max(y1 * size[1], y0 * size[1] + 3))
    strips = edge_strips(source, box)
    for edge in ("left", "top", "right", "bottom"):
        inside, outside = strips.get((edge, "inside")), strips.get((edge, "outside"))
        if inside is None or outside is None:
            continue
        both = across_edge(inside, outside, "both")
        assert both is not None, "both sides are cut in one scale"
        assert len(both.marks) == 1
        assert isinstance(both, LaterPicture), "nothing is cut out that nobody looks at"
        assert not any(part.made for part in (both, inside, outside))  # type: ignore[attr-defined]
        assert_shows_the_view(both, source)
        assert both.frame.box_to_view(both.frame.valid).as_tuple == pytest.approx(
            Box.bounding(
                [c for part in (inside, outside) for c in part.frame.box_to_view(part.frame.valid).corners]
            ).as_tuple
        )
        middle = both.frame.point_to_view(both.marks[0].start)  # type: ignore[union-attr]
        assert middle == pytest.approx(inside.frame.point_to_view(inside.marks[0].start))  # type: ignore[union-attr]


def test_vimabench_views_are_enlarged_four_times_and_photos_shrunk() -> None:
    assert whole(view(256, 128), "top").size_px == (1024, 512)
    assert whole(view(640, 480), "top").size_px == (640, 480)
    assert whole(view(640, 320), "top").size_px == (640, 320)
    huge = whole(view(4000, 3000, depth=True), "photo")
    assert huge.size_px == (1568, 1176)
    assert huge.frame.point_to_view((1568, 1176)) == pytest.approx((4000, 3000))


def test_enlarging_adds_no_false_edges() -> None:
    rgb = np.full((40, 60, 3), 60, np.uint8)
    rgb[:, 30:] = 190
    picture = whole(View("v", "top", 0.0, rgb), "top", min_side_px=400)
    assert picture.rgb.min() == 60
    assert picture.rgb.max() == 190
    edge = picture.frame.point_to_picture((30.0, 20.0))[0]
    dark = np.flatnonzero(picture.rgb[200, :, 0] < 125)
    assert dark[-1] + 1 == pytest.approx(edge, abs=1)


def test_padding_is_striped_grey_and_outside_valid() -> None:
    picture = crop(view(), Box(600, 300, 640, 380), "crop")
    valid = picture.frame.valid
    assert valid.x1 < picture.size_px[0]
    padding = picture.rgb[:, round(valid.x1) :]
    assert len(np.unique(padding.reshape(-1, 3), axis=0)) == 2
    assert (padding.max(axis=2) == padding.min(axis=2)).all()
    assert picture.frame.point_to_view((valid.x1, 0))[0] == pytest.approx(640)


def test_pairs_share_one_window_that_shows_both_boxes() -> None:
    before, after = Box(100, 100, 160, 150), Box(150, 120, 260, 190)
    pair = crop_pair(view(), before, after)
    assert pair[0].hash == pair[1].hash
    assert np.array_equal(pair[0].frame.T_view_picture, pair[1].frame.T_view_picture)
    for picture, box, style in zip(pair, (before, after), ("before", "after"), strict=True):
        (mark,) = picture.marks
        assert isinstance(mark, BoxMark)
        assert mark.style == style
        assert picture.frame.box_to_view(mark.box).as_tuple == pytest.approx(box.as_tuple)
        assert picture.frame.whole_box.intersection(mark.box) == mark.box


def test_strips_outside_the_view_are_left_out() -> None:
    strips = edge_strips(view(256, 128), Box(0, 0, 40, 30))
    assert {key for key in strips if key[1] == "outside"} == {("right", "outside"), ("bottom", "outside")}
    assert len(strips) == 6
    assert len(edge_strips(view(), Box(100, 100, 200, 180))) == 8


def test_strips_are_large_enough_to_look_at() -> None:
    for picture in edge_strips(view(256, 128), Box(100, 60, 112, 70)).values():
        assert min(picture.size_px) >= 60
        assert max(picture.size_px) >= 200


def test_a_box_outside_the_view_is_refused() -> None:
    with pytest.raises(ValueError, match=r"lies outside view 'top' of \(640, 480\) px"):
        crop(view(), Box(700, 10, 720, 20), "crop")


def test_nothing_changes_its_inputs() -> None:
    source = view(depth=True)
    before = source.rgb.copy()
    whole(source, "top")
    crop(source, Box(600, 300, 640, 380), "crop")
    edge_strips(source, Box(10, 10, 50, 60))
    assert np.array_equal(source.rgb, before)


def test_inside_points_are_cell_centres_row_by_row() -> None:
    assert inside_points(Box(0, 0, 30, 20), 3, 2) == ((5, 5), (15, 5), (25, 5), (5, 15), (15, 15), (25, 15))
    with pytest.raises(ValueError, match="at least 1"):
        inside_points(Box(0, 0, 1, 1), 0, 2)


def test_beside_points_stand_off_by_the_distance_clockwise_from_above() -> None:
    points = beside_points(Box(10, 10, 20, 30), 5)
    assert points == ((15, 5), (25, 5), (25, 20), (25, 35), (15, 35), (5, 35), (5, 20), (5, 5))


def test_turned_frames_are_refused() -> None:
    turned = Frame("v", np.array([[0, 1.0, 0], [1.0, 0, 0], [0, 0, 1]]), (20, 20), Box(0, 0, 20, 20))
    with pytest.raises(ValueError, match="upright"):
        picture_of(view(), turned, "strip")
