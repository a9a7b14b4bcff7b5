"""Memory between two pieces of work: what went round in circles is given back too."""

from __future__ import annotations

import gc
import weakref

from wonderful_team.core.heap import Growth


class Held:
    """Something that holds itself, as the objects of a trial do."""

    def __init__(self, size: int) -> None:
        self.me, self.data = self, bytes(size)


def test_circles_are_found_once_the_process_has_grown() -> None:
    gc.disable()
    try:
        growth = Growth(most_bytes=1)
        lost = weakref.ref(Held(1_000_000))
        assert lost() is not None
        growth.give_back()
        assert lost() is None
        little = Growth(most_bytes=10**12)
        kept = weakref.ref(Held(1_000))
        assert little.give_back() is False
        assert kept() is not None, "too little to look for"
    finally:
        gc.enable()
