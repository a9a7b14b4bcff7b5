"""What was seen lately: looking twice at the same pixels costs nothing."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from wonderful_team.core.pictures import Picture

Seen = TypeVar("Seen")


def recent(most: int) -> Callable[[Callable[[Picture], Seen]], Callable[[Picture], Seen]]:
    """Keep so many of the last results of a look at a picture; marks and names do not count."""

    def kept(look: Callable[[Picture], Seen]) -> Callable[[Picture], Seen]:
        known: OrderedDict[tuple[object, ...], Seen] = OrderedDict()
        lock = threading.Lock()

        @wraps(look)
        def see(picture: Picture) -> Seen:
            depth = None if picture.depth_m is None else hash(picture.depth_m.tobytes())
            key = (picture.hash, depth, picture.frame.valid.as_tuple, picture.frame.scale)
            with lock:
                if key in known:
                    known.move_to_end(key)
                    return known[key]
            seen = look(picture)
            with lock:
                known[key] = seen
                if len(known) > most:
                    known.popitem(last=False)
            return seen

        return see

    return kept
