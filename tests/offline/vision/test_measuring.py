"""Boxes judged in crops: from the crop's own pixels, and only against what was described."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.offline.vision.drawn import BLUE, GREEN, RED, YELLOW, Drawing, box_shape, plain, regular, striped
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.description import Description
from wonderful_team.offline.vision import fit_box, strip_presence

STAR = Description("object", "the green star", colours=("green",), shape="star")
CROP = (
    Drawing(448, 448)
    .add(regular((224, 224), 80, 5, 12, inner=0.45), plain(GREEN))
    .add(box_shape((60, 60), 90, 90), plain(RED))
    .picture("crop")
)


def true_box() -> Box:
    fit = fit_box(CROP, Box(150, 150, 300, 300), STAR, {})
    assert fit.best is not None
    return fit.best


def test_a_good_box_is_tight_and_the_outline_is_measured() -> None:
    box = true_box()
    outline = regular((224, 224), 80, 5, 12, inner=0.45)
    assert np.allclose(box.as_tuple, (*outline.min(axis=0), *outline.max(axis=0)), atol=3)
    assert fit_box(CROP, box.grown(6, 3, -3, 5), STAR, {}).verdict == "tight"


@pytest.mark.parametrize("radii", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("angle", [0.3, 1.9, 4.0])
def test_shifted_boxes_are_never_tight(radii: float, angle: float) -> None:
    box = true_box()
    shift = radii * 0.25 * (box.width + box.height)
    fit = fit_box(CROP, box.shifted(shift * np.cos(angle), shift * np.sin(angle)), STAR, {})
    assert fit.verdict in ("loose", "other", "empty")
    assert fit.best is not None
    assert fit.best.iou(box) > 0.95


def test_cut_and_loose_edges_are_named() -> None:
    box = true_box()
    cut = fit_box(CROP, Box(box.x0 + 0.4 * box.width, box.y0, box.x1, box.y1), STAR, {})
    assert (cut.verdict, cut.cut, cut.loose) == ("loose", ("left",), ())
    roomy = fit_box(CROP, box.grown(0, 0, 0.6 * box.width, 0), STAR, {})
    assert (roomy.verdict, roomy.cut, roomy.loose) == ("loose", (), ("right",))


def test_a_box_on_another_thing_or_a_wrong_target_is_not_accepted() -> None:
    assert fit_box(CROP, Box(15, 15, 105, 105), STAR, {}).verdict in ("other", "empty")
    assert fit_box(CROP, true_box(), Description("object", "blue star", colours=("blue",)), {}).verdict == "absent"
    assert fit_box(CROP, true_box(), replace(STAR, shape="hexagon"), {}).verdict == "absent"


def test_noise_in_place_of_the_crop_is_absent() -> None:
    noise = np.random.default_rng(0).integers(0, 256, CROP.rgb.shape).astype(np.uint8)
    for description in (STAR, Description("object", "the object")):
        assert fit_box(Picture("crop", noise, CROP.frame), true_box(), description, {}).verdict == "absent"


def test_a_crop_shifted_by_half_a_box_changes_the_answer() -> None:
    box = true_box()
    shifted = np.roll(CROP.rgb, (0, round(box.width / 2)), axis=(0, 1))
    assert fit_box(Picture("crop", shifted, CROP.frame), box, STAR, {}).verdict != "tight"


@pytest.mark.parametrize(("paint", "words"), [
    (plain(BLUE), Description("block", "blue block", colours=("blue",))),
    (striped(RED, YELLOW, 10), Description("block", "", colours=("red", "yellow"), pattern="striped")),
])  # fmt: skip
def test_strips_show_the_target_only_where_it_is(paint: object, words: Description) -> None:
    crop = Drawing(400, 300).add(box_shape((200, 150), 120, 100), paint).rgb  # type: ignore[arg-type]
    inside, outside = crop[100:200, 142:165], crop[100:200, 100:136]
    strips = [
        Picture("strip", np.ascontiguousarray(part), Frame.whole("s", part.shape[1::-1])) for part in (inside, outside)
    ]
    assert [strip_presence(strip, words, {}).shows for strip in strips] == [True, False]
    other = Description("block", "green", colours=("green",))
    assert [strip_presence(strip, other, {}).shows for strip in strips] == [False, False]
