"""A signal is answered also where Python alone would let it lie: in a call that waits, and in native code that never ends."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from tests.interrupting import listen
from wonderful_team.core.interrupts import Interrupted, ends_on_signal

PATIENCE_S = 60
LONGER_S = 300
"""What waits in these tests would wait for so long by itself [s]."""

ELSEWHERE = """
import contextlib, signal, threading, time
from wonderful_team.core.interrupts import as_keyboard, ends_on_signal

def send():
    time.sleep(0.3)  # the main thread waits by then
    signal.pthread_kill(threading.get_ident(), {number})

with ends_on_signal(), {within}:
    threading.Thread(target=send, daemon=True).start()
    try:
        {waits}
    finally:
        print("STOPPED", flush=True)
"""

NATIVE = """
import contextlib, ctypes, os, signal, threading, time
from wonderful_team.core.interrupts import ends_on_signal

libc = ctypes.CDLL(None)
mutex = ctypes.create_string_buffer(64)
libc.pthread_mutex_lock(mutex)

def tell():
    # The system says on which address the main thread waits.
    while hex(ctypes.addressof(mutex)) not in open(f"/proc/self/task/{{os.getpid()}}/syscall").read():
        time.sleep(0.01)
    print("WAITS", flush=True)

with ends_on_signal(force=True):
    with contextlib.suppress(KeyboardInterrupt):
        {before}
    threading.Thread(target=tell, daemon=True).start()
    libc.pthread_mutex_lock(mutex)  # for ever, and no signal wakes it
"""

KEYWORD = """
import ctypes, time
from wonderful_team.core.interrupts import ends_on_signal

sends = ctypes.PyDLL(None)["raise"]
with ends_on_signal():
    sorted([{number}], key=sends)
    time.sleep({longer_s})
"""


@pytest.fixture
def start() -> Iterator[object]:
    """Starts a program that listens to interrupts; what is left at the end of a test is ended."""
    started: list[subprocess.Popen[str]] = []

    def one(program: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", program],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=listen,
        )
        started.append(process)
        return process

    yield one
    for process in started:
        if process.poll() is None:
            process.kill()
        with process:
            pass


@pytest.mark.parametrize("waits", ["time.sleep({})", "threading.Event().wait({})"], ids=["sleeps", "waits"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
def test_a_signal_that_arrives_in_another_thread_is_answered(number: signal.Signals, waits: str, start) -> None:
    """To the main thread it is like one that arrives just before it begins to wait."""
    process = start(
        ELSEWHERE.format(within="contextlib.nullcontext()", number=int(number), waits=waits.format(LONGER_S))
    )
    out, told = process.communicate(timeout=PATIENCE_S)
    assert out.split() == ["STOPPED"]
    # Python itself ends with the signal when nobody catches KeyboardInterrupt.
    assert process.returncode == (-signal.SIGINT if number == signal.SIGINT else 128 + number), told


def test_a_call_with_a_keyword_before_a_wait_hides_no_signal(start) -> None:
    """Python 3.14 does not look for signals after the first call with a keyword at a place."""
    process = start(KEYWORD.format(number=int(signal.SIGTERM), longer_s=LONGER_S))
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 128 + signal.SIGTERM


def test_a_second_signal_ends_native_code_that_no_signal_wakes(start) -> None:
    process = start(NATIVE.format(before="pass"))
    assert process.stdout.readline() == "WAITS\n"
    process.send_signal(signal.SIGTERM)
    assert "waiting for code that cannot be interrupted; once more ends at once" in process.stderr.readline()
    process.send_signal(signal.SIGHUP)
    assert process.wait(PATIENCE_S) == 128 + signal.SIGHUP


def test_so_does_a_second_one_after_the_first_was_answered(start) -> None:
    """Such as when the robot's own stop does not come back."""
    process = start(NATIVE.format(before="signal.raise_signal(signal.SIGINT)"))
    assert process.stdout.readline() == "WAITS\n"
    process.send_signal(signal.SIGTERM)
    assert process.wait(PATIENCE_S) == 128 + signal.SIGTERM


def test_in_a_study_a_signal_is_answered_too(start) -> None:
    """It has handlers of its own."""
    process = start(
        ELSEWHERE.format(within="as_keyboard()", number=int(signal.SIGTERM), waits=f"time.sleep({LONGER_S})")
    )
    out, told = process.communicate(timeout=PATIENCE_S)
    assert out.split() == ["STOPPED"]
    assert process.returncode == 128 + signal.SIGTERM, told


def test_a_signal_that_was_answered_is_not_followed_by_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """The call by which a driver stops its robot is not disturbed."""
    sent: list[int] = []
    monkeypatch.setattr(signal, "pthread_kill", lambda thread, number: sent.append(number))
    with ends_on_signal(force=True):
        with contextlib.suppress(Interrupted):
            os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.3)
    assert sent == []


def test_everything_is_put_back() -> None:
    with ends_on_signal(force=True):
        assert signal.getsignal(signal.SIGURG) != signal.SIG_DFL
    assert signal.getsignal(signal.SIGURG) == signal.SIG_DFL
    assert signal.set_wakeup_fd(-1) == -1
    until_s = time.monotonic() + PATIENCE_S
    while any(thread.name == "signals" for thread in threading.enumerate()):
        assert time.monotonic() < until_s
        time.sleep(0.01)


def test_what_the_program_uses_itself_stays_its_own() -> None:
    read, write = os.pipe()
    os.set_blocking(write, False)
    signal.set_wakeup_fd(write)
    try:
        with ends_on_signal(force=True):
            assert signal.getsignal(signal.SIGURG) == signal.SIG_DFL
        assert signal.set_wakeup_fd(-1) == write
    finally:
        signal.set_wakeup_fd(-1)
        os.close(read)
        os.close(write)


def test_a_forked_process_has_no_pipe_of_its_parents() -> None:
    with ends_on_signal(force=True):
        child = os.fork()
        if child == 0:
            os._exit(0 if signal.set_wakeup_fd(-1) == -1 else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
