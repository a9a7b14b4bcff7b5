"""One limit on the time of a whole run, asked by everything that may take long.

Code that is not ours (a world, a method, a scorer) and drawing run in a thread of the deadline, so that a call that does not come
back can be given up. Python cannot end a thread: the call is interrupted as soon as it runs Python code again, and what stays in
native code is left behind and ends with the program.
"""

from __future__ import annotations

import contextlib
import contextvars
import ctypes
import queue
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, TypeVar

from wonderful_team.core.interrupts import start_thread
from wonderful_team.errors import BudgetReached, ConfigError

T = TypeVar("T")

GRACE_S = 1.5
"""Beyond the limit there is this long, in all, to stop what moves, close it, and write record and page [s]."""
LEAST_S = 0.3
"""What each of these gets even when that is used up [s]."""
PART_S = 0.2
"""What a picture of the record gets beyond the limit [s]."""
UNWIND_S = 0.3
"""How long a call that was interrupted has to come back before it is left behind [s]."""
LEFT_BEHIND = "the call did not come back and is left behind: a thread cannot be ended, it ends with this program"


class _TimeIsUp(BaseException):
    """Raised inside a call that is given up; no `except Exception` of a user's code keeps it."""


class _Job:
    """One call in a thread of a deadline."""

    def __init__(self, function: Callable[..., Any], args: tuple[Any, ...]) -> None:
        self._context = contextvars.copy_context()
        self._function, self._args = function, args
        self.ended = threading.Event()
        self.result: Any = None
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self.result = self._context.run(self._function, *self._args)
        except BaseException as error:  # noqa: BLE001  handed to whoever waits
            self.error = error
        finally:
            self.ended.set()


class _Worker:
    """A thread that runs calls one after another: what belongs to one thread (a drawing context, a driver) stays there."""

    def __init__(self) -> None:
        self._jobs: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        self.thread = start_thread(self._serve, name="limited")

    def _serve(self) -> None:
        while True:
            with contextlib.suppress(_TimeIsUp):  # it may come late, when the call has ended
                job = self._jobs.get()
                if job is None:
                    return
                job.run()

    def start(self, job: _Job) -> None:
        self._jobs.put(job)

    def end(self) -> None:
        self.end_later()
        self.thread.join(LEAST_S)

    def end_later(self) -> None:
        """End once the call under way, if any, has come back."""
        self._jobs.put(None)

    def interrupt(self, job: _Job) -> bool:
        """Whether the call has ended, once it was told to."""
        if not job.ended.is_set() and self.thread.ident is not None:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.thread.ident), ctypes.py_object(_TimeIsUp))
        return job.ended.wait(UNWIND_S)


class Deadline:
    """The end of a run's time.

    Args:
        seconds: From now on.
        clock: Seconds, never going back.

    Raises:
        ConfigError: The limit is not positive.
    """

    def __init__(self, seconds: float, clock: Callable[[], float] = time.monotonic) -> None:
        if not seconds > 0:
            raise ConfigError(f"cap on seconds must be positive, got {seconds}")
        self.seconds = seconds
        self._clock = clock
        self._began = clock()
        self._worker: _Worker | None = None
        self._lock = threading.Lock()

    @property
    def left_s(self) -> float:
        """Seconds until the limit, never negative."""
        return max(0.0, self._began + self.seconds - self._clock())

    @property
    def passed(self) -> bool:
        return self.left_s == 0.0

    @property
    def ending_s(self) -> float:
        """Seconds that something may take which ends the run, beyond the limit too."""
        return max(LEAST_S, self._began + self.seconds + GRACE_S - self._clock())

    def reached(self, during: str, more: str = "") -> BudgetReached:
        """The error of this limit, for what was under way."""
        passed_s = self._clock() - self._began
        text = f"the cap of {self.seconds:g} s is reached ({passed_s:.1f} s passed) during {during}"
        return BudgetReached(f"{text}; {more}" if more else text)

    def check(self, during: str) -> None:
        """Raises BudgetReached once the limit has passed."""
        if self.passed:
            raise self.reached(during)

    def close(self) -> None:
        """End the thread of the calls, if it is free."""
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.end()

    def _is_here(self) -> bool:
        return self._worker is not None and self._worker.thread is threading.current_thread()

    def call(self, during: str, within_s: float, function: Callable[..., T], *args: Any) -> T:
        """What `function` returns, if it comes back within so many seconds.

        Raises:
            BudgetReached: It did not, or there is no time at all.
        """
        if self._is_here():
            return function(*args)
        if within_s <= 0:
            raise self.reached(during)
        with self._lock:
            if self._worker is None:
                self._worker = _Worker()
            worker = self._worker
        job = _Job(function, args)
        worker.start(job)
        try:
            came = job.ended.wait(within_s)
        except BaseException:
            # A signal: what runs there must not go on while the robot is being stopped.
            self._give_up(worker, job)
            raise
        if not came:
            back = self._give_up(worker, job)
            raise self.reached(during, "" if back else LEFT_BEHIND)
        if job.error is not None:
            raise job.error
        return job.result  # type: ignore[no-any-return]

    def _give_up(self, worker: _Worker, job: _Job) -> bool:
        """Interrupt a call; a thread that it does not leave is not used again. Whether it came back."""
        if worker.interrupt(job):
            return True
        with self._lock:
            if self._worker is worker:
                self._worker = None
        worker.end_later()
        return False


_CURRENT: contextvars.ContextVar[Deadline | None] = contextvars.ContextVar("deadline", default=None)


@contextlib.contextmanager
def limited(seconds: float | None, *, apart: bool = False) -> Iterator[Deadline | None]:
    """Within it everything of ours ends after so many seconds, and not later than what stands around it says.

    Args:
        seconds: None for no limit of its own.
        apart: Give it a thread of its own, as runs need that are under way at the same time.
    """
    around = _CURRENT.get()
    if around is not None:
        own_s = around.left_s if seconds is None else min(seconds, around.left_s)
        if not apart and (seconds is None or around.left_s <= seconds):
            yield around
            return
        seconds = max(own_s, 1e-3)
    if seconds is None:
        yield None
        return
    deadline = Deadline(seconds)
    token = _CURRENT.set(deadline)
    try:
        yield deadline
    finally:
        _CURRENT.reset(token)
        deadline.close()


def current() -> Deadline | None:
    """The deadline of the run under way; None without one."""
    return _CURRENT.get()


def left_s(most_s: float | None = None) -> float | None:
    """Seconds until the limit, at most `most_s`; None where neither is set."""
    deadline = current()
    if deadline is None:
        return most_s
    return deadline.left_s if most_s is None else min(most_s, deadline.left_s)


def check(during: str) -> None:
    """Raises BudgetReached once the limit of the run has passed."""
    deadline = current()
    if deadline is not None:
        deadline.check(during)


def _call(during: str, within_s: Callable[[Deadline], float], function: Callable[..., T], args: tuple[Any, ...]) -> T:
    deadline = current()
    return function(*args) if deadline is None else deadline.call(during, within_s(deadline), function, *args)


def bounded(during: str, function: Callable[..., T], *args: Any) -> T:
    """What `function` returns; with a limit it is given up when that passes.

    Raises:
        BudgetReached: The limit has passed.
    """
    return _call(during, lambda deadline: deadline.left_s, function, args)


def for_record(during: str, function: Callable[..., T], *args: Any) -> T:
    """The same for a part of the record: beyond the limit it gets little, so that the rest can be written."""
    return _call(during, lambda deadline: max(PART_S, deadline.left_s), function, args)


def to_end(during: str, function: Callable[..., T], *args: Any) -> T:
    """The same for what must be done at the end of a run: there is some time beyond the limit."""
    return _call(during, lambda deadline: deadline.ending_s, function, args)
