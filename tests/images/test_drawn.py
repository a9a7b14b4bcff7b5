"""Drawn once: the same pixels as `draw`, shared by whoever sends, keeps or compares the picture."""

from __future__ import annotations

import gc
import weakref

import numpy as np

from wonderful_team.core.geometry import Frame
from wonderful_team.core.kept import KeptFor
from wonderful_team.core.pictures import Axes, Picture, picture_hash
from wonderful_team.images import Ticks, draw
from wonderful_team.images.drawn import drawn, drawn_hash


def _picture(*marks):
    return Picture("view", np.full((200, 300, 3), 90, np.uint8), Frame.whole("view", (300, 200)), None, marks)


def test_it_is_what_draw_makes_for_each_kind_of_tick():
    picture = _picture(Axes())
    for ticks in Ticks:
        assert np.array_equal(drawn(picture, ticks), draw(picture, ticks))
        assert drawn_hash(picture, ticks) == picture_hash(draw(picture, ticks))
    assert drawn_hash(picture, Ticks.PIXELS) != drawn_hash(picture, Ticks.THOUSANDTHS)


def test_it_is_drawn_once_read_only_and_does_not_keep_the_picture(monkeypatch):
    calls = []
    monkeypatch.setattr("wonderful_team.images.drawn.draw", lambda *args: calls.append(args) or draw(*args))
    picture = _picture(Axes())
    first = drawn(picture)
    assert drawn(picture) is first
    assert len(calls) == 1
    assert not first.flags.writeable
    left = weakref.ref(picture)
    calls.clear()
    del picture
    gc.collect()
    assert left() is None


def test_no_more_is_kept_than_fits(monkeypatch):
    monkeypatch.setattr("wonderful_team.images.drawn._drawn", KeptFor(500_000, lambda rgb: rgb.nbytes))
    pictures = [_picture(Axes()) for _ in range(6)]
    first = [drawn(picture) for picture in pictures]
    assert drawn(pictures[-1]) is first[-1]
    again = drawn(pictures[0])
    assert again is not first[0]
    assert np.array_equal(again, first[0])


def test_a_picture_without_marks_is_not_drawn():
    picture = _picture()
    assert drawn(picture) is picture.rgb
    assert drawn_hash(picture) == picture.hash
