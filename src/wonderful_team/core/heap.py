"""Memory of long runs: what nobody holds any more goes back to the system."""

from __future__ import annotations

import ctypes
import gc
import os
import time
from functools import cache
from pathlib import Path
from typing import Any


def give_back_free_memory() -> bool:
    """Give the free pages of the heap back, where glibc is; whether it could.

    Large pictures come and go between small blocks that stay. By itself glibc gives back only what is free at the end of its
    heap, so that a study of hours holds several times what it uses.
    """
    trim = _malloc_trim()
    return trim is not None and bool(trim(0))


class Growth:
    """When free memory is given back in a process that does one piece of work after another.

    Getting the pages again takes time, more than giving them back: only what the process has grown by is worth that, and not
    after every few pieces of work that each need as much again.

    Args:
        most_bytes: What the process may grow by in between.
        apart_s: So much processor time lies in between at least [s], unless it has grown three times as much.
        own_process: Whether the process does nothing else: then what its first piece of work leaves behind, modules and
            caches, is not looked through again, which takes longest.
        circles: Whether objects that hold each other in circles are looked for first, which takes a tenth of a second.
        floor_bytes: A process that holds less gives nothing back.
    """

    def __init__(
        self,
        most_bytes: int = 200_000_000,
        apart_s: float = 5.0,
        own_process: bool = False,
        circles: bool = True,
        floor_bytes: int = 0,
    ) -> None:
        self._most, self._apart_s, self._own_process, self._circles = most_bytes, apart_s, own_process, circles
        self._floor = floor_bytes
        self._left = 0
        self._last_s: float | None = None

    def give_back(self) -> bool:
        """Give free memory back if the process has grown; whether it was worth it and there was a way."""
        held = _held_bytes()
        if held is not None:
            self._left = min(self._left, held)
            if held < self._floor or not self._is_due(held - self._left):
                return False
        # A piece of work may end with objects in circles: their pictures are free only once those are found.
        if self._circles:
            gc.collect()
        if self._own_process and self._last_s is None:
            gc.freeze()
        done = give_back_free_memory()
        self._left, self._last_s = _held_bytes() or 0, time.process_time()
        return done

    def _is_due(self, grown_bytes: int) -> bool:
        recent = self._last_s is not None and time.process_time() - self._last_s < self._apart_s
        return grown_bytes >= (3 if recent else 1) * self._most


HIGH_BYTES = 400_000_000
"""What a process may hold before free memory is given back in the middle of its work; getting the pages again takes time."""
STEP_BYTES = 32_000_000
_in_the_middle = Growth(STEP_BYTES, apart_s=0.0, circles=False, floor_bytes=HIGH_BYTES)


def stay_low() -> None:
    """Give free memory back in the middle of work that makes many large pictures, at every so many bytes more.

    Of a hundred crops that threads make at a time, no more than a few are held at once; glibc would keep room for most of them.
    """
    _in_the_middle.give_back()


def _held_bytes() -> int | None:
    """Memory that this process holds; None where the system does not say."""
    try:
        return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError, AttributeError):
        return None


@cache
def _malloc_trim() -> Any:
    try:
        libc = ctypes.CDLL(None)
        libc.gnu_get_libc_version  # noqa: B018  other libraries have no such function
        return libc.malloc_trim
    except (OSError, AttributeError, TypeError):
        return None
