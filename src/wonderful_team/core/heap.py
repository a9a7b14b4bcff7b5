"""Memory of long runs: what nobody holds any more goes back to the system."""

from __future__ import annotations

import ctypes
import gc
import os
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

    Looking through objects and heap after each takes time, and so does getting the pages again; only what it has grown by is worth that.

    Args:
        most_bytes: What the process may grow by in between.
    """

    def __init__(self, most_bytes: int = 200_000_000) -> None:
        self._most = most_bytes
        self._left = 0

    def give_back(self) -> bool:
        """Give free memory back if the process has grown; whether it was worth it and there was a way."""
        held = _held_bytes()
        if held is not None and held - self._left < self._most:
            return False
        # A piece of work ends with its objects in circles: their pictures are free only once those are found.
        gc.collect()
        done = give_back_free_memory()
        self._left = _held_bytes() or 0
        return done


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
