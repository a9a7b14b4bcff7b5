"""What stands on what and what it is called: a lid on its box, a bottle with its neck or cap, plates that are no papers; with depth."""

from __future__ import annotations

import numpy as np
import pytest

from tests.offline.vision.drawn import BLUE, GREEN, RED, YELLOW, Drawing, box_shape, plain, round_shape
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.description import ROOMY, Description
from wonderful_team.offline.eyes import Eyes
from wonderful_team.offline.goals.clearing import closed_by
from wonderful_team.offline.language import describe
from wonderful_team.offline.vision import see
from wonderful_team.offline.vision.kinds import is_kind_here, part_on

AT = (200.0, 160.0)


def boxed(lid_m: float, lid: tuple[int, int, int] = YELLOW, noise_m: float = 0.0) -> Picture:
    """A blue box, a lid of that height on its rim, a handle on the lid, and a red block beside it."""
    drawn = Drawing().add(box_shape(AT, 180, 180), plain(BLUE), height_m=0.055)
    drawn.add(box_shape(AT, 130, 130), plain(lid), height_m=lid_m)
    drawn.add(box_shape(AT, 60, 16), plain(lid), height_m=lid_m + 0.03)
    drawn.add(box_shape((480, 160), 50, 50), plain(RED), height_m=0.045)
    drawn.height_m += np.random.default_rng(0).normal(0, noise_m, drawn.height_m.shape).astype(np.float32)
    return drawn.picture(depth=True)


def bottle(cap: tuple[int, int, int]) -> Picture:
    """A green bottle with something round on its middle, and a bowl beside it."""
    drawn = (
        Drawing()
        .add(round_shape(AT, 45), plain(GREEN), height_m=0.08)
        .add(round_shape(AT, 18), plain(cap), height_m=0.114)
    )
    drawn.add(round_shape((480, 160), 70), plain(BLUE), height_m=0.04, hole=round_shape((480, 160), 55))
    return drawn.picture(depth=True)


@pytest.mark.parametrize("noise_m", [0.0, 0.001])
def test_a_lid_and_its_box_are_two_things_and_the_lid_closes_the_box(noise_m: float) -> None:
    eyes = Eyes(boxed(0.063, noise_m=noise_m))
    lid, box = eyes.best(describe("the lid")), eyes.best(describe("the box"))
    assert lid is not None
    assert box is not None
    assert lid.box.width == pytest.approx(130, abs=6)
    assert box.box.width == pytest.approx(180, abs=6)
    assert closed_by(box.thing, eyes) is lid.thing
    handle = part_on(lid.thing, eyes.scene)  # type: ignore[arg-type]
    assert handle is not None
    assert handle.box.width == pytest.approx(60, abs=6)


def askew(off_px: tuple[float, float], lean: float = 0.0, noise_m: float = 0.0) -> Picture:
    """A blue box with an opening, and a yellow lid with its handle shifted on it, which rises by `lean` a pixel to the right [m]."""
    at = (AT[0] + off_px[0], AT[1] + off_px[1])
    drawn = Drawing()
    drawn.add(box_shape(AT, 180, 180), plain(BLUE), height_m=0.055)
    drawn.add(box_shape(AT, 116, 116), plain((30, 50, 120)), height_m=0.004)
    drawn.add(box_shape(at, 136, 136), plain(YELLOW), height_m=0.063)
    drawn.add(box_shape(at, 60, 16), plain(YELLOW), height_m=0.095)
    drawn.height_m += np.where(drawn.height_m > 0.06, lean * (np.arange(drawn.height_m.shape[1]) - at[0]), 0.0).astype(
        np.float32
    )
    drawn.height_m += np.random.default_rng(0).normal(0, noise_m, drawn.height_m.shape).astype(np.float32)
    return drawn.picture(depth=True)


@pytest.mark.parametrize("noise_m", [0.0, 0.001])
@pytest.mark.parametrize(
    ("off_px", "lean"), [((50.0, 0.0), 0.0), ((0.0, -50.0), 0.0), ((6.0, 6.0), 0.00006), ((-4.0, 0.0), -0.00006)]
)
def test_a_lid_askew_on_its_box_or_over_its_edge_is_a_lid_and_closes_it(
    off_px: tuple[float, float], lean: float, noise_m: float
) -> None:
    eyes = Eyes(askew(off_px, lean, noise_m))
    lid, box = eyes.best(describe("the lid")), eyes.best(describe("the box"))
    assert lid is not None
    assert box is not None
    assert lid.box.centre == pytest.approx((AT[0] + off_px[0], AT[1] + off_px[1]), abs=6)
    assert box.box.centre == pytest.approx(AT, abs=6)
    assert box.box.width == pytest.approx(180, abs=8)
    assert closed_by(box.thing, eyes) is lid.thing
    # What still shows of the inside is the box's, and no thing of its own.
    assert len(eyes.scene.things) == 3


def test_a_block_in_an_open_box_closes_nothing() -> None:
    drawn = Drawing().add(box_shape(AT, 180, 180), plain(BLUE), height_m=0.055)
    drawn.add(box_shape(AT, 116, 116), plain(BLUE), height_m=0.004)
    drawn.add(box_shape(AT, 50, 50), plain(RED), height_m=0.064)
    eyes = Eyes(drawn.picture(depth=True))
    box = eyes.best(describe("the box"))
    assert box is not None
    assert closed_by(box.thing, eyes) is None


def test_a_level_top_of_one_colour_and_what_is_no_higher_stay_one_thing() -> None:
    assert len(see(boxed(0.055)).things) <= len(see(boxed(0.063)).things)
    one = (
        Drawing()
        .add(box_shape(AT, 180, 180), plain(BLUE), height_m=0.055)
        .add(box_shape(AT, 130, 130), plain(YELLOW), height_m=0.057)
    )
    assert len(see(one.picture(depth=True)).things) == 1


def test_a_block_on_a_box_is_no_lid() -> None:
    assert Eyes(boxed(0.063)).number(describe("the red lid")) is None


@pytest.mark.parametrize("cap", [RED, GREEN])
def test_a_bottle_is_the_round_thing_that_stands_tall_and_not_what_is_on_it(cap: tuple[int, int, int]) -> None:
    eyes = Eyes(bottle(cap))
    found = eyes.find(describe("the bottle"))
    assert len(found) == 1
    assert found[0].box.width == pytest.approx(90, abs=6)
    assert eyes.best(describe("the cap on top of the bottle")).box.width == pytest.approx(36, abs=6)  # type: ignore[union-attr]


def test_no_picture_tells_a_tool() -> None:
    assert Eyes(bottle(RED)).find(Description("tool", "pen", "pen")) == []


def test_a_flat_plate_is_a_plate_and_a_paper_is_none() -> None:
    drawn = (
        Drawing()
        .add(round_shape(AT, 80), plain(GREEN), height_m=0.006)
        .add(round_shape((480, 160), 80), plain(RED), height_m=0.0005)
    )
    eyes = Eyes(drawn.picture(depth=True))
    assert eyes.number(describe("the green plate")) is not None
    assert eyes.number(describe("the red plate")) is None


def test_the_largest_free_area_has_room_for_the_largest_thing() -> None:
    eyes = Eyes(bottle(RED))
    spot = eyes.best(ROOMY)
    assert spot is not None
    assert all(np.hypot(spot.point[0] - x, spot.point[1] - 160) > 45 + 56 for x in (200, 480))


def test_a_bottle_seen_aslant_keeps_the_shoulder_that_its_neck_hides() -> None:
    drawn = Drawing().add(round_shape(AT, 46), plain(RED), height_m=0.068)
    drawn.add(round_shape((AT[0] + 24, AT[1]), 25), plain(RED), height_m=0.11)
    eyes = Eyes(drawn.picture(depth=True))
    bottle = eyes.best(describe("the red bottle"))
    assert bottle is not None
    assert bottle.box.width == pytest.approx(92, abs=8)
    neck = part_on(bottle.thing, eyes.scene)  # type: ignore[arg-type]
    assert neck is not None
    assert neck.centre[0] == pytest.approx(AT[0] + 24, abs=3)


def test_a_block_in_the_notch_of_an_angle_is_no_part_of_it() -> None:
    corners = np.array([(120, 80), (160, 80), (160, 200), (280, 200), (280, 240), (120, 240)], float)
    drawn = (
        Drawing()
        .add(corners, plain(BLUE), height_m=0.03)
        .add(box_shape((195, 165), 66, 66), plain(YELLOW), height_m=0.06)
    )
    things = see(drawn.picture(depth=True)).things
    angle = max(things, key=lambda thing: thing.box.area)
    assert len(things) == 2
    assert not angle.holds((205.0, 150.0))


@pytest.mark.parametrize("load", [YELLOW, RED])
def test_a_lid_on_the_table_is_no_box_but_a_tray_with_a_load_is(load: tuple[int, int, int]) -> None:
    drawn = Drawing().add(box_shape(AT, 130, 130), plain(YELLOW), height_m=0.008)
    drawn.add(box_shape(AT, 60, 30), plain(load), height_m=0.038)
    scene = see(drawn.picture(depth=True))
    plate = max(scene.things, key=lambda thing: thing.area_px)
    assert is_kind_here(plate, "container", scene) == (load == RED)
