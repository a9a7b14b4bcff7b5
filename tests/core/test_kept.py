"""Caches of pictures hold so many bytes, however large one picture is."""

from __future__ import annotations

import gc
import weakref

import numpy as np

from tests.models.providers.asking import small_scene
from wonderful_team.core.kept import Kept, KeptFor
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


def test_what_is_dropped_is_no_longer_counted():
    kept: Kept[str, bytes] = Kept(10, len)
    kept.keep("a", bytes(4))
    kept.drop("a")
    kept.drop("never there")
    assert (kept.get("a"), kept.bytes) == (None, 0)


def test_what_was_made_of_an_object_does_not_keep_it_and_is_not_given_for_another():
    kept: KeptFor[np.ndarray, str, bytes] = KeptFor(10, len)
    image = np.zeros(3)
    assert kept.keep(image, "small", b"one") == b"one"
    assert kept.keep(image, "small", b"two") == b"one"
    assert (kept.get(image, "small"), kept.get(image, "large")) == (b"one", None)
    assert kept.get(np.zeros(3), "small") is None
    key, left = next(iter(kept._kept._held)), weakref.ref(image)
    del image
    gc.collect()
    assert left() is None
    # Another object may be given the id of one that is gone.
    other = np.zeros(3)
    (_, value) = kept._kept._held.pop(key)
    kept._kept._held[id(other), "small"] = (left, value)
    assert kept.get(other, "small") is None
    assert kept.keep(other, "small", b"new") == b"new"
    assert kept.get(other, "small") == b"new"
    assert kept.bytes == 3


def test_shown_pictures_stay_within_their_bytes():
    views = [small_scene(1600, 1200) for _ in range(8)]
    for view in views:
        picture = whole(view, "top view")
        shown, png = showing.show_encoded(picture)
        assert showing.show_encoded(picture)[1] is png
        assert np.array_equal(shown.rgb, shown.picture.rgb)
    assert showing._shown.bytes <= showing.KEPT_BYTES
