"""A picture as it is sent, drawn once: the cache, the recorder and the provider look at the same pixels."""

from __future__ import annotations

import threading
from weakref import WeakKeyDictionary

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.heap import stay_low
from wonderful_team.core.kept import KeptFor
from wonderful_team.core.pictures import Picture, picture_hash
from wonderful_team.images.axes import Ticks
from wonderful_team.images.draw import draw
from wonderful_team.images.png import fast_png

_KEPT_BYTES = 32_000_000
_drawn: KeptFor[Picture, Ticks, Array] = KeptFor(_KEPT_BYTES, lambda rgb: rgb.nbytes)
_lock = threading.Lock()
_hashes: WeakKeyDictionary[Picture, dict[Ticks, str]] = WeakKeyDictionary()


def drawn(picture: Picture, ticks: Ticks = Ticks.PIXELS) -> Array:
    """What `draw` makes of the picture, read-only, shape (H, W, 3), uint8; the last ones are kept."""
    if not picture.marks:
        return picture.rgb
    known = _drawn.get(picture, ticks)
    if known is not None:
        return known
    stay_low()
    made = draw(picture, ticks)
    made.setflags(write=False)
    return _drawn.keep(picture, ticks, made)


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
