"""The last values that were made, as many as fit a number of bytes."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")


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

    def clear(self) -> None:
        """Let go of everything; nobody is told."""
        with self._lock:
            self._held.clear()
            self.bytes = 0
