"""Marks show on every ground and leave what they mark to be seen."""

from __future__ import annotations

import numpy as np
import pytest

from tests.images.scenes import view
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, BoxStyle, Candidates, Mark, Picture, RegionMark
from wonderful_team.images import crop, draw, inside_points, whole
from wonderful_team.images.canvas import BLUE, Colour
from wonderful_team.images.draw import BOX_COLOURS


def flat(colour: Colour, *marks: Mark, size: tuple[int, int] = (640, 320)) -> Picture:
    return Picture("p", np.full((size[1], size[0], 3), colour, np.uint8), Frame.whole("v", size), marks=marks)


def changed(picture: Picture) -> Array:
    return np.asarray((draw(picture) != picture.rgb).any(axis=2))


@pytest.mark.parametrize("style", ["target", "after"])
def test_a_box_shows_on_a_thing_of_its_own_colour(style: BoxStyle) -> None:
    ground = flat(BOX_COLOURS[style], BoxMark(Box(200, 100, 300, 200), style))
    drawn = draw(ground).astype(int)
    light = drawn.sum(axis=2)
    assert (light > 600).sum() > 300  # a light line
    assert (light < 200).sum() > 300  # and a dark one


def test_labels_of_boxes_keep_off_their_own_and_other_boxes() -> None:
    boxes = (Box(200, 100, 260, 160), Box(262, 100, 322, 160), Box(200, 36, 260, 98))
    plain = flat((150, 150, 150), *(BoxMark(box) for box in boxes))
    named = flat((150, 150, 150), *(BoxMark(box, "target", f"T{k} thing") for k, box in enumerate(boxes)))
    plates = (draw(plain) != draw(named)).any(axis=2)
    assert plates.sum() > 1000
    for box in boxes:
        inside = plates[int(box.y0) + 4 : int(box.y1) - 4, int(box.x0) + 4 : int(box.x1) - 4]
        assert not inside.any()


def test_numbers_of_guesses_close_together_leave_a_small_target_seen() -> None:
    guesses = Candidates(((300.0, 150.0), (304.0, 152.0), (299.0, 155.0)))
    covered = changed(flat((150, 150, 150), guesses))
    assert covered[125:180, 275:330].mean() < 0.25
    assert covered.sum() > 500  # the plates stand farther out


@pytest.mark.parametrize("count", [1, 3])
def test_guesses_on_the_very_same_point_are_drawn(count: int) -> None:
    assert changed(flat((150, 150, 150), Candidates(((300.0, 150.0),) * count))).any()


def test_numbers_inside_a_small_box_stand_outside_it_and_in_a_large_one_inside() -> None:
    small, large = Box(280, 130, 340, 190), Box(120, 20, 400, 300)
    for box, outside in ((small, True), (large, False)):
        drawn = draw(flat((150, 150, 150), BoxMark(box), Candidates(inside_points(box, 3, 3))))
        plate = np.abs(drawn.astype(int) - BLUE).max(axis=2) < 40
        inner = plate[int(box.y0) + 5 : int(box.y1) - 5, int(box.x0) + 5 : int(box.x1) - 5]
        assert (plate.sum() > 5 * inner.sum()) == outside


def test_a_region_is_tinted_and_named_whatever_its_corners() -> None:
    region = RegionMark(((100.0, 60.0), (300.0, 80.0), (260.0, 240.0), (80.0, 200.0)), "laptop")
    picture = flat((150, 150, 150), region)
    covered = changed(picture)
    assert covered[140, 180]
    assert not covered[300, 600]
    assert draw(flat((150, 150, 150), RegionMark(region.corners))).sum() != draw(picture).sum()


@pytest.mark.parametrize("box", [Box(0, 0, 640, 480), Box(10, 300, 200, 470), Box(500, 5, 630, 200), Box(3, 3, 20, 20)])
def test_crops_are_never_mostly_padding_and_large_targets_are_enlarged(box: Box) -> None:
    picture = crop(view(), box, "crop")
    assert picture.frame.valid.area / picture.frame.whole_box.area > 0.85
    assert picture.frame.scale >= 2
    shown = picture.frame.box_to_picture(box).intersection(picture.frame.whole_box)
    assert shown is not None
    assert shown.as_tuple == pytest.approx(picture.frame.box_to_picture(box).as_tuple, abs=1e-6)


def test_a_crop_in_the_middle_of_the_view_has_no_padding() -> None:
    picture = crop(view(), Box(30, 200, 130, 300), "crop", margin=1.0)
    assert picture.frame.valid.as_tuple == picture.frame.whole_box.as_tuple
    assert picture.frame.box_to_view(picture.frame.whole_box).x0 == pytest.approx(0)


@pytest.mark.parametrize(
    ("size", "wanted"),
    [((640, 320), (1280, 640)), ((256, 128), (1280, 640)), ((600, 400), (1280, 853)), ((1400, 700), (1400, 700))],
)
def test_whole_views_are_enlarged_for_marks(size: tuple[int, int], wanted: tuple[int, int]) -> None:
    picture = whole(view(*size), "top", long_side_px=1280)
    assert picture.size_px == wanted
    assert picture.frame.box_to_view(picture.frame.whole_box).as_tuple == pytest.approx((0, 0, *size))
