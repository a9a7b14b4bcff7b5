"""Pictures as they are sent: lossless, in the size the model looks at, marks in place; or all on one sheet."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.models.wire.scenes import picture
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Candidates, LineMark, PathMark, PointMark
from wonderful_team.core.values import LaterPicture, View
from wonderful_team.images import whole
from wonderful_team.images.png import fast_png
from wonderful_team.models.conventions import CONVENTIONS
from wonderful_team.models.wire.showing import paste, scaled, show, show_encoded


@settings(deadline=None, max_examples=40)
@given(st.integers(1, 90), st.integers(1, 90), st.integers(0, 2**31), st.booleans())
def test_a_png_holds_exactly_the_pixels(width: int, height: int, seed: int, noisy: bool) -> None:
    rng = np.random.default_rng(seed)
    rgb = rng.integers(0, 256 if noisy else 2, (height, width, 3)).astype(np.uint8)
    read = cv2.imdecode(np.frombuffer(fast_png(rgb), np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(read[..., ::-1], rgb)


def test_claude_is_sent_what_it_looks_at_and_marks_move_along() -> None:
    large = picture((3136, 1600)).marked(
        BoxMark(Box(100, 200, 300, 400)),
        PointMark((50, 60)),
        Candidates(((10, 20),)),
        PathMark(((10, 20), (30, 40))),
        LineMark((0, 0), (100, 0)),
    )
    shown = show(large, CONVENTIONS["claude"])
    assert shown.picture.size_px == CONVENTIONS["claude"].seen_size((3136, 1600))
    sx, sy = shown.scale
    box, point, candidates, path, line = shown.picture.marks
    assert isinstance(box, BoxMark)
    assert box.box.as_tuple == pytest.approx((100 * sx, 200 * sy, 300 * sx, 400 * sy))
    assert isinstance(point, PointMark)
    assert point.point == pytest.approx((50 * sx, 60 * sy))
    assert isinstance(candidates, Candidates)
    assert candidates.points[0] == pytest.approx((10 * sx, 20 * sy))
    assert isinstance(path, PathMark)
    assert path.points[1] == pytest.approx((30 * sx, 40 * sy))
    assert isinstance(line, LineMark)
    assert line.end == pytest.approx((100 * sx, 0))
    assert shown.to_ours(np.array([[sx * 7, sy * 9]]))[0] == pytest.approx((7, 9))


def test_a_scaled_picture_still_knows_its_place_in_the_view() -> None:
    small = scaled(picture((640, 480)), (320, 120))
    assert small.frame.point_to_view((160, 60)) == pytest.approx((320, 240))


def test_an_enlarged_view_is_sent_straight_from_its_own_pixels() -> None:
    rgb = cv2.GaussianBlur(np.random.default_rng(0).integers(0, 255, (480, 640, 3), dtype=np.uint8), (0, 0), 3)
    enlarged = whole(View("top", "top", 0.0, rgb), "top view", long_side_px=1200, marks=(PointMark((1000, 600)),))
    assert enlarged.size_px == (1280, 960)
    shown = scaled(enlarged, (1024, 768))
    assert isinstance(enlarged, LaterPicture)
    assert not enlarged.made
    assert shown.marks == (PointMark((800, 480)),)
    assert shown.frame.point_to_view((800, 480)) == pytest.approx((500, 300))
    apart = np.abs(shown.rgb.astype(int) - cv2.resize(enlarged.rgb, (1024, 768), interpolation=cv2.INTER_AREA))
    assert apart.mean() < 1
    assert apart.max() <= 6


def test_small_pictures_are_sent_as_they_are() -> None:
    view = picture((640, 480))
    assert np.array_equal(show(view, CONVENTIONS["claude"]).rgb, view.rgb)


@settings(deadline=None, max_examples=25)
@given(
    st.lists(st.tuples(st.integers(20, 900), st.integers(20, 700)), min_size=1, max_size=6),
    st.sampled_from(["gpt", "gemini", "claude", "qwen2.5-vl"]),
)
def test_every_picture_lies_whole_on_the_sheet_and_apart_from_the_others(
    sizes: list[tuple[int, int]], name: str
) -> None:
    pictures = [picture(size, f"p{number}") for number, size in enumerate(sizes)]
    sheet, shown = paste(pictures, CONVENTIONS[name])
    taken = np.zeros(sheet.shape[:2], int)
    for item, original in zip(shown, pictures, strict=True):
        (x0, y0), (width, height) = (round(v) for v in item.origin_px), item.picture.size_px
        assert x0 + width <= sheet.shape[1]
        assert y0 + height <= sheet.shape[0]
        assert np.array_equal(sheet[y0 : y0 + height, x0 : x0 + width], item.rgb)
        taken[y0 : y0 + height, x0 : x0 + width] += 1
        assert item.to_ours(np.array([(x0 + width, y0 + height)]))[0] == pytest.approx(original.size_px)
    assert taken.max() == 1


def test_the_same_picture_is_drawn_and_encoded_once() -> None:
    view = picture((200, 100))
    assert show_encoded(view)[1] is show_encoded(view)[1]
