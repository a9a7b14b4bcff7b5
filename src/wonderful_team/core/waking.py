"""Signals that Python has noted, but that the main thread does not come to answer.

Python answers a signal in the main thread between two of its own instructions. A system call that waits is woken by a
signal that arrives during it, not by one that arrived just before it or in another thread: then the signal lies there
until the call ends by itself. So a thread watches, and wakes the main thread with a signal that means nothing else.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import threading
import time
from collections.abc import Callable, Collection, Iterator
from io import FileIO
from types import FrameType

WAKE_S = 0.05
"""How long the main thread has to answer before it is woken, and then between one time and the next [s]."""
STUCK_S = 0.8
"""Not answering for so long, the main thread is in native code that cannot be woken [s]."""

_watched: _Watch | None = None


@contextlib.contextmanager
def wakes_main_thread(numbers: Collection[int], stuck: Callable[[int, bool], None]) -> Iterator[None]:
    """Within it the main thread answers these signals as soon as it can run Python code; called in the main thread.

    Does nothing where the program has Python tell it of signals already (`signal.set_wakeup_fd`), has a use of its own for
    SIGURG, or the system does not know that signal.

    Args:
        numbers: Signals that are handled in Python.
        stuck: Called from the watching thread with the signal, and whether it was not the first, when the main thread does
            not come to answer.
    """
    global _watched
    if not numbers or _watched is not None or not _free():
        yield
        return
    watch = _watched = _Watch(numbers, stuck)
    try:
        signal.signal(signal.SIGURG, watch.wakes)
        signal.set_wakeup_fd(watch.told, warn_on_full_buffer=False)
        watch.start()
        yield
    finally:
        _watched = None
        signal.signal(signal.SIGURG, signal.SIG_DFL)
        now = signal.set_wakeup_fd(-1)
        if now not in (-1, watch.told):
            signal.set_wakeup_fd(now)
        watch.end()


def _free() -> bool:
    """Whether the program makes no use of its own of what the watch takes."""
    if not hasattr(signal, "SIGURG") or signal.getsignal(signal.SIGURG) != signal.SIG_DFL:
        return False
    told = signal.set_wakeup_fd(-1)
    if told != -1:
        signal.set_wakeup_fd(told)
    return told == -1


def answered() -> None:
    """The main thread has come to a signal: called by what handles it."""
    if _watched is not None:
        _watched.answers += 1


def _in_child() -> None:
    """A forked process has the pipe of its parent, which its own signals are not to reach."""
    global _watched
    if _watched is not None:
        _watched = None
        with contextlib.suppress(ValueError):  # it goes on in another thread than the main one
            signal.set_wakeup_fd(-1)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_in_child)


class _Watch:
    """Reads the signals as the interpreter notes them, in whatever thread they arrive."""

    def __init__(self, numbers: Collection[int], stuck: Callable[[int, bool], None]) -> None:
        self._numbers, self._stuck = frozenset(numbers), stuck
        self._main = threading.get_ident()
        self._read, self.told = os.pipe()
        os.set_blocking(self.told, False)
        self.answers = 0
        self.wakings = 0

    def start(self) -> None:
        threading.Thread(target=self._run, name="signals", daemon=True).start()

    def end(self) -> None:
        """The thread ends as soon as it reads the end of the pipe."""
        os.close(self.told)

    def wakes(self, number: int, frame: FrameType | None) -> None:
        """What the main thread does when it is woken, after it has answered every other signal."""
        self.wakings += 1

    def _run(self) -> None:
        asked = 0
        with open(self._read, "rb", buffering=0) as told:
            while numbers := told.read(64):
                came = self._ending(numbers)
                asked += len(came)
                if came and not self._until_answered(told, asked, came[-1], again=len(came) > 1):
                    return
                # One that came twice before it was answered is answered once; nor does every handler count.
                asked = self.answers

    def _until_answered(self, told: FileIO, asked: int, number: int, *, again: bool) -> bool:
        """Wake the main thread until it has answered; False when the watch is over."""
        since, wakings, stuck = time.monotonic(), self.wakings, False
        # The first of two wakings may be a late one of the time before.
        while self.answers < asked and self.wakings < wakings + 2:
            if select.select([told], [], [], WAKE_S)[0]:
                numbers = told.read(64)
                if not numbers:
                    return False
                if came := self._ending(numbers):
                    asked, number, again = asked + len(came), came[-1], True
                    since, stuck = time.monotonic(), False
                continue
            with contextlib.suppress(OSError):
                signal.pthread_kill(self._main, signal.SIGURG)
            if not stuck and time.monotonic() - since > STUCK_S:
                stuck = True
                self._stuck(number, again)
        return True

    def _ending(self, numbers: bytes) -> list[int]:
        return [number for number in numbers if number in self._numbers]
