"""Pictures are cut out of their views when somebody reads their pixels, and once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import KeptFor
from wonderful_team.core.pictures import Picture, PointMark
from wonderful_team.core.values import LaterView, View, later_picture
from wonderful_team.images import crop, same_pixels, whole
from wonderful_team.images.panels import side_by_side


class Drawn:
    """A view of noise that says how often it was drawn."""

    def __init__(self, seed: int = 0) -> None:
        self.count, self._seed = 0, seed
        self.view = LaterView("top", "top", 0.0, (64, 48), self._draw)

    def _draw(self) -> tuple[Array, Array | None]:
        self.count += 1
        return np.random.default_rng(self._seed).integers(0, 255, (48, 64, 3), dtype=np.uint8), None


def test_nothing_is_drawn_for_a_picture_that_nobody_looks_at() -> None:
    one = Drawn()
    picture = whole(one.view, "top view").named("main view").marked(PointMark((3.0, 4.0)))
    sheet = side_by_side((("now", (crop(one.view, Box(10, 10, 40, 40), "crop"),)),), "both")
    assert picture.size_px == (512, 384)
    assert sheet.size_px[0] > 400
    assert one.count == 0
    assert picture.rgb is picture.marked(PointMark((9.0, 9.0))).rgb
    assert np.ptp(sheet.rgb[:100, :100]) > 50
    assert one.count == 1


def test_pixels_that_no_longer_fit_are_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(later_picture, "_kept", KeptFor(80_000, lambda held: held[0].nbytes))
    view = Drawn().view
    pictures = [crop(view, Box(x, 10, x + 30, 40), "crop", min_side_px=48) for x in range(6)]
    first = [picture.rgb for picture in pictures]
    assert pictures[-1].rgb is first[-1]
    assert later_picture._kept.bytes <= 80_000
    assert all(np.array_equal(picture.rgb, rgb) for picture, rgb in zip(pictures, first, strict=True))
    sheet = side_by_side((("now", (pictures[0],)),), "both")
    before = sheet.rgb
    assert [picture.rgb for picture in pictures]
    assert np.array_equal(sheet.rgb, before)


def test_a_changed_picture_has_its_own_pixels() -> None:
    picture = whole(Drawn().view, "top view")
    blank = replace(picture, rgb=np.zeros_like(picture.rgb))
    assert type(blank) is Picture
    assert not blank.rgb.any()
    assert picture.rgb.any()
    with pytest.raises(ValueError, match="but its frame says"):
        replace(picture, frame=crop(Drawn().view, Box(10, 10, 40, 40), "crop").frame)


def test_a_picture_is_named_by_its_view_and_its_window_without_being_made() -> None:
    one, same, other = (Drawn(seed).view for seed in (0, 0, 1))
    picture = whole(one, "top view")
    assert picture.source_hash == whole(same, "main view").marked(PointMark((3.0, 4.0))).source_hash
    assert not picture.made  # type: ignore[attr-defined]
    others = [whole(other, "a"), whole(one, "a", min_side_px=700), crop(one, Box(10, 10, 40, 40), "a")]
    sheet = side_by_side((("now", (crop(one, Box(10, 10, 40, 40), "crop"),)),), "both")
    named = {picture.source_hash, sheet.source_hash, *(item.source_hash for item in others)}
    assert len(named) == 5
    assert sheet.source_hash == sheet.hash
    own = replace(picture, rgb=picture.rgb)
    assert own.source_hash == own.hash == picture.hash


def test_pictures_of_one_window_are_the_same_without_being_drawn() -> None:
    one = Drawn()
    first, second = whole(one.view, "a"), whole(one.view.without_depth(), "b")
    assert same_pixels(first, second.marked(PointMark((1.0, 1.0))))
    assert one.count == 0


@pytest.mark.parametrize("enlarged", [False, True])
def test_pictures_of_other_looks_are_compared_by_what_these_saw(enlarged: bool) -> None:
    def shown(seed: int) -> Picture:
        view = Drawn(seed).view
        return crop(view, Box(10, 10, 40, 40), "crop") if enlarged else whole(view, "top view", min_side_px=48)

    assert same_pixels(shown(3), shown(3))
    assert not same_pixels(shown(3), shown(4))
    assert same_pixels(shown(3), replace(shown(3), name="stored"))
    assert not same_pixels(shown(3), replace(shown(4), name="stored"))


def test_the_same_pixels_at_another_place_of_a_view_are_the_same_picture() -> None:
    rgb = np.zeros((48, 64, 3), np.uint8)
    rgb[10:20, 10:20] = rgb[10:20, 40:50] = np.random.default_rng(1).integers(0, 255, (10, 10, 3), dtype=np.uint8)
    view = View("top", "top", 0.0, rgb)
    left, right, other = (crop(view, Box(x, 10, x + 10, 20), "crop", margin=0.0, min_side_px=40) for x in (10, 40, 25))
    assert left.size_px == right.size_px == other.size_px
    assert same_pixels(left, right) == (left.hash == right.hash)
    assert same_pixels(left, other) == (left.hash == other.hash)
