"""What leaves the sandbox is short text, whatever the code returned; a lost worker is replaced and not blamed on the code."""

from __future__ import annotations

import os
import random
import resource
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from tests.sandbox.programs import BOXES, LARGE, OVERRIDES, body, program, ran
from wonderful_team.sandbox import SandboxError, SandboxUnavailableError, run_path, run_program, worker
from wonderful_team.sandbox.returned import MAX_ERROR_CHARACTERS, parsed

GOOD = "def path(boxes):\n    return [(1, 2), (3, 4)]"


def most_memory_kb() -> int:
    """The most that this process has ever held [kB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@pytest.mark.parametrize("code", LARGE)
def test_no_returned_value_or_error_text_is_large_here(code: str) -> None:
    before = most_memory_kb()
    with pytest.raises(SandboxError) as caught:
        run_path(code, BOXES)
    assert len(str(caught.value)) < MAX_ERROR_CHARACTERS + 400
    # The worst of these needed gigabytes when the value itself was passed on.
    assert most_memory_kb() - before < 512 * 1024


@pytest.mark.parametrize("last", ["'x' * 3_000_000", "list(range(1000))", "path", "1 # 2"])
def test_no_value_of_a_last_line_leaves_the_worker(last: str, monkeypatch: pytest.MonkeyPatch) -> None:
    left: list[object] = []

    class Watched:
        def __init__(self, inner: Any) -> None:
            self.inner = inner

        def feed_run(self, *given: Any, **more: Any) -> object:
            left.append(self.inner.feed_run(*given, **more))
            return left[-1]

    once = worker._once
    monkeypatch.setattr(worker, "_once", lambda run, timeout_s: once(lambda one: run(Watched(one)), timeout_s))
    assert run_path(f"{GOOD}\n{last}", BOXES) == ((1.0, 2.0), (3.0, 4.0))
    assert run_program(f"path = print\n{last}", {}).calls == ()
    assert all(value is None for value in left)


@pytest.mark.parametrize("override", OVERRIDES)
def test_code_that_redefines_the_describing_words_gains_nothing(override: str) -> None:
    for returned in ("3", "[(1, 2), (3, 4)]", "[[1, 'a'], {}]"):
        try:
            points = run_path(f"{override}\n" + body(f"return {returned}"), BOXES)
        except SandboxError:
            continue
        assert points == ((1.0, 2.0), (3.0, 4.0))


@pytest.mark.parametrize("seed", range(40))
def test_harm_of_several_kinds_comes_to_points_or_a_named_error(seed: int) -> None:
    code = program(random.Random(seed))
    # A loaded machine may take its time; the benchmark holds it to two seconds.
    assert ran(code, over_s=60.0).wrong == [], code


@pytest.mark.parametrize(
    "text",
    ["", "point 1 2", "point 1 2\npoint 1", "point 1 2\npoint nan 2", "point 1 2\npoint 1e9 2", "a\nb", "[[" * 9000],
)
def test_a_description_is_untrusted(text: str) -> None:
    with pytest.raises(SandboxError):
        parsed(text, 20)


def _workers() -> list[int]:
    """Process ids of the workers of this process."""
    mine = str(os.getpid())
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                after_name = (folder / "stat").read_text().rpartition(")")[2].split()
                name = (folder / "comm").read_text().strip()
            except OSError:
                continue
            if name == "monty" and after_name[1] == mine and after_name[0] != "Z":
                found.append(int(folder.name))
    return found


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds the workers through /proc")
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_an_idle_worker_that_was_killed_or_stopped_is_replaced(
    how: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "GRACE_S", 3.0)
    run_path(GOOD, BOXES)
    stopped = _workers()
    assert stopped
    for worker_id in stopped:
        os.kill(worker_id, how)
    try:
        assert run_path(GOOD, BOXES, timeout_s=0.5) == ((1.0, 2.0), (3.0, 4.0))
    finally:
        for worker_id in stopped:
            try:
                os.kill(worker_id, signal.SIGKILL)
            except ProcessLookupError:
                pass


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds the workers through /proc")
def test_a_worker_that_is_killed_while_it_runs_is_not_blamed_on_the_code() -> None:
    run_path(GOOD, BOXES)
    known = _workers()
    slow = body("total = 0", "for i in range(3_000_000):", "    total += i", "return [(1, 2), (3, 4)]")
    timer = threading.Timer(0.1, lambda: [os.kill(worker_id, signal.SIGKILL) for worker_id in known])
    timer.start()
    assert run_path(slow, BOXES, timeout_s=20) == ((1.0, 2.0), (3.0, 4.0))
    timer.join()


def test_a_sandbox_that_cannot_start_is_no_error_of_the_code(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(timeout_s: float) -> object:
        raise FileNotFoundError("could not locate the `monty` binary")

    monkeypatch.setattr(worker, "session", broken)
    with pytest.raises(SandboxUnavailableError, match="not even an empty program.*monty") as caught:
        run_path(GOOD, BOXES)
    assert not isinstance(caught.value, SandboxError)
    assert caught.value.exit_code == 2


def test_a_forked_child_refuses_at_once_and_its_parent_goes_on() -> None:
    """In a process of its own: forking a process that has threads is what is tried here, and is no habit for a test run."""
    program = """
import os
from wonderful_team.sandbox import SandboxUnavailableError, run_path
GOOD = "def path(boxes):\\n    return [(1, 2), (3, 4)]"
run_path(GOOD, {})
child = os.fork()
if child == 0:
    try:
        run_path(GOOD, {})
    except SandboxUnavailableError as error:
        os._exit(0 if "spawn" in str(error) else 8)
    os._exit(9)
_, status = os.waitpid(child, 0)
assert os.waitstatus_to_exitcode(status) == 0, status
assert run_path(GOOD, {}) == ((1.0, 2.0), (3.0, 4.0))
print("both")
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert ended.stdout.strip() == "both", ended.stderr


def test_a_process_forked_before_the_first_run_has_workers_of_its_own() -> None:
    program = """
import os
from wonderful_team.sandbox import run_path
GOOD = "def path(boxes):\\n    return [(1, 2), (3, 4)]"
child = os.fork()
ok = run_path(GOOD, {}) == ((1.0, 2.0), (3.0, 4.0))
if child == 0:
    os._exit(0 if ok else 9)
_, status = os.waitpid(child, 0)
assert ok and os.waitstatus_to_exitcode(status) == 0, status
print("both")
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert ended.stdout.strip() == "both", ended.stderr
