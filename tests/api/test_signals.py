"""Signals that ask a program to end: what moves is stopped, the record is whole, the exit code is 128 + n; real processes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.desk import read_record
from tests.interrupting import listen
from wonderful_team.cli import app
from wonderful_team.core.interrupts import Interrupted, ends_on_signal, held

PATIENCE_S = 60


@pytest.fixture(autouse=True)
def _hearing() -> Iterator[None]:
    """Under `nohup` SIGHUP is ignored, and by every process that the tests start too."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


OWN = '''
"""A robot whose motion takes long, and that writes down what is done to it."""
import sys
import time
from pathlib import Path

import numpy as np

import wonderful_team as wt

LOG = Path(__file__).with_suffix(".log")


def note(text):
    with LOG.open("a") as log:
        log.write(text + "\\n")


class Slow:
    name = "arm"
    vocabulary = wt.PICK_PLACE
    limits = wt.Limits((0.25, -0.5, -0.01), (0.75, 0.5, 0.5))
    instruction = wt.Instruction("move it")

    def observe(self):
        return wt.Observation({"top": wt.View("top", "top", 0.0, np.full((64, 128, 3), 90, np.uint8))})

    def execute(self, action):
        note("moves")
        print("MOVES", flush=True)
        time.sleep(120)

    def stop(self):
        note("stop")

    def close(self):
        note("close")


class Stuck(Slow):
    def stop(self):
        note("stop")
        print("STOPS", flush=True)
        time.sleep(120)


class Fixed:
    name = "fixed"

    def decide(self, situation):
        step = wt.PickPlaceStep("G1", pick="T1", place=wt.At("T2"))
        return wt.Act((wt.PlannedAction(step, wt.PickPlace(np.array([0.5, 0.2, 0.0]), np.array([0.5, -0.2, 0.0]))),))


class Thinking:
    name = "thinking"

    def answer(self, request):
        print("ASKED", flush=True)
        time.sleep(120)


def in_python(world):
    try:
        wt.rollout(Fixed(), world)
    finally:
        world.close()


if __name__ == "__main__":
    in_python(Slow())
'''


@pytest.fixture
def own(tmp_path: Path) -> Path:
    path = tmp_path / "own.py"
    path.write_text(OWN, encoding="utf-8")
    return path


@pytest.fixture
def start() -> Iterator[object]:
    """Starts a program that listens to signals; what is left at the end of a test is ended."""
    started: list[subprocess.Popen[str]] = []

    def one(*argv: str, ignoring: tuple[int, ...] = ()) -> subprocess.Popen[str]:
        def prepare() -> None:
            listen()
            for number in ignoring:
                signal.signal(number, signal.SIG_IGN)

        process = subprocess.Popen(
            [sys.executable, *argv],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=dict(os.environ),
            preexec_fn=prepare,
        )
        started.append(process)
        return process

    yield one
    for process in started:
        if process.poll() is None:
            process.kill()
        with process:
            pass  # its pipes are closed


def until(process: subprocess.Popen[str], word: str) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        if line.strip() == word:
            return
    raise AssertionError(f"{word} never came: {process.stderr.read() if process.stderr else ''}")


def robot(own: Path, kind: str = "Slow") -> list[str]:
    return ["-m", "wonderful_team", "run", f"{own}:{kind}", "--method", f"{own}:Fixed"]


def noted(own: Path) -> list[str]:
    return own.with_suffix(".log").read_text(encoding="utf-8").split()


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_during_motion_stops_closes_and_records(name: str, own: Path, start, runs_folder: Path) -> None:
    number = getattr(signal, name)
    process = start(*robot(own))
    until(process, "MOVES")
    process.send_signal(number)
    _, told = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 128 + number
    assert noted(own) == ["moves", "stop", "close"]
    record = read_record(runs_folder / "latest")
    assert (record["state"], record["outcome"]["stage"]) == ("finished", "interrupted")
    assert name in record["outcome"]["reason"]
    assert len(record["planner"]["executions"]) == 1
    assert (runs_folder / "latest" / "page.html").is_file()
    assert f"interrupted by {name}" in told
    assert "Traceback" not in told


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_second_signal_ends_at_once(name: str, own: Path, start) -> None:
    process = start(*robot(own, "Stuck"))
    until(process, "MOVES")
    process.send_signal(signal.SIGTERM)
    until(process, "STOPS")
    process.send_signal(getattr(signal, name))
    assert process.wait(timeout=PATIENCE_S) == 128 + getattr(signal, name)


@pytest.mark.parametrize(("name", "code"), [("SIGINT", -signal.SIGINT), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_in_a_script_of_ones_own_it_ends_alike(name: str, code: int, own: Path, start, runs_folder: Path) -> None:
    process = start(str(own))
    until(process, "MOVES")
    process.send_signal(getattr(signal, name))
    process.communicate(timeout=PATIENCE_S)
    # Python itself ends with the signal when nobody catches KeyboardInterrupt.
    assert process.returncode == code
    assert noted(own) == ["moves", "stop", "close"]
    assert read_record(runs_folder / "latest")["outcome"]["stage"] == "interrupted"


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_while_a_model_thinks(name: str, own: Path, start, runs_folder: Path) -> None:
    process = start("-m", "wonderful_team", "run", "tabletop/rotate", "--model", f"{own}:Thinking")
    until(process, "ASKED")
    process.send_signal(getattr(signal, name))
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 128 + getattr(signal, name)
    assert read_record(runs_folder / "latest")["outcome"]["stage"] == "interrupted"


def test_a_signal_that_is_ignored_stays_ignored(own: Path, start) -> None:
    """Such as SIGHUP under nohup."""
    process = start(*robot(own), ignoring=(signal.SIGHUP,))
    until(process, "MOVES")
    process.send_signal(signal.SIGHUP)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 143


@pytest.mark.parametrize("after", ["model", "draft", "checked", "grounded", "actions", "gate"])
def test_ctrl_c_never_aborts_what_runs_in_native_code(after: str, start, runs_folder: Path) -> None:
    """OpenCV and the simulator are at work in threads of ours; taking them down in C++ would abort the process."""
    process = start("-m", "wonderful_team", "run", "tabletop/everyday/tidy_up", "--seed", "3")
    assert process.stderr is not None
    for line in process.stderr:
        if after in line.split():
            break
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, told
    for record in runs_folder.glob("*/record.json"):
        held = json.loads(record.read_text(encoding="utf-8"))
        assert held["state"] in ("finished", "interrupted")
        assert (record.parent / "page.html").is_file()


@pytest.mark.parametrize("later_s", [0.0, 0.05, 0.1, 0.2])
def test_ctrl_c_after_the_work_is_done(later_s: float, start) -> None:
    """The interpreter is being taken down then, in which a signal would kill the process."""
    process = start("-u", "-m", "wonderful_team", "run", "tabletop/rotate", "--seed", "3")
    assert process.stdout is not None
    assert any(line.startswith("page: ") for line in process.stdout)
    time.sleep(later_s)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=PATIENCE_S)
    assert process.returncode in (0, 130), told
    assert "Traceback" not in told


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_no_moment_between_the_work_and_the_end_has_pythons_own_handler(number: signal.Signals, start) -> None:
    """A command's own handling is over, and the program has not begun to leave."""
    program = (
        "import os, time\n"
        "from wonderful_team.core.interrupts import ends_on_signal, exits_at_once\n"
        "exits_at_once()\n"
        "with ends_on_signal(force=True):\n    pass\n"
        f"os.kill(os.getpid(), {int(number)})\n"
        "time.sleep(30)\n"
    )
    process = start("-c", program)
    _, told = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, told) == (128 + number, "")


def test_a_command_has_it_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """`main` says so before the command begins."""
    told: list[str] = []
    monkeypatch.setattr(app, "exits_at_once", lambda: told.append("exits at once"))
    monkeypatch.setattr(app, "run", lambda argv: told.append("runs") or 0)
    monkeypatch.setattr(app, "leave", lambda code: told.append("leaves"))
    monkeypatch.setattr(app, "redact_streams", lambda: None)
    app.main()
    assert told == ["exits at once", "runs", "leaves"]


@pytest.mark.parametrize("ignoring", [(), (signal.SIGINT,)], ids=["on a terminal", "in the background"])
def test_a_study_ends_with_the_signals_number(ignoring: tuple[int, ...], own: Path, start, tmp_path: Path) -> None:
    """A shell that runs a job in the background has it ignore Ctrl-C."""
    process = start(
        *("-m", "wonderful_team", "bench", "tabletop/rotate", "--model", f"{own}:Thinking", "--jobs", "1"),
        *("--no-control", "all", "--seeds", "0:1", "--store", str(tmp_path / "s.db"), "--trial-max-seconds", "20"),
        ignoring=ignoring,
    )
    until(process, "ASKED")
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 143


def test_within_held_a_signal_waits_and_then_is_raised() -> None:
    done = []

    def work() -> None:
        with ends_on_signal(force=True):
            with held():
                os.kill(os.getpid(), signal.SIGTERM)
                done.append("whole")
            done.append("never")

    with pytest.raises(Interrupted) as caught:
        work()
    assert done == ["whole"]
    assert (caught.value.name, caught.value.exit_code) == ("SIGTERM", 143)


def test_handlers_are_put_back() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    with ends_on_signal(force=True), ends_on_signal():
        assert signal.getsignal(signal.SIGTERM) != before[1]
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before
