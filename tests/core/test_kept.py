"""Caches of pictures hold so many bytes, however large one picture is."""

from __future__ import annotations

import numpy as np

from tests.models.providers.asking import small_scene
from wonderful_team.core.kept import Kept
from wonderful_team.images import whole
from wonderful_team.models.wire import showing


def test_the_one_used_longest_ago_goes_first_and_the_newest_stays():
    kept: Kept[str, bytes] = Kept(10, len)
    for name in "abc":
        kept.keep(name, bytes(4))
        kept.get("a")
    assert (kept.get("a"), kept.get("b"), kept.get("c")) == (bytes(4), None, bytes(4))
    kept.keep("large", bytes(100))
    assert (kept.get("a"), kept.get("large")) == (None, bytes(100))
    assert kept.bytes == 100


def test_the_first_of_two_made_at_once_is_kept():
    kept: Kept[str, list[int]] = Kept(10, len)
    first = kept.keep("a", [1])
    assert kept.keep("a", [2]) is first
    assert kept.bytes == 1


def test_shown_pictures_stay_within_their_bytes():
    views = [small_scene(1600, 1200) for _ in range(8)]
    for view in views:
        picture = whole(view, "top view")
        shown, png = showing.show_encoded(picture)
        assert showing.show_encoded(picture)[1] is png
        assert np.array_equal(shown.rgb, shown.picture.rgb)
    assert showing._shown.bytes <= showing.KEPT_BYTES
