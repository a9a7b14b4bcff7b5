"""Memory of long runs: what nobody holds any more goes back to the system."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any


def give_back_free_memory() -> bool:
    """Give the free pages of the heap back, where glibc is; whether it could.

    Large pictures come and go between small blocks that stay. By itself glibc gives back only what is free at the end of its
    heap, so that a study of hours holds several times what it uses.
    """
    trim = _malloc_trim()
    return trim is not None and bool(trim(0))


@cache
def _malloc_trim() -> Any:
    try:
        libc = ctypes.CDLL(None)
        libc.gnu_get_libc_version  # noqa: B018  other libraries have no such function
        return libc.malloc_trim
    except (OSError, AttributeError, TypeError):
        return None
