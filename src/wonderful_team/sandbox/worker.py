"""The pool of worker processes: started at first use, reused, closed when Python exits."""

from __future__ import annotations

import atexit
import datetime
import os
import queue
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import pydantic_monty

from wonderful_team.core import deadline
from wonderful_team.sandbox.errors import SandboxUnavailableError

T = TypeVar("T")

MEMORY_BYTES = 64 * 1024 * 1024
"""Most memory that a function may use; twenty points need a few kilobytes."""
RECURSION_DEPTH = 200
PRINTED_BYTES = 64 * 1024
"""Most text that a function may print; it is thrown away."""
CHECKOUT_TIMEOUT_S = 5.0
"""How long to wait for a free worker; they are started as needed."""
TURNS = 4
"""Programs in one session: the shapes, the code, the call, the description."""
GRACE_S = 10.0
"""Starting a worker and passing the work on, on a busy machine."""


@dataclass
class _Pool:
    """The pool of this process; a forked child keeps its parent's, uncollected and unused."""

    workers: Any = None
    process_id: int = 0
    forked: bool = False


_POOL = _Pool()
_LOCK = threading.Lock()


class WorkerLostError(Exception):
    """This program ended or blocked its worker, twice, while an empty program runs in the same place."""


def in_worker(run: Callable[[Any], T], timeout_s: float) -> T:
    """Call `run` with a fresh interpreter.

    A worker can be ended by something other than the code it runs (the system short of memory, a signal, a fork). So a lost worker
    is replaced and the program run once more, and the code is blamed only when it loses a second worker while an empty program
    keeps its own.

    Raises:
        WorkerLostError: Two workers were lost to this program.
        SandboxUnavailableError: An empty program does not run either.
    """
    try:
        return _once(run, timeout_s)
    except pydantic_monty.MontyCrashedError:
        pass
    except (OSError, pydantic_monty.MontyDisconnectError, pydantic_monty.MontyShutdown):
        close()
    _require_a_working_sandbox(timeout_s)
    try:
        return _once(run, timeout_s)
    except (OSError, pydantic_monty.MontyCrashedError) as lost:
        _require_a_working_sandbox(timeout_s)
        raise WorkerLostError(str(lost)) from lost


def _require_a_working_sandbox(timeout_s: float) -> None:
    """An empty program runs, at the second try at the latest: an idle worker that is gone is noticed when it is used."""
    for last in (False, True):
        try:
            _once(lambda interpreter: interpreter.feed_run("None", print_callback=discarded_output()), timeout_s)
            return
        except (OSError, pydantic_monty.MontyError) as error:
            close()
            if last:
                raise SandboxUnavailableError(
                    f"the sandbox does not run here, not even an empty program: {str(error)[:200]}. "
                    "`wonderful-team doctor` checks it; the package pydantic-monty must be installed with its program `monty`"
                ) from error


def _once(run: Callable[[Any], T], timeout_s: float) -> T:
    """One session, in a thread of its own: the library can block for ever on a worker that was stopped, deaf to Ctrl-C.

    Raises:
        TimeoutError: The library did not come back (an `OSError`); its pool is left behind and the next session starts another.
    """
    ended: queue.SimpleQueue[tuple[T | None, BaseException | None]] = queue.SimpleQueue()

    def attempt() -> None:
        try:
            with session(timeout_s) as interpreter:
                ended.put((run(interpreter), None))
        except BaseException as error:  # noqa: BLE001  handed to the caller's thread, whatever it is
            ended.put((None, error))

    threading.Thread(target=attempt, name="sandbox", daemon=True).start()
    longest_s = TURNS * timeout_s + GRACE_S
    try:
        value, error = ended.get(timeout=deadline.left_s(longest_s))
    except queue.Empty:
        _abandon()
        deadline.check("the helper function in the sandbox")
        raise TimeoutError(f"no answer from the sandbox's worker within {longest_s:g} s") from None
    if error is not None:
        raise error
    return value  # type: ignore[return-value]  # no error: it is the value of `run`


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


def without_value(code: str) -> str:
    """The same program without a value: that of its last line would be rebuilt here, as large as the worker's memory."""
    return f"{code}\nNone"


def discarded_output() -> Any:
    """A sink for what a function prints, so that it reaches nobody's terminal."""
    return pydantic_monty.CollectString(PRINTED_BYTES)


def _workers() -> Any:
    if _POOL.forked:
        raise SandboxUnavailableError(
            "the sandbox cannot run in a process that was forked after its parent had used the sandbox: start the process with "
            "multiprocessing's 'spawn' or 'forkserver' method, or fork before the first helper function runs"
        )
    with _LOCK:
        if _POOL.workers is None:
            workers = pydantic_monty.Monty(min_processes=1, checkout_timeout=CHECKOUT_TIMEOUT_S)
            workers.__enter__()
            _POOL.workers, _POOL.process_id = workers, os.getpid()
        return _POOL.workers


def close() -> None:
    """End the workers; the next run starts new ones."""
    with _LOCK:
        if _POOL.process_id != os.getpid():
            return
        workers, _POOL.workers = _POOL.workers, None
    if workers is not None:
        workers.__exit__(None, None, None)


def _abandon() -> None:
    """Leave a pool that does not answer: closing it would block too. It is kept from being collected, for the same reason."""
    with _LOCK:
        _ABANDONED.append(_POOL.workers)
        _POOL.workers = None


_ABANDONED: list[Any] = []


def _in_a_forked_child() -> None:
    """The threads that speak with the workers do not exist in a child, so asking would wait for ever; and the workers are its parent's."""
    global _LOCK
    _LOCK = threading.Lock()
    _POOL.forked = _POOL.forked or _POOL.workers is not None


atexit.register(close)
os.register_at_fork(after_in_child=_in_a_forked_child)
