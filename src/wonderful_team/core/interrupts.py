"""Signals that ask a program to end (SIGINT, SIGTERM, SIGHUP), and threads that must not be torn down in native code.

The first signal raises `Interrupted` in the main thread, wherever it is, so that what moves is stopped and what was
recorded is kept. The second one ends the process at once.
"""

from __future__ import annotations

import atexit
import contextlib
import contextvars
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any, NoReturn

from wonderful_team.core.waking import answered, wakes_main_thread

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
TEARDOWN_S = 2.0
"""Longest wait for threads in native code when the interpreter ends [s]."""


class Interrupted(KeyboardInterrupt):
    """A signal asked the program to end."""

    def __init__(self, number: int) -> None:
        self.number = int(number)
        super().__init__(f"interrupted by {self.name}")

    @property
    def name(self) -> str:
        """Such as SIGTERM."""
        return signal.Signals(self.number).name

    @property
    def exit_code(self) -> int:
        """128 + the signal's number, as shells have it: 130, 143, 129."""
        return 128 + self.number


class _State:
    """Signals belong to the process, so there is one."""

    def __init__(self) -> None:
        self.active = False
        self.force = False
        self.came: int | None = None
        self.pending: int | None = None
        self.holding = 0


_state = _State()


@contextlib.contextmanager
def ends_on_signal(*, force: bool = False) -> Iterator[None]:
    """Within it the first signal raises `Interrupted` (Ctrl-C outside of a command line: `KeyboardInterrupt`) in the main thread.

    Signals that the program handles or ignores already (nohup, a background job) stay as they are. Does nothing in
    another thread or inside itself.

    Args:
        force: A second signal ends the process at once (a command line). Otherwise it raises again (a notebook).

    Raises:
        Interrupted: A signal came.
        SystemExit: SIGTERM or SIGHUP came and nobody further out understands `Interrupted`; its code is 128 + n.
    """
    if _state.active or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    ours = [number for number in SIGNALS if before[number] in _UNHANDLED]
    _state.active, _state.force, _state.came, _state.pending, _state.holding = True, force, None, None, 0
    for number in ours:
        signal.signal(number, _on_signal)
    try:
        with wakes_main_thread(ours, _stuck):
            yield
    except Interrupted as error:
        if force:
            raise
        raise SystemExit(error.exit_code) from error
    finally:
        for number in ours:
            signal.signal(number, before[number])
        _state.active = False


@contextlib.contextmanager
def held() -> Iterator[None]:
    """A signal that comes within is raised at the end of it: for a short piece of work that must stay whole."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _state.holding += 1
    try:
        yield
    finally:
        _state.holding -= 1
        if _state.holding == 0 and _state.pending is not None:
            number, _state.pending = _state.pending, None
            raise _interruption(number)


@contextlib.contextmanager
def as_keyboard() -> Iterator[None]:
    """Within it SIGTERM and SIGHUP do what Ctrl-C does in plain Python, each time: for work that ends in steps."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}

    def as_interrupt(number: int, frame: FrameType | None) -> None:
        answered()
        _state.came = number
        handler = signal.getsignal(signal.SIGINT)
        # A background job has Ctrl-C ignored, and yet it ends when it is asked to.
        answer = handler if callable(handler) else signal.default_int_handler
        answer(signal.SIGINT, frame)

    for number in SIGNALS:
        if before[number] not in (signal.SIG_IGN, None):
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else as_interrupt)
    try:
        yield
    except KeyboardInterrupt as error:
        raise Interrupted(_state.came or signal.SIGINT) from error
    finally:
        for number, handler in before.items():
            if handler is not None:
                signal.signal(number, handler)


def exit_code() -> int:
    """128 + the number of the signal that came last; that of Ctrl-C where none is known."""
    return 128 + (_state.came or signal.SIGINT)


def exits_at_once() -> None:
    """From now on a signal that nothing else handles ends the program at once, with 128 + its number and no traceback.

    What `ends_on_signal` restores at its end is this, so there is no moment between the work and the program's end in which
    Python's own answer to a signal holds.
    """
    for number in SIGNALS:
        if signal.getsignal(number) in _UNHANDLED:
            signal.signal(number, _at_once)


def _at_once(number: int, frame: FrameType | None) -> None:
    os._exit(128 + number)


_UNHANDLED = (signal.SIG_DFL, signal.default_int_handler, _at_once)
"""What signals do before anything of ours handles them."""


def _on_signal(number: int, frame: FrameType | None) -> None:
    answered()
    if _state.came is not None and _state.force:
        os._exit(128 + number)
    _state.came = number
    if _state.force:
        _say(f"{signal.Signals(number).name}: stopping, and keeping what was recorded; once more ends at once\n")
    if _state.holding and _state.pending is None:
        _state.pending = number
        return
    _state.pending = None
    raise _interruption(number)


def _stuck(number: int, again: bool) -> None:
    """The main thread is in native code that no signal wakes: a second signal ends the process all the same."""
    if not _state.force:
        return
    if again or _state.came is not None:
        os._exit(128 + number)
    _say(f"{signal.Signals(number).name}: waiting for code that cannot be interrupted; once more ends at once\n")


def _interruption(number: int) -> KeyboardInterrupt:
    """Python ends a script with Ctrl-C's own exit code only for a plain KeyboardInterrupt."""
    named = Interrupted(number)
    return KeyboardInterrupt(str(named)) if number == signal.SIGINT and not _state.force else named


def _say(text: str) -> None:
    """Past Python's buffers, which the interrupted code may hold; a terminal that is gone does not matter."""
    with contextlib.suppress(OSError):
        os.write(2, text.encode())


# -- threads in native code ----------------------------------------------------------------------------------------

_threads: list[threading.Thread] = []


def start_thread(target: Callable[..., Any], *args: Any, name: str) -> threading.Thread:
    """Start a daemon thread whose work may be in native code (OpenCV, a simulator) when the program ends.

    Python ends such a thread by unwinding it when it comes back from native code while the interpreter is being taken
    down; through C++ that aborts the whole process. So the end of the interpreter waits for these threads a little,
    and `leave` does without taking the interpreter down.
    """
    thread = threading.Thread(target=target, args=args, name=name, daemon=True)
    _threads[:] = [one for one in _threads if one.is_alive()]
    _threads.append(thread)
    thread.start()
    return thread


async def in_thread(function: Callable[..., Any], *args: Any, name: str) -> Any:
    """Like asyncio.to_thread, but a call that hangs never keeps the program from ending (Ctrl-C, a deadline)."""
    import asyncio  # a command that calls nothing starts without it

    loop = asyncio.get_running_loop()
    future: asyncio.Future[Any] = loop.create_future()

    def settle(result: Any, error: BaseException | None) -> None:
        if future.cancelled():
            return
        if error is None:
            future.set_result(result)
        else:
            future.set_exception(error)

    def work() -> None:
        result, failed = None, None
        try:
            result = function(*args)
        except BaseException as error:  # noqa: BLE001  handed to whoever waits
            failed = error
        with contextlib.suppress(RuntimeError):
            # The loop may have ended meanwhile: then nobody waits any more.
            loop.call_soon_threadsafe(settle, result, failed)

    start_thread(contextvars.copy_context().run, work, name=name)
    return await future


def _wait_for_threads() -> None:
    until = time.monotonic() + TEARDOWN_S
    for thread in list(_threads):
        thread.join(max(0.0, until - time.monotonic()))


atexit.register(_wait_for_threads)


def leave(code: int) -> NoReturn:
    """End the program with this exit code, also while threads are still in native code.

    Python's own taking down of the interpreter, during which a signal kills it whatever the program has set, is left out.
    """
    exits_at_once()
    if not any(thread.is_alive() for thread in _threads):
        # Threads of the user's own code are waited for, as Python does.
        threading._shutdown()  # type: ignore[attr-defined]
    atexit.unregister(_wait_for_threads)
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)
