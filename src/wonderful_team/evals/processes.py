"""Processes of a study: how they start, whatever script stands around them, and how they share the cores."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import types
from collections.abc import Iterator

THREADS = {
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OPENCV_FOR_THREADS_NUM"), "1"),
    # OpenGL without a graphics card: the thread that asks draws, with none beside it.
    "LP_NUM_THREADS": "0",
    # Each trial is a new thread. With heaps of their own, threads get memory from the system that another heap has free.
    "MALLOC_ARENA_MAX": "1",
}
"""Variables by which a worker takes one core: libraries that count and draw, and the C library's heap."""


def started_by_spawn() -> bool:
    """Whether this process is a worker that is just running its parent's script again."""
    return bool(getattr(multiprocessing.current_process(), "_inheriting", False))


@contextlib.contextmanager
def without_main() -> Iterator[None]:
    """Start a process that does not run the calling script again: it is told of an empty one."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextlib.contextmanager
def interrupts_held() -> Iterator[None]:
    """Start a process by spawn that no interrupt from the keyboard ends while it still loads: it inherits that they are held back.

    Where signals cannot be held back, nothing is done. The process begins with `leave_to_parent`.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # It is started with the first process otherwise, and lets signals come again when it has been.
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def leave_to_parent(*names: str) -> None:
    """Signals of these names reach all processes of a terminal: here they do nothing, an interrupt that was held back included."""
    for name in names:
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        # Programs that this process starts inherit what is held back.
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


@contextlib.contextmanager
def one_thread_each() -> Iterator[None]:
    """Processes share the cores: numeric libraries of a worker must not each take all of them."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(THREADS)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
