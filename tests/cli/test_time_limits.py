"""`--max-seconds` ends everything: a world, a method, drawing, a server's list of models, a study; the record is whole.

No test asserts a short time: what would hang without the limit would hang for ever.
"""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.desk import read_record
from wonderful_team.cli.app import run

PATIENCE_S = 120
LIMIT = "2"
"""Long enough that a run reaches what is tested on a machine that is busy with other work."""
DESK = str(Path(__file__).parents[2] / "examples" / "desk.png")
OWN = '''
import time
from pathlib import Path

import numpy as np

import wonderful_team as wt

LOG = Path(__file__).with_suffix(".log")


def note(text):
    with LOG.open("a") as log:
        log.write(text + "\\n")


class Fine:
    vocabulary = wt.PICK_PLACE
    limits = wt.Limits((0.25, -0.5, -0.01), (0.75, 0.5, 0.5))
    instruction = wt.Instruction("move it")

    def observe(self):
        return wt.Observation({"top": wt.View("top", "top", 0.0, np.full((64, 128, 3), 90, np.uint8))})

    def execute(self, action):
        note("moves")
        return wt.StepReport(action, executed=True)

    def stop(self):
        note("stop")

    def close(self):
        note("close")


class Stuck(Fine):
    """Its motion never ends."""
    def execute(self, action):
        note("moves")
        time.sleep(100_000)


class Swallowing(Fine):
    """Its motion never ends, and nothing that is raised in it gets out."""
    def execute(self, action):
        note("moves")
        while True:
            try:
                time.sleep(0.01)
            except BaseException:
                pass


class Blind(Fine):
    """Its camera never answers."""
    def observe(self):
        time.sleep(100_000)


class NeverStops(Stuck):
    def stop(self):
        note("stop")
        time.sleep(100_000)

    def close(self):
        note("close")
        time.sleep(100_000)


class Unmade(Fine):
    def __init__(self):
        time.sleep(100_000)


class Endless:
    """Moves and moves."""
    name = "endless"
    chunks = True

    def decide(self, situation):
        time.sleep(0.05)
        return act()


class Fixed:
    name = "fixed"

    def decide(self, situation):
        return act()


def act():
    step = wt.PickPlaceStep("G1", pick="T1", place=wt.At("T2"))
    return wt.Act((wt.PlannedAction(step, wt.PickPlace(np.array([0.5, 0.2, 0.0]), np.array([0.5, -0.2, 0.0]))),))


class Sleeping:
    name = "sleeping"

    def decide(self, situation):
        time.sleep(100_000)


class Awaiting:
    name = "awaiting"

    async def decide(self, situation):
        import asyncio
        await asyncio.sleep(100_000)


class Slow:
    name = "slow"

    def answer(self, request):
        time.sleep(100_000)
'''


@pytest.fixture(scope="module", autouse=True)
def _warm(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Everything is imported before any time counts."""
    place = tmp_path_factory.mktemp("warm")
    path = place / "own.py"
    path.write_text(OWN, encoding="utf-8")
    run(["run", f"{path}:Fine", "--method", f"{path}:Fixed", "--replans", "0", "--out", str(place)])
    run(["plan", DESK, "put the red block into the blue bowl", "--out", str(place)])


@pytest.fixture
def own(tmp_path: Path) -> Path:
    path = tmp_path / "own.py"
    path.write_text(OWN, encoding="utf-8")
    return path


def noted(own: Path) -> list[str]:
    return own.with_suffix(".log").read_text(encoding="utf-8").split()


def ended_by_time(runs: Path, during: str, stage: str = "budget") -> None:
    """The record and the page are whole, and say what the limit ended."""
    record = read_record(runs / "latest")
    assert record["state"] == "finished"
    assert record["outcome"]["stage"] == stage
    assert "the cap of 2 s is reached" in record["outcome"]["reason"]
    assert during in record["outcome"]["reason"]
    page = (runs / "latest" / "page.html").read_text(encoding="utf-8")
    assert "the cap of 2 s is reached" in page


@pytest.mark.parametrize(
    ("world", "method", "during", "done"),
    [
        ("Stuck", "Fixed", "execute(pick_place) of world Stuck", ["moves", "stop", "close"]),
        ("Swallowing", "Fixed", "left behind: a thread cannot be ended", ["moves", "stop", "close"]),
        ("Blind", "Fixed", "observe() of world Blind", ["stop", "close"]),
        ("NeverStops", "Fixed", "execute(pick_place) of world NeverStops", ["moves", "stop", "close"]),
        ("Fine", "Sleeping", "decide() of method 'sleeping'", ["stop", "close"]),
        ("Fine", "Awaiting", "decide() of method 'awaiting'", ["stop", "close"]),
    ],
)
def test_the_limit_ends_a_run(
    world: str, method: str, during: str, done: list[str], own: Path, runs_folder: Path, capsys
) -> None:
    code = run(["run", f"{own}:{world}", "--method", f"{own}:{method}", "--max-seconds", LIMIT, "--replans", "0"])
    assert code == 5
    out, err = capsys.readouterr()
    assert out.startswith("FAILURE at budget")
    assert "Traceback" not in out + err
    ended_by_time(runs_folder, during)
    until = time.monotonic() + PATIENCE_S
    while len(noted(own)) < len(done) and time.monotonic() < until:
        time.sleep(0.01)  # a thread of its own may be slow to begin
    assert noted(own) == done
    if world == "NeverStops":
        assert "the robot may still be moving; a person must look" in err


def test_the_limit_ends_a_method_that_goes_on_for_ever(own: Path, runs_folder: Path, capsys) -> None:
    code = run(["run", f"{own}:Fine", "--method", f"{own}:Endless", "--max-seconds", LIMIT])
    assert (code, noted(own)[-2:]) == (5, ["stop", "close"])
    ended_by_time(runs_folder, "the cap of 2 s is reached")


def test_a_world_that_is_never_made(own: Path, capsys) -> None:
    assert run(["run", f"{own}:Unmade", "--max-seconds", LIMIT]) == 5
    assert "the cap of 2 s is reached" in capsys.readouterr().err


def test_the_program_ends_while_a_call_is_left_behind(own: Path) -> None:
    """The terminal is handed back: nothing that still runs keeps the process."""
    argv = ["run", f"{own}:Swallowing", "--method", f"{own}:Fixed", "--max-seconds", "6", "--json"]
    ended = subprocess.run(
        [sys.executable, "-m", "wonderful_team", *argv], capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    assert ended.returncode == 5, ended.stderr
    assert json.loads(ended.stdout)["result"]["stage"] == "budget"


def test_endless_drawing(monkeypatch: pytest.MonkeyPatch, runs_folder: Path, capsys) -> None:
    from wonderful_team.record import picture_store

    def endless(*_: object) -> None:
        while True:
            pass

    monkeypatch.setattr(picture_store, "drawn_png", endless)
    assert run(["plan", DESK, "put the red block into the blue bowl", "--max-seconds", LIMIT]) == 5
    out, err = capsys.readouterr()
    assert "the cap of 2 s is reached" in out + err
    assert "Traceback" not in out + err
    ended_by_time(runs_folder, "drawing")


def test_an_endless_page(monkeypatch: pytest.MonkeyPatch, runs_folder: Path, capsys) -> None:
    from wonderful_team.api import recording

    held = threading.Event()
    monkeypatch.setattr(recording, "write_page", lambda folder, coded: held.wait())
    with pytest.warns(UserWarning, match="the page of .* could not be written: .*the cap of 2 s is reached"):
        code = run(["plan", DESK, "put the red block into the blue bowl", "--max-seconds", LIMIT])
    held.set()
    assert code in (0, 5)
    assert read_record(runs_folder / "latest")["state"] == "finished"


def test_a_model_that_never_answers(own: Path, runs_folder: Path, capsys) -> None:
    argv = ["plan", DESK, "put the red block into the blue bowl", "--model", f"{own}:Slow", "--max-seconds", LIMIT]
    assert run(argv) == 5
    ended_by_time(runs_folder, "asking slow to DraftPlan", "budget")


@pytest.fixture
def dripping() -> Iterator[str]:
    """A server that sends a byte of its list of models now and then."""
    listening = socket.create_server(("127.0.0.1", 0))
    over = threading.Event()

    def serve() -> None:
        taken, _ = listening.accept()
        with taken:
            taken.recv(65536)
            taken.sendall(b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 100000\r\n\r\n")
            while not over.wait(0.05):
                try:
                    taken.sendall(b" ")
                except OSError:
                    return

    threading.Thread(target=serve, daemon=True).start()
    yield f"http://127.0.0.1:{listening.getsockname()[1]}/v1"
    over.set()
    listening.close()


@pytest.mark.parametrize("command", [["plan", DESK, "put the red block into the blue bowl", "--model"], ["probe"]])
def test_a_list_of_models_that_drips(command: list[str], dripping: str, capsys) -> None:
    assert run([*command, dripping, "--allow-unpriced", "--max-seconds", LIMIT]) == 5
    assert f"during asking {dripping}/models" in capsys.readouterr().err


@pytest.mark.parametrize("jobs", ["1", pytest.param("2", marks=pytest.mark.slow)])
def test_the_limit_of_a_study_cuts_trials_in_flight_and_nothing_is_lost(
    jobs: str, own: Path, tmp_path: Path, capsys
) -> None:
    store = tmp_path / "s.db"
    study = ["bench", f"{own}:Fine", "--method", f"{own}:Sleeping", "--no-control", "all", "--seeds", "0:2"]
    study += ["--store", str(store), "--jobs", jobs, "--record", "none"]
    assert run([*study, "--max-seconds", LIMIT]) == 5
    out, _ = capsys.readouterr()
    assert "stopped: the study's cap of 2 seconds is reached" in out
    # What was cut is no failure of the method: the same command goes on with both.
    assert run([*study, "--trial-max-seconds", LIMIT, "--json", "--max-seconds", "100"]) == 0
    told = json.loads(capsys.readouterr().out)["result"]
    assert (told["done"], told["total"]) == (2, 2)
