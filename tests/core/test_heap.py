"""Free memory goes back to the system where glibc is, and nothing happens where it is not."""

from __future__ import annotations

import ctypes
import gc
import weakref

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


def test_memory_is_given_back_once_a_process_has_grown(monkeypatch):
    held, given = [100], []
    monkeypatch.setattr(heap, "_held_bytes", lambda: held[0])

    def give_back():
        given.append(held[0])
        held[0] -= 20
        return True

    monkeypatch.setattr(heap, "give_back_free_memory", give_back)
    growth = heap.Growth(50, apart_s=0.0)
    assert growth.give_back(), "what was there before counts as grown"
    for now in (85, 110, 129):
        held[0] = now
        assert not growth.give_back()
    held[0] = 130
    assert growth.give_back()
    held[0] = 159
    assert not growth.give_back()
    assert given == [100, 130]


def test_large_work_gives_memory_back_at_every_step_once_much_is_held(monkeypatch):
    mega, held, given = 10**6, [100 * 10**6], []
    middle = heap.Growth(32 * mega, apart_s=0.0, circles=False, floor_bytes=256 * mega)
    monkeypatch.setattr(heap, "_in_the_middle", middle)
    monkeypatch.setattr(heap, "_held_bytes", lambda: held[0])

    def give_back():
        given.append(held[0] // mega)
        held[0] -= 10 * mega
        return True

    monkeypatch.setattr(heap, "give_back_free_memory", give_back)
    for now in (200, 250, 260, 270, 281, 282, 290, 305, 400):
        held[0] = now * mega
        heap.stay_low()
    assert given == [260, 282, 305, 400]


def test_what_each_piece_of_work_needs_again_is_not_given_back_after_each(monkeypatch):
    held, given, clock_s = [100], [], [0.0]
    monkeypatch.setattr(heap, "_held_bytes", lambda: held[0])
    monkeypatch.setattr(heap.time, "process_time", lambda: clock_s[0])
    monkeypatch.setattr(heap, "give_back_free_memory", lambda: bool(given.append(held[0])) or True)
    growth = heap.Growth(50, apart_s=5.0)
    assert growth.give_back()
    held[0], clock_s[0] = 200, 4.9
    assert not growth.give_back(), "grown enough, and too soon"
    held[0] = 250
    assert growth.give_back(), "three times as much does not wait"
    held[0], clock_s[0] = 300, 9.9
    assert growth.give_back()
    assert given == [100, 250, 300]


def test_where_the_system_does_not_say_memory_is_given_back_each_time(monkeypatch):
    given = []
    monkeypatch.setattr(heap, "_held_bytes", lambda: None)
    monkeypatch.setattr(heap, "give_back_free_memory", lambda: bool(given.append(1)) or True)
    growth = heap.Growth()
    assert growth.give_back()
    assert growth.give_back()
    assert len(given) == 2


def test_what_is_held_is_a_number_of_bytes_where_it_is_known():
    held = heap._held_bytes()
    assert held is None or held > 1_000_000


class Held:
    """Something that holds itself, as the objects of a trial do."""

    def __init__(self):
        self.me = self


def test_what_went_round_in_circles_is_given_back_too_once_a_process_has_grown():
    gc.disable()
    try:
        lost = weakref.ref(Held())
        little = heap.Growth(10**15)
        little.give_back()
        assert lost() is not None, "too little to look for"
        heap.Growth(1).give_back()
        assert lost() is None
    finally:
        gc.enable()


def test_where_circles_are_not_looked_for_free_memory_is_given_back_all_the_same(monkeypatch):
    given = []
    monkeypatch.setattr(heap, "give_back_free_memory", lambda: bool(given.append(1)) or True)
    gc.disable()
    try:
        lost = weakref.ref(Held())
        assert heap.Growth(1, circles=False).give_back()
        assert given == [1]
        assert lost() is not None
    finally:
        gc.enable()


def test_only_a_process_of_its_own_sets_aside_what_is_there_after_its_first_piece_of_work():
    before = gc.get_freeze_count()
    heap.Growth(1).give_back()
    assert gc.get_freeze_count() == before
    try:
        own = heap.Growth(1, own_process=True)
        own.give_back()
        assert gc.get_freeze_count() > before
    finally:
        gc.unfreeze()
