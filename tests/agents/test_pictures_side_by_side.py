"""What belongs together stands in one picture, which says what stands where in it; every other caption is true as well."""

from __future__ import annotations

import numpy as np

from tests.images.scenes import view
from wonderful_team.agents.rendering import caption, instruction_parts, slot_parts
from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import View, Words
from wonderful_team.images import crop, whole
from wonderful_team.images.single import changed_pair, cut_outs


def alone(side: int, colour: tuple[int, int, int] = (40, 60, 170)) -> View:
    """A square of one colour on white."""
    rgb = np.full((320, 640, 3), 255, np.uint8)
    rgb[100 : 100 + side, 300 : 300 + side] = colour
    return View("slot:thing:top", "top", 0.0, rgb)


def things(*names: str, cameras: tuple[str, ...] = ("top", "front")) -> tuple[ShownSlot, ...]:
    shots = [[(f"{{{name}}} {camera}", alone(60)) for camera in cameras] for name in names]
    return tuple(ShownSlot(name, "object", found) for name, found in zip(names, cut_outs(shots), strict=True))


def test_top_and_front_of_a_thing_are_one_picture_that_says_which_is_which() -> None:
    words, sheet = slot_parts(things("mug"))
    assert isinstance(words, Words)
    assert isinstance(sheet, Picture)
    assert (
        "over its name, {mug}: one thing alone, enlarged 4 times; of each the top view (left) and front view (right)"
        in (words.text)
    )
    top, front = sheet.panels
    assert (top.picture.name, front.picture.name) == ("{mug} top", "{mug} front")
    assert front.origin_px[0] >= top.picture.size_px[0]
    for panel in sheet.panels:
        (x, y), (width, height) = panel.origin_px, panel.picture.size_px
        assert np.array_equal(sheet.rgb[y : y + height, x : x + width], panel.picture.rgb)


def test_things_share_a_picture_as_long_as_no_model_shrinks_it() -> None:
    pictures = [part for part in slot_parts(things(*"abcdefg")) if isinstance(part, Picture)]
    assert 1 < len(pictures) < 7
    assert all(picture.size_px[0] <= 1280 and picture.size_px[1] <= 768 for picture in pictures)
    panels = [panel for picture in pictures for panel in picture.panels]
    assert [panel.picture.name for panel in panels] == [
        f"{{{name}}} {camera}" for name in "abcdefg" for camera in ("top", "front")
    ]
    for picture in pictures:
        for panel in picture.panels:
            (x, y), (width, height) = panel.origin_px, panel.picture.size_px
            assert np.array_equal(picture.rgb[y : y + height, x : x + width], panel.picture.rgb)


def test_an_instruction_shows_shared_pictures_once_where_the_first_name_stands() -> None:
    slots = things("b", "a", cameras=("top",))
    parts = instruction_parts(ShownTask("put {a} on {b}, then {a} back", (), slots))
    pictures = [part for part in parts if isinstance(part, Picture)]
    assert [picture.name for picture in pictures] == ["{a}, {b}"]
    first = next(part for part in parts if isinstance(part, Words))
    assert first.text.endswith("put {a}")


def test_before_and_after_stand_side_by_side_cut_to_what_differs() -> None:
    first = alone(60)
    rgb = np.full_like(first.rgb, 255)
    rgb[130:190, 330:390] = (40, 60, 170)
    pair = changed_pair(("{was} top", first), ("{is} top", View("slot:is:top", "top", 0.0, rgb)))
    assert pair is not None
    slots = (ShownSlot("was", "before", pair[:1], 1), ShownSlot("is", "after", pair[1:], 1))
    words, sheet = slot_parts(slots)
    assert isinstance(words, Words)
    assert isinstance(sheet, Picture)
    assert len(sheet.panels) == 2
    assert "{was}: how it was before, of a pair, number 1" in words.text
    assert (pair[0].frame.T_view_picture == pair[1].frame.T_view_picture).all()


def test_striped_padding_is_named_where_there_is_some() -> None:
    box = Box(600, 300, 640, 380)
    assert "what is striped grey lies outside the view" in caption(crop(view(), box, "crop"))
    assert "striped" not in caption(crop(view(), Box(300, 200, 340, 240), "crop"))
    assert "striped" not in caption(whole(view(), "top view"))
