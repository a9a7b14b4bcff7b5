"""Single things are cut out and enlarged, by one factor where their sizes allow; pairs are cut to what differs."""

from __future__ import annotations

import numpy as np
import pytest

from tests.images.scenes import view
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import View
from wonderful_team.images.single import LARGEST_PX, LONG_SIDE_PX, changed_pair, changed_window, cut_outs, thing_window


def on_white(box: Box, colour: tuple[int, int, int] = (190, 40, 45), size: tuple[int, int] = (640, 320)) -> View:
    rgb = np.full((size[1], size[0], 3), 255, np.uint8)
    x0, y0, x1, y1 = (int(value) for value in box.as_tuple)
    rgb[y0:y1, x0:x1] = colour
    return View("slot:thing:top", "top", 0.0, rgb)


@pytest.mark.parametrize("colour", [(190, 40, 45), (250, 250, 250), (0, 0, 0)])
def test_a_thing_is_cut_out_whole_with_a_small_margin_and_large(colour: tuple[int, int, int]) -> None:
    thing = Box(300, 100, 320, 140)
    ((picture,),) = cut_outs([[("{thing} top", on_white(thing, colour))]])
    assert max(picture.size_px) >= LONG_SIDE_PX
    shown = picture.frame.box_to_picture(thing)
    inner = picture.frame.whole_box
    assert inner.x0 < shown.x0 < shown.x1 < inner.x1
    assert inner.y0 < shown.y0 < shown.y1 < inner.y1
    assert max(shown.width / inner.width, shown.height / inner.height) > 0.6
    assert picture.frame.T_view_picture[0, 0] == pytest.approx(picture.frame.T_view_picture[1, 1])


def test_things_of_like_size_are_enlarged_alike_so_that_sizes_compare() -> None:
    small, large = on_white(Box(300, 100, 340, 140)), on_white(Box(300, 100, 380, 180))
    (one,), (other,) = cut_outs([[("a", small)], [("b", large)]])
    assert one.frame.scale == other.frame.scale
    assert max(other.size_px) <= LARGEST_PX


def test_a_short_thing_beside_long_ones_keeps_their_factor_and_tiny_ones_share_one() -> None:
    sides = (58, 116, 150, 12, 18)
    shown = cut_outs([[(str(side), on_white(Box(300, 100, 300 + side, 100 + side)))] for side in sides])
    scales = [pictures[0].frame.scale for pictures in shown]
    assert scales[0] == pytest.approx(scales[1], rel=0.01) == pytest.approx(scales[2], rel=0.01)
    assert scales[3] == scales[4] > scales[0]


def test_a_tiny_thing_beside_a_huge_one_is_enlarged_more() -> None:
    (tiny,), (huge,) = cut_outs([[("a", on_white(Box(300, 100, 308, 108)))], [("b", on_white(Box(100, 20, 400, 300)))]])
    assert tiny.frame.scale > huge.frame.scale
    assert max(tiny.size_px) >= LONG_SIDE_PX
    assert max(huge.size_px) <= LARGEST_PX


def test_a_photo_without_an_even_background_is_shown_whole() -> None:
    assert thing_window(view()) is None
    ((picture,),) = cut_outs([[("{photo} top", view())]])
    assert picture.frame.box_to_view(picture.frame.whole_box).as_tuple == pytest.approx((0, 0, 640, 480))


def test_a_noisy_even_background_is_still_even() -> None:
    noise = np.random.default_rng(0).normal(0, 1.0, (320, 640, 3))
    rgb = np.clip(on_white(Box(300, 100, 380, 180)).rgb - 20 + noise, 0, 255).astype(np.uint8)
    window = thing_window(View("v", "top", 0.0, rgb))
    assert window is not None
    assert window.iou(Box(300, 100, 380, 180)) > 0.5


def test_a_pair_is_cut_to_what_differs_and_not_where_most_does() -> None:
    before, after = on_white(Box(300, 100, 340, 140)), on_white(Box(320, 110, 360, 150))
    window = changed_window(before, after)
    assert window is not None
    assert window.x0 < 300
    assert window.x1 > 360
    pair = changed_pair(("a", before), ("b", after))
    assert pair is not None
    assert pair[0].size_px == pair[1].size_px
    assert changed_window(before, before) is None
    assert changed_window(on_white(Box(0, 0, 640, 320)), on_white(Box(0, 0, 1, 1))) is None
