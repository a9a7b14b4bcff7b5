"""A picture as it is sent, drawn once: the cache, the recorder and the provider look at the same pixels."""

from __future__ import annotations

import threading
from weakref import WeakKeyDictionary

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, picture_hash
from wonderful_team.images.axes import Ticks
from wonderful_team.images.draw import draw
from wonderful_team.images.png import fast_png

_lock = threading.Lock()
_drawn: WeakKeyDictionary[Picture, dict[Ticks, Array]] = WeakKeyDictionary()
_hashes: WeakKeyDictionary[Picture, dict[Ticks, str]] = WeakKeyDictionary()


def drawn(picture: Picture, ticks: Ticks = Ticks.PIXELS) -> Array:
    """What `draw` makes of the picture, read-only, shape (H, W, 3), uint8; kept for as long as the picture lives."""
    if not picture.marks:
        return picture.rgb
    with _lock:
        known = _drawn.setdefault(picture, {}).get(ticks)
    if known is not None:
        return known
    made = draw(picture, ticks)
    made.setflags(write=False)
    with _lock:
        return _drawn.setdefault(picture, {}).setdefault(ticks, made)


def drawn_png(picture: Picture, ticks: Ticks = Ticks.PIXELS) -> bytes:
    """The PNG file of what `drawn` gives."""
    return fast_png(drawn(picture, ticks))


def drawn_hash(picture: Picture, ticks: Ticks = Ticks.PIXELS) -> str:
    """Hash of the drawn pixels: 16 hex digits."""
    if not picture.marks:
        return picture.hash
    with _lock:
        known = _hashes.setdefault(picture, {}).get(ticks)
    if known is not None:
        return known
    made = picture_hash(drawn(picture, ticks))
    with _lock:
        return _hashes.setdefault(picture, {}).setdefault(ticks, made)
