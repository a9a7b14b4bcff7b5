"""What see() reports of drawn tables and of photos."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from skimage import data

from tests.offline.vision.drawn import (
    BLUE,
    GREEN,
    NAVY,
    ORANGE,
    RED,
    WHITE,
    YELLOW,
    Drawing,
    box_shape,
    dotted,
    plain,
    polygon,
    regular,
    round_shape,
    striped,
)  # fmt: skip
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.description import Description
from wonderful_team.offline.vision import Thing, resolve, see
from wonderful_team.offline.vision.recent import array_bytes


def at(picture: Picture, x: float, y: float) -> Thing:
    thing = see(picture).at((x, y))
    assert thing is not None, f"nothing seen at ({x}, {y})"
    return thing


def test_things_are_found_with_tight_boxes_and_named_colours() -> None:
    picture = (
        Drawing()
        .add(box_shape((120, 100), 60, 60, 20), plain(RED))
        .add(round_shape((320, 180), 35), plain(BLUE))
        .add(regular((500, 120), 40, 3), plain(GREEN))
        .picture()
    )
    scene = see(picture)
    assert [thing.look.colours[0].name for thing in scene.things] == ["red", "blue", "green"]
    assert [thing.look.shape for thing in scene.things] == ["square", "circle", "triangle"]
    ball = scene.things[1]
    assert np.allclose(ball.box.as_tuple, (285, 145, 355, 215), atol=2.5)
    assert np.allclose(ball.centre, (320, 180), atol=1.5)


@pytest.mark.parametrize(
    ("outline", "shape"),
    [
        (regular((320, 160), 45, 5, 11), "pentagon"),
        (regular((320, 160), 45, 6, 17), "hexagon"),
        (regular((320, 160), 48, 5, 30, inner=0.42), "star"),
        (box_shape((320, 160), 90, 52, 33), "rectangle"),
        (round_shape((320, 160), 50, 33, 40), "oval"),
        (box_shape((320, 160), 120, 26, 70), "long"),
    ],
)
def test_shapes_are_named_at_any_rotation(outline: np.ndarray, shape: str) -> None:
    assert at(Drawing().add(outline, plain(PURPLE := (120, 60, 150))).picture(), 320, 160).look.shape == shape, PURPLE


def test_holes_make_rings_and_frames() -> None:
    ring = Drawing().add(round_shape((200, 160), 55), plain(ORANGE), hole=round_shape((200, 160), 30))
    frame = ring.add(box_shape((440, 160), 120, 120, 15), plain(BLUE), hole=box_shape((440, 160), 80, 80, 15))
    shapes = [thing.look.shape for thing in see(frame.picture()).things]
    assert shapes == ["ring", "frame"]


@pytest.mark.parametrize(
    ("paint", "pattern"),
    [
        (plain(RED), "plain"),
        (striped(RED, YELLOW), "striped"),
        (dotted(WHITE, RED), "dotted"),
        (dotted(BLUE, YELLOW), "dotted"),
    ],
)
def test_patterns_are_named(paint: object, pattern: str) -> None:
    picture = Drawing().add(box_shape((320, 160), 90, 90, 10), paint).picture()  # type: ignore[arg-type]
    assert at(picture, 320, 160).look.pattern == pattern


def test_dark_and_bright_of_one_colour_are_told_apart() -> None:
    picture = (
        Drawing()
        .add(box_shape((150, 160), 60, 60), plain(NAVY))
        .add(box_shape((450, 160), 60, 60), plain(BLUE))
        .picture()
    )
    words = Description("block", "dark blue block", colours=("blue",), dark=True)
    assert resolve(see(picture), words, {})[0].thing is at(picture, 150, 160)
    assert resolve(see(picture), Description("block", "blue block", colours=("blue",)), {})[0].thing is at(
        picture, 450, 160
    )


def test_letters_are_read_in_any_rotation() -> None:
    stencil = np.zeros((240, 240), np.uint8)
    cv2.putText(stencil, "R", (70, 170), cv2.FONT_HERSHEY_DUPLEX, 4.5, 1, 22)
    turned = cv2.warpAffine(stencil, cv2.getRotationMatrix2D((120, 120), 65, 0.6), (240, 240))
    drawing = Drawing(240, 240)
    drawing.image[turned > 0] = RED
    found = resolve(see(drawing.picture()), Description("letter", "the letter R", name="R"), {})
    assert len(found) == 1
    assert resolve(see(drawing.picture()), Description("letter", "the letter T", name="T"), {}) == []


@pytest.mark.parametrize("depth", [True, False])
def test_a_fruit_on_a_paper_is_two_things(depth: bool) -> None:
    drawing = Drawing().add(box_shape((200, 160), 130, 130), plain(GREEN), height_m=0.001)
    drawing.add(round_shape((205, 155), 26), plain(RED), height_m=0.06)
    scene = see(drawing.picture(depth=depth))
    assert len(scene.things) == 2
    paper, fruit = sorted(scene.things, key=lambda thing: -thing.area_px)
    assert paper.flat
    assert not fruit.flat
    assert fruit.on == paper.number
    assert np.allclose(paper.box.as_tuple, (135, 95, 265, 225), atol=3)
    assert resolve(scene, Description("fruit", "apple", name="apple"), {})[0].thing is fruit
    assert resolve(scene, Description("area", "green area", colours=("green",)), {})[0].thing is paper


def test_depth_finds_what_has_the_table_colour() -> None:
    drawing = Drawing(slope=0.0).add(box_shape((300, 150), 70, 70), plain((205, 198, 185)), height_m=0.04)
    assert see(drawing.picture()).things == ()
    (thing,) = see(drawing.picture(depth=True)).things
    assert thing.height_m == pytest.approx(0.04, abs=0.003)
    assert np.allclose(thing.box.as_tuple, (265, 115, 335, 185), atol=2)


def test_small_views_enlarged_and_padded_are_read_alike() -> None:
    small = Drawing(256, 128).add(regular((90, 60), 17, 5, 10, inner=0.45), striped(RED, YELLOW, 6)).rgb
    big = np.full((600, 1024, 3), 128, np.uint8)
    big[:512] = cv2.resize(small, None, fx=4, fy=4, interpolation=cv2.INTER_NEAREST)
    frame = Frame.whole("top", (256, 150), 4.0)
    picture = Picture("top", big, Frame("top", frame.T_view_picture, (1024, 600), frame.whole_box.grown(0, 0, 0, -88)))
    (thing,) = see(picture).things
    assert thing.look.shape == "star"
    assert {"red", "yellow"} <= {colour.name for colour in thing.look.colours}
    assert np.allclose(thing.centre, (360, 240), atol=8)


def test_noise_and_bare_tables_show_nothing() -> None:
    noise = np.random.default_rng(3).integers(0, 256, (448, 448, 3)).astype(np.uint8)
    assert see(Picture("noise", noise, Frame.whole("top", (448, 448)))).things == ()
    assert see(Drawing(noise=4, slope=30).picture()).things == ()


def test_the_room_beyond_the_table_is_no_thing() -> None:
    drawing = Drawing().add(box_shape((300, 150), 50, 50), plain(BLUE))
    room = drawing.rgb.copy()
    room[:14], room[-14:], room[:, :20], room[:, -20:] = 90, 90, 90, 90
    assert [t.look.colours[0].name for t in see(Picture("t", room, Frame.whole("t", (640, 320)))).things] == ["blue"]


def test_coins_in_a_photo_are_all_found() -> None:
    photo = np.ascontiguousarray(np.stack([data.coins()] * 3, axis=-1))
    scene = see(Picture("photo", photo, Frame.whole("photo", (384, 303))))
    assert len(scene.things) == 24
    assert sum(thing.look.shape in ("circle", "oval") for thing in scene.things) >= 22


@pytest.mark.parametrize("width", [5.5, 6.0])
def test_a_flat_line_of_tiles_is_one_thing_whatever_shows_between_them(width: float) -> None:
    drawing = Drawing(noise=0.0, slope=0.0)
    for number in range(5):
        top, bottom = -56 + 22.4 * number + 1.5, -56 + 22.4 * (number + 1) - 1.5
        corners = [(-width / 2, top), (width / 2, top), (width / 2, bottom), (-width / 2, bottom)]
        paint = plain((114, 178, 188) if number == 2 else (100, 160, 168))
        drawing.add(polygon((320, 160), corners, 5), paint, height_m=0.001)
    (thing,) = see(drawing.picture(depth=True)).things
    assert thing.flat
    assert thing.box.height == pytest.approx(109, abs=4)


def test_what_was_seen_holds_on_to_no_whole_pictures() -> None:
    """A thing's mask is its own; as a part of one of the whole picture it would keep a megabyte, for each of fifty things."""
    drawing = Drawing(600, 400)
    for row in range(3):
        for column in range(5):
            drawing.add(box_shape((80 + 110 * column, 80 + 120 * row), 40, 40, 10 * column), plain(RED))
    seen = see(drawing.picture())
    assert len(seen.things) == 15
    assert all(thing.mask.base is None for thing in seen.things)
    assert array_bytes(seen) < 2_500_000
