"""Coloured and dim light, and shadows, are taken out before colours are named; plain light is left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.offline.vision.drawn import Drawing, box_shape, plain, round_shape
from wonderful_team.core.pictures import Picture, PointMark
from wonderful_team.offline.vision import Scene, in_plain_light, see

TABLE = (222, 219, 211)
RED, BLUE, YELLOW = (205, 40, 45), (50, 80, 200), (235, 205, 50)
WARM, COOL = (1.0, 0.88, 0.76), (0.76, 0.88, 1.0)
LAMP = (60.0, -90.0)
"""Way of a shadow per 0.1 m of height [px]."""


def table(*, depth: bool = True, light: tuple[float, ...] = (1.0, 1.0, 1.0), shadow: float | None = None) -> Picture:
    """A red, a blue and a yellow thing; in some light; with the shadows that 5 cm cast when `shadow` of it is left."""
    drawing = Drawing(640, 320, TABLE, noise=1.0)
    things = {
        RED: box_shape((150, 200), 64, 64),
        BLUE: round_shape((330, 160), 40),
        YELLOW: box_shape((500, 220), 80, 50),
    }
    if shadow is not None:
        for outline in things.values():
            for share in np.linspace(0.02, 1.0, 50):
                drawing.add(
                    outline + np.array(LAMP) * 0.5 * share,
                    plain(tuple(shadow * value for value in TABLE)),
                    height_m=0.0,
                )
    for colour, outline in things.items():
        drawing.add(outline, plain(colour), height_m=0.05)
    drawing.image *= np.array(light)
    return drawing.picture(depth=depth)


def names(scene: Scene) -> list[str]:
    return [thing.look.words for thing in scene.things]


def test_plain_light_is_left_alone() -> None:
    picture = table()
    assert in_plain_light(picture) is picture


@pytest.mark.parametrize("table_rgb", [(205, 198, 185), (128, 128, 128), (150, 110, 70), (255, 255, 255), (40, 42, 45)])
def test_other_tables_in_plain_light_keep_their_things_colours(table_rgb: tuple[int, int, int]) -> None:
    drawing = Drawing(640, 320, table_rgb, noise=1.0)
    drawing.add(box_shape((150, 200), 64, 64), plain(RED), height_m=0.05)
    drawing.add(round_shape((330, 160), 40), plain(BLUE), height_m=0.05)
    drawing.add(box_shape((500, 220), 80, 50), plain(YELLOW), height_m=0.05)
    picture = drawing.picture(depth=True)
    assert names(see(in_plain_light(picture))) == ["red square", "blue circle", "yellow rectangle"]


@pytest.mark.parametrize("light", [WARM, COOL], ids=["warm", "cool"])
@pytest.mark.parametrize("depth", [True, False], ids=["depth", "photo"])
def test_colours_under_a_dim_coloured_lamp_are_those_of_the_things(light: tuple[float, ...], depth: bool) -> None:
    lamp = tuple(0.65 * share for share in light)
    dim = table(depth=depth, light=lamp)
    assert names(see(in_plain_light(dim))) == ["red square", "blue circle", "yellow rectangle"]
    known = table(depth=depth)
    gap = np.abs(in_plain_light(dim).rgb.astype(float) - known.rgb)
    assert np.median(gap) < 5
    assert np.percentile(gap, 99) < 20


def test_a_white_sheet_shows_that_a_beige_table_is_beige_in_white_light() -> None:
    drawing = Drawing(640, 320, (220, 200, 170), noise=1.0)
    drawing.add(box_shape((300, 160), 160, 120), plain((245, 245, 245)))
    picture = drawing.picture()
    sheet = in_plain_light(picture).rgb[130:190, 260:340].reshape(-1, 3).mean(axis=0)
    assert np.ptp(sheet) < 12


@pytest.mark.parametrize("left", [0.4, 0.6])
def test_shadows_are_lit_again_and_are_no_things(left: float) -> None:
    shaded = table(shadow=left)
    assert len(see(shaded).things) > 3  # what they are taken for without it
    assert names(see(in_plain_light(shaded))) == ["red square", "blue circle", "yellow rectangle"]


def test_a_grey_sheet_beside_a_thing_is_no_shadow() -> None:
    drawing = Drawing(640, 320, TABLE, noise=1.0)
    drawing.add(box_shape((260, 160), 160, 120), plain((130, 128, 124)))
    drawing.add(box_shape((260, 160), 60, 60), plain(RED), height_m=0.05)
    drawing.add(box_shape((500, 160), 60, 60), plain(BLUE), height_m=0.05)
    picture = drawing.picture(depth=True)
    assert in_plain_light(picture) is picture


def test_a_grained_grey_tray_is_no_shadow_of_its_rim() -> None:
    shaded = table(shadow=0.55)
    grain = np.random.default_rng(0).integers(0, 2, (320, 640))
    drawing = Drawing(640, 320, TABLE, noise=1.0)
    for share in np.linspace(0.02, 1.0, 50):
        outline = round_shape((330, 160), 70) + np.array(LAMP) * 0.5 * share
        drawing.add(
            outline, lambda x, y: (95 + 60 * grain[: x.shape[0], : x.shape[1]])[..., None] * np.ones(3), height_m=0.0
        )
    drawing.add(round_shape((330, 160), 70), plain(BLUE), height_m=0.05)
    grey = drawing.picture(depth=True)
    assert in_plain_light(shaded) is not shaded
    assert in_plain_light(grey) is grey


def test_what_lies_round_a_table_tells_nothing_of_the_light() -> None:
    drawing = Drawing(640, 320, (149, 153, 159), noise=1.0)
    drawing.add(box_shape((320, 160), 480, 180), plain(TABLE))
    drawing.add(box_shape((320, 160), 60, 60), plain(RED), height_m=0.05)
    picture = drawing.picture()
    assert in_plain_light(picture) is picture


def test_marks_stay_with_their_own_picture() -> None:
    dim = table(light=WARM)
    marked = replace(dim, marks=(PointMark((10.0, 10.0), "1"),))
    assert in_plain_light(dim).marks == ()
    assert in_plain_light(marked).marks == marked.marks
