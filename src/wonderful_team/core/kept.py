"""The last values that were made, as many as fit a number of bytes."""

from __future__ import annotations

import threading
import weakref
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
S = TypeVar("S")


class Kept(Generic[K, V]):
    """A cache that is bounded by what it holds, not by how many: one photo may be as large as a hundred crops.

    Args:
        most_bytes: Of all values together; the one used longest ago goes first, the newest always stays.
        size: How many bytes a value has.
        dropped: Told of every value that goes.
    """

    def __init__(
        self, most_bytes: int, size: Callable[[V], int], dropped: Callable[[K, V], object] | None = None
    ) -> None:
        self._most, self._size, self._dropped = most_bytes, size, dropped
        self._held: OrderedDict[K, V] = OrderedDict()
        self._lock = threading.Lock()
        self.bytes = 0

    def get(self, key: K) -> V | None:
        """What is kept under a key; it then counts as just used."""
        with self._lock:
            if key not in self._held:
                return None
            self._held.move_to_end(key)
            return self._held[key]

    def keep(self, key: K, value: V) -> V:
        """Keep a value, and return what is kept under its key: the first of several that were made at once."""
        with self._lock:
            known = self._held.setdefault(key, value)
            if known is value:
                self.bytes += self._size(value)
            while self.bytes > self._most and len(self._held) > 1:
                oldest, gone = self._held.popitem(last=False)
                self.bytes -= self._size(gone)
                if self._dropped is not None:
                    self._dropped(oldest, gone)
            return known

    def drop(self, key: K) -> None:
        """Let go of what is kept under a key, if anything is; nobody is told."""
        with self._lock:
            if key in self._held:
                self.bytes -= self._size(self._held.pop(key))

    def clear(self) -> None:
        """Let go of everything; nobody is told."""
        with self._lock:
            self._held.clear()
            self.bytes = 0


class KeptFor(Generic[S, K, V]):
    """The last values that were made of objects, such as of an image: within a number of bytes, and without keeping the objects alive.

    Args:
        most_bytes: Of all values together.
        size: How many bytes a value has.
    """

    def __init__(self, most_bytes: int, size: Callable[[V], int]) -> None:
        self._kept: Kept[tuple[int, K], tuple[weakref.ref[S], V]] = Kept(most_bytes, lambda held: size(held[1]))

    @property
    def bytes(self) -> int:
        """Of all that is kept."""
        return self._kept.bytes

    def get(self, source: S, key: K) -> V | None:
        """What was made of this very object; it then counts as just used."""
        held = self._kept.get((id(source), key))
        return held[1] if held is not None and held[0]() is source else None

    def keep(self, source: S, key: K, value: V) -> V:
        """Keep a value, and return what is kept: the first of several that were made at once."""
        place, own = (id(source), key), (weakref.ref(source), value)
        held = self._kept.keep(place, own)
        if held[0]() is not source:
            # The id was that of an object that is gone.
            self._kept.drop(place)
            held = self._kept.keep(place, own)
        return held[1]
