"""What was seen lately: looking twice at the same pixels costs nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import is_dataclass
from functools import wraps
from typing import Any, TypeVar

import numpy as np

from wonderful_team.core.heap import stay_low
from wonderful_team.core.kept import Kept
from wonderful_team.core.pictures import Picture

Seen = TypeVar("Seen")

MOST_BYTES = 32_000_000
"""Of what one way of looking keeps: about sixteen pictures of a megapixel, or the things of hundreds."""
_LEAST_BYTES = 1000


def recent(look: Callable[[Picture], Seen]) -> Callable[[Picture], Seen]:
    """Keep the last results of a look at a picture, as many as fit; marks and names do not count."""
    known: Kept[tuple[object, ...], tuple[Seen, int]] = Kept(MOST_BYTES, lambda held: held[1])

    @wraps(look)
    def see(picture: Picture) -> Seen:
        depth = None if picture.depth_m is None else hash(picture.depth_m.tobytes())
        key = (picture.hash, depth, picture.frame.valid.as_tuple, picture.frame.scale)
        held = known.get(key)
        if held is None:
            stay_low()
            seen = look(picture)
            held = known.keep(key, (seen, _LEAST_BYTES + array_bytes(seen)))
        return held[0]

    return see


def array_bytes(value: Any) -> int:
    """Bytes of all arrays that a value holds, in the fields of dataclasses too."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, (tuple, list)):
        return sum(map(array_bytes, value))
    if is_dataclass(value):
        return sum(map(array_bytes, vars(value).values()))
    return 0
