"""Small computed pictures: 256 x 128 px, hard edges, no noise, no depth, and the room showing round a dark table."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.offline.vision.drawn import BLUE, GREEN, ORANGE, PURPLE, RED, WHITE, YELLOW, box_shape, regular
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import View
from wonderful_team.images import crop, whole
from wonderful_team.offline.description import Description
from wonderful_team.offline.vision import likeness, resolve, see, study_example, suits, with_heights

TABLE, ROOM, PALE = (47, 47, 47), (238, 238, 238), (240, 240, 240)
Colour = tuple[int, int, int]


class Rendering:
    """A table as a simple renderer shows it: every pixel one colour, the room as a thin light band round the table."""

    def __init__(self, ground: Colour = TABLE, room: Colour | None = ROOM) -> None:
        self.rgb = np.full((128, 256, 3), ground, np.uint8)
        if room is not None:
            self.rgb[:1], self.rgb[-3:], self.rgb[:, :3], self.rgb[:, -3:] = room, room, room, room

    def add(
        self, outline: np.ndarray, one: Colour, other: Colour | None = None, *, stripe: int = 4, dots: bool = False
    ) -> Rendering:
        mask = np.zeros(self.rgb.shape[:2], np.uint8)
        cv2.fillPoly(mask, [np.round(outline).astype(np.int32)], 1)
        y, x = np.mgrid[0:128, 0:256]
        second = np.hypot(x % 9 - 4, y % 9 - 4) < 2.6 if dots else (x // stripe) % 2 == 0
        self.rgb[mask > 0] = one
        if other is not None:
            self.rgb[(mask > 0) & second] = other
        return self

    @property
    def view(self) -> View:
        return View("top", "top", 0.0, self.rgb)

    def picture(self, name: str = "top view") -> Picture:
        return whole(self.view, name)


def centres(picture: Picture) -> list[tuple[int, int]]:
    """Middles of what is seen [view px]."""
    scale = picture.frame.scale
    return sorted((round(thing.centre[0] / scale), round(thing.centre[1] / scale)) for thing in see(picture).things)


def block(x: float, y: float, side: float = 18, turn_deg: float = 0.0) -> np.ndarray:
    return box_shape((x, y), side, side, turn_deg)


def frame_of_bars(rendering: Rendering, colour: Colour) -> Rendering:
    """Four bars that meet at their corners only."""
    for x, y, w, h in ((100, 40, 50, 6), (100, 102, 50, 6), (71, 71, 6, 54), (129, 71, 6, 54)):
        rendering.add(box_shape((x, y), w, h), colour)
    return rendering


def test_the_room_round_the_table_is_no_thing_and_hides_none() -> None:
    table = Rendering().add(block(80, 60), RED).add(block(200, 120), BLUE)
    assert centres(table.picture()) == [(80, 60), (200, 120)]
    assert centres(Rendering().picture()) == []


def test_things_a_pixel_apart_are_two_and_the_bars_of_a_frame_are_one() -> None:
    table = frame_of_bars(Rendering(), PURPLE).add(block(180, 60), RED).add(block(200, 60), GREEN)
    scene = see(table.picture())
    assert len(scene.things) == 3
    frame = max(scene.things, key=lambda thing: thing.area_px)
    assert frame.look.shape == "frame"
    assert frame.look.outline.hole_share > 0.5


def test_slats_are_one_thing_and_their_gaps_no_part_of_its_look() -> None:
    table = Rendering()
    for k in range(6):
        table.add(box_shape((100, 40 + 9 * k), 50, 5), YELLOW)
    (pallet,) = see(table.picture()).things
    assert pallet.look.patterns["plain"] > 0.6
    assert pallet.box.height / 4 == pytest.approx(51, abs=2)


def test_like_blocks_that_touch_at_a_corner_are_two() -> None:
    table = Rendering().add(block(80, 60, 8), RED, BLUE, stripe=2).add(block(88, 67, 8), RED, BLUE, stripe=2)
    assert len(see(table.picture()).things) == 2


@pytest.mark.parametrize("dots", [False, True])
def test_a_texture_does_not_fall_apart_and_what_lies_on_it_is_seen(dots: bool) -> None:
    alone = Rendering().add(block(90, 64, 44), BLUE, YELLOW, stripe=7, dots=dots)
    assert len(see(alone.picture()).things) == 1
    table = Rendering().add(block(90, 64, 44), BLUE, YELLOW, stripe=7, dots=dots).add(regular((90, 64), 13, 5), RED)
    scene = see(table.picture())
    assert len(scene.things) == 2
    top = min(scene.things, key=lambda thing: thing.area_px)
    assert top.look.colours[0].name == "red"
    assert top.on is not None


def test_a_bar_across_a_three_sided_frame_is_a_thing_of_its_own() -> None:
    table = Rendering()
    for x, y, w, h in ((120, 20, 60, 8), (94, 50, 8, 60), (146, 50, 8, 60)):
        table.add(box_shape((x, y), w, h), RED)
    table.add(box_shape((120, 50), 76, 9), GREEN, RED, stripe=12)
    boxes = sorted(tuple(round(v / 4) for v in thing.box.as_tuple) for thing in see(table.picture()).things)
    assert len(boxes) == 2
    assert boxes[0] == pytest.approx((82, 46, 159, 55), abs=2)
    assert boxes[1][3] == pytest.approx(80, abs=2)


def test_two_things_of_other_colours_that_touch_are_two() -> None:
    table = Rendering().add(block(90, 64, 24), BLUE, RED, dots=True).add(block(114, 64, 23), YELLOW, RED, dots=True)
    scene = see(table.picture())
    assert len(scene.things) == 2
    assert {thing.look.colours[0].name for thing in scene.things} == {"blue", "yellow"}


def test_pale_texture_shows_on_a_white_picture_and_gaps_do_not() -> None:
    shown = Rendering((255, 255, 255), None).add(block(128, 64, 30), GREEN, PALE)
    example = study_example(shown.picture("x"))
    assert example.area_view_px == pytest.approx(961, rel=0.08)
    table = Rendering().add(block(60, 60, 30, 40), GREEN, PALE).add(block(180, 60, 30), GREEN)
    found = resolve(see(table.picture()), Description("object", "", like="x"), {"x": example})
    assert found[0].box.x0 < 400
    slats = Rendering((255, 255, 255), None)
    for k in range(5):
        slats.add(box_shape((128, 40 + 8 * k), 44, 5), (170, 165, 160))
    look = study_example(slats.picture("grey")).look
    assert look.memberships["grey"] + look.memberships["brown"] > 0.9
    assert look.patterns["plain"] > 0.6


def test_a_crop_shows_the_same_thing_as_the_whole() -> None:
    table = Rendering().add(block(80, 60, 18, 30), RED, YELLOW).add(block(180, 60), BLUE)
    picture = table.picture()
    thing = min(see(picture).things, key=lambda item: item.box.x0)
    cut = crop(table.view, picture.frame.box_to_view(thing.box), "crop")
    again = max(see(cut).things, key=lambda item: item.area_px)
    assert cut.frame.box_to_view(again.box).iou(picture.frame.box_to_view(thing.box)) > 0.85


def test_how_tall_things_are_shows_from_the_side() -> None:
    above = Rendering().add(block(80, 60, 20), ORANGE).add(block(180, 60, 20), ORANGE)
    side = Rendering().add(box_shape((80, 60), 20, 14), ORANGE)
    side.add(box_shape((180, 50), 20, 14), ORANGE).add(box_shape((180, 63), 20, 12), (150, 88, 25))
    scene = with_heights(see(above.picture()), side.picture("front view"))
    for word, left in (("tallest", False), ("shortest", True)):
        found = resolve(scene, Description("object", "", superlative=word), {})
        assert (found[0].point[0] < 512) is left


def test_words_of_textures_that_show_only_in_part() -> None:
    table = Rendering().add(block(60, 60, 30), RED, PALE, stripe=8).add(block(180, 60, 30), RED)
    banded, plain = see(table.picture()).things
    swirl = Description("object", "", colours=("red",), pattern="swirled")
    assert suits(banded, swirl, {}, 4.0)[0] > 0.5
    assert suits(plain, swirl, {}, 4.0)[0] < 0.2
    rainbow = Rendering()
    for k in range(36):
        hsv = np.array([[[int(5 + 1.6 * k), 220, 230]]], np.uint8)
        rainbow.add(
            box_shape((100.5 + k, 60), 1, 30), tuple(int(v) for v in cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)[0, 0])
        )
    (arc,) = see(rainbow.picture()).things
    assert suits(arc, Description("object", "", pattern="multicoloured"), {}, 4.0)[0] > 0.5


def test_the_same_thing_in_two_pictures_is_more_alike_than_another() -> None:
    star = regular((80, 60), 16, 5, inner=0.5)
    first = Rendering().add(star, RED, BLUE, stripe=3).add(block(180, 60, 24), RED, BLUE, stripe=3)
    second = Rendering().add(regular((150, 80), 16, 5, 25, inner=0.5), RED, BLUE, stripe=3)
    (again,) = see(second.picture()).things
    left, right = see(first.picture()).things
    assert likeness(left, again) > likeness(right, again) + 0.2


def test_noise_is_no_reason_to_fail() -> None:
    table = Rendering().add(block(80, 60, 24), RED).add(block(180, 60, 24), GREEN, WHITE, stripe=6)
    noise = np.random.default_rng(3).normal(0, 4, table.rgb.shape)
    table.rgb = np.clip(table.rgb + noise, 0, 255).astype(np.uint8)
    found = centres(table.picture())
    assert any(abs(x - 80) < 3 and abs(y - 60) < 3 for x, y in found)
    assert any(abs(x - 180) < 3 and abs(y - 60) < 3 for x, y in found)
