"""Free memory goes back to the system where glibc is, and nothing happens where it is not."""

from __future__ import annotations

import ctypes

from wonderful_team.core import heap


def test_it_tells_whether_there_was_a_way():
    known = hasattr(ctypes.CDLL(None), "gnu_get_libc_version")
    heap.give_back_free_memory()
    assert (heap._malloc_trim() is not None) is known


def test_without_glibc_nothing_happens(monkeypatch):
    class Other:
        pass

    heap._malloc_trim.cache_clear()
    monkeypatch.setattr(heap.ctypes, "CDLL", lambda name: Other())
    try:
        assert heap.give_back_free_memory() is False
    finally:
        heap._malloc_trim.cache_clear()
