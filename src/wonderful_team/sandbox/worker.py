"""The pool of worker processes: started at first use, reused, closed when Python exits."""

from __future__ import annotations

import atexit
import datetime
import os
import threading
from dataclasses import dataclass
from typing import Any

import pydantic_monty

MEMORY_BYTES = 64 * 1024 * 1024
"""Most memory that a function may use; twenty points need a few kilobytes."""
RECURSION_DEPTH = 200
PRINTED_BYTES = 64 * 1024
"""Most text that a function may print; it is thrown away."""
CHECKOUT_TIMEOUT_S = 60.0
"""How long to wait for a free worker."""


@dataclass
class _Pool:
    """The pool of this process; a forked child must not use its parent's workers."""

    workers: Any = None
    process_id: int = 0


_POOL = _Pool()
_LOCK = threading.Lock()


def session(timeout_s: float) -> Any:
    """A fresh interpreter in a warm worker, to be used as a context manager; nothing is left from earlier code.

    Sleeping is refused, because slept time is not counted as running time. Clock and randomness are fixed, so that a
    function gives the same path every time.
    """
    return _workers().checkout(
        script_name="path.py",
        limits={
            "max_feed_duration_secs": timeout_s,
            "max_turn_duration_secs": timeout_s,
            "max_memory": MEMORY_BYTES,
            "max_recursion_depth": RECURSION_DEPTH,
            "max_suspensions": 100,
            "max_total_sleep_secs": 0.0,
        },
        os_policy={"datetime": datetime.datetime(2000, 1, 1), "random_start": {"seed": 0}},  # noqa: DTZ001
    )


def discarded_output() -> Any:
    """A sink for what a function prints, so that it reaches nobody's terminal."""
    return pydantic_monty.CollectString(PRINTED_BYTES)


def _workers() -> Any:
    with _LOCK:
        if _POOL.workers is None or _POOL.process_id != os.getpid():
            workers = pydantic_monty.Monty(min_processes=1, checkout_timeout=CHECKOUT_TIMEOUT_S)
            workers.__enter__()
            _POOL.workers, _POOL.process_id = workers, os.getpid()
        return _POOL.workers


def close() -> None:
    """End the workers; the next run starts new ones."""
    with _LOCK:
        if _POOL.workers is not None and _POOL.process_id == os.getpid():
            _POOL.workers.__exit__(None, None, None)
        _POOL.workers = None


atexit.register(close)
