"""What a simulated model sees: the truth behind true pixels, nothing behind any others."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from tests.simulated.image_corruption import CHANGES
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, Picture
from wonderful_team.images import crop, edge_strips, whole
from wonderful_team.simulated.seeing import Eyes

from .tables import Set, set_table


@pytest.fixture(scope="module")
def table() -> Iterator[Set]:
    with set_table("rearrange", 5) as made:
        yield made


def pictures(table: Set) -> dict[str, Picture]:
    view, box = table.scene.view, table.thing_box("olive flower")
    strips = edge_strips(view, box)
    return {
        "whole": whole(view, "top view"),
        "enlarged": whole(view, "top view", min_side_px=640),
        "shrunk": whole(view, "top view", max_side_px=400),
        "crop": crop(view, box, "crop"),
        "padded crop": crop(view, Box(600, 250, 640, 320), "crop"),
        "strip": strips["left", "inside"],
        "marked": whole(view, "top view").marked(BoxMark(box, "target", "T1")),
    }


KINDS = ("whole", "enlarged", "shrunk", "crop", "padded crop", "strip", "marked")


@pytest.mark.parametrize("kind", KINDS)
def test_true_pictures_are_seen_whatever_their_frame(table: Set, kind: str) -> None:
    assert Eyes(table.truth).see(pictures(table)[kind]) is not None


@pytest.mark.parametrize("kind", KINDS)
def test_a_picture_that_nobody_drew_is_seen_as_the_same_one_in_pixels(table: Set, kind: str) -> None:
    picture = pictures(table)[kind]
    later = Eyes(table.truth).see(picture)
    at_once = Eyes(table.truth).see(replace(picture, rgb=picture.rgb))
    assert later is not None
    assert at_once is not None
    assert later.sight is at_once.sight


def test_a_picture_of_another_tables_view_is_not_seen(table: Set) -> None:
    with set_table("rearrange", 6) as other:
        assert Eyes(table.truth).see(whole(other.scene.view, "top view")) is None


def jpeg(rgb: Array) -> Array:
    held = io.BytesIO()
    Image.fromarray(rgb).save(held, "JPEG", quality=85)
    return np.array(Image.open(held))


@pytest.mark.parametrize("kind", KINDS)
def test_noise_of_storing_does_not_blind(table: Set, kind: str) -> None:
    picture = pictures(table)[kind]
    assert Eyes(table.truth).see(replace(picture, rgb=jpeg(picture.rgb))) is not None


@pytest.mark.parametrize("change", tuple(CHANGES))
@pytest.mark.parametrize("kind", ["whole", "enlarged", "shrunk", "crop"])
def test_shifted_flipped_noised_and_blank_pictures_blind(table: Set, kind: str, change: str) -> None:
    picture = pictures(table)[kind]
    assert Eyes(table.truth).see(replace(picture, rgb=CHANGES[change](picture.rgb))) is None


@pytest.mark.parametrize("step", [3, 5, -4])
def test_a_shift_of_a_few_pixels_blinds(table: Set, step: int) -> None:
    picture = whole(table.scene.view, "top view")
    assert Eyes(table.truth).see(replace(picture, rgb=np.roll(picture.rgb, step, axis=1))) is None
    assert Eyes(table.truth).see(replace(picture, rgb=np.roll(picture.rgb, step, axis=0))) is None


def test_one_thing_painted_over_blinds(table: Set) -> None:
    picture = whole(table.scene.view, "top view")
    rgb = picture.rgb.copy()
    rgb[table.truth.masks()["purple ring"]] = (224, 219, 208)
    assert Eyes(table.truth).see(replace(picture, rgb=rgb)) is None


def test_a_strip_flipped_on_its_way_is_not_seen_but_one_whose_frame_says_so_is(table: Set) -> None:
    strip = edge_strips(table.scene.view, table.thing_box("olive flower"))["top", "inside"]
    turned = np.ascontiguousarray(strip.rgb[:, ::-1])
    assert Eyes(table.truth).see(replace(strip, rgb=turned)) is None
    mirror = np.array([[-1.0, 0.0, strip.size_px[0]], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    frame = strip.frame
    honest = Frame(frame.view_id, frame.T_view_picture @ mirror, frame.size_px, frame.valid)
    seen = Eyes(table.truth).see(replace(strip, rgb=turned, frame=honest))
    right = Eyes(table.truth).see(strip)
    assert seen is not None
    assert right is not None
    box, mirrored = right.box("olive flower"), seen.box("olive flower")
    assert box is not None
    assert mirrored is not None
    assert mirrored.x0 == pytest.approx(strip.size_px[0] - box.x1)


def test_a_crop_shows_no_more_than_lies_in_it(table: Set) -> None:
    seen = Eyes(table.truth).see(crop(table.scene.view, table.thing_box("olive flower"), "crop"))
    assert seen is not None
    assert "olive flower" in seen.names
    assert "purple ring" not in seen.names
    assert seen.box("purple ring") is None
    assert seen.grasp("purple ring") is None


def test_boxes_and_points_are_mapped_through_the_frame(table: Set) -> None:
    true = table.thing_box("olive flower")
    for picture in pictures(table).values():
        seen = Eyes(table.truth).see(picture)
        assert seen is not None
        found = seen.box("olive flower")
        if found is not None and seen.count("olive flower") == table.truth.masks()["olive flower"].sum():
            assert picture.frame.box_to_view(found).iou(true) > 0.97
            grasp = seen.grasp("olive flower")
            assert grasp is not None
            assert true.contains(picture.frame.point_to_view(grasp))


def test_a_picture_of_another_view_under_this_name_is_not_seen(table: Set) -> None:
    front = table.scene.observation.views["front"]
    assert Eyes(table.truth).see(whole(replace(front, id="top"), "top view")) is None
    assert Eyes(table.truth).see(whole(replace(front, id="side"), "side view")) is None


def test_after_something_moved_an_old_picture_is_old() -> None:
    with set_table("rotate") as table:
        old = whole(table.scene.view, "top view")
        eyes = Eyes(table.truth)
        before = eyes.see(old)
        assert before is not None
        assert before.current
        for action in table.truth.oracle():
            table.world.execute(action)
        table.look()
        after, now = eyes.see(old), eyes.see(whole(table.scene.view, "top view"))
        assert after is not None
        assert not after.current
        assert now is not None
        assert now.current
