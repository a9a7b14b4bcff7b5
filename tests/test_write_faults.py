"""Every write of every command fails once: a named error, the result in hand printed, nothing half written taken for whole.

By default a sample of the points; `--runslow` takes all of them.
"""

from __future__ import annotations

import contextlib
import errno
import io
import itertools
import json
import os
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.write_faults import Ended, Faults, Outcome, injected, names_the_file, sweep
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError
from wonderful_team.record.record_schema import read_record

DESK = str(Path(__file__).parents[1] / "examples" / "desk.png")
WORDS = "put the first thing into the second thing"
OWN = """
import numpy as np

import wonderful_team as wt
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.models.stub_model import stub_script

DONE = []


class Desk:
    vocabulary = wt.PICK_PLACE
    limits = wt.Limits((0.25, -0.5, -0.01), (0.75, 0.5, 0.5))
    instruction = wt.Instruction("move it")
    turn = 0

    def observe(self):
        grey = 90 + self.turn
        depth = np.full((64, 128), 1.0, np.float32)
        return wt.Observation({"top": wt.View("top", "top", 0.0, np.full((64, 128, 3), grey, np.uint8), depth)})

    def execute(self, action):
        DONE.append("moves")
        self.turn += 1
        return wt.StepReport(action, executed=True)

    def stop(self):
        DONE.append("stop")

    def close(self):
        DONE.append("close")


class Fixed:
    name = "fixed"

    def decide(self, situation):
        if situation.attempt:
            return wt.Done("moved")
        step = wt.PickPlaceStep("G1", pick="T1", place=wt.At("T2"))
        return wt.Act((wt.PlannedAction(step, wt.PickPlace(np.array([0.5, 0.2, 0.0]), np.array([0.5, -0.2, 0.0]))),))


def Stub():
    return ScriptedModel(stub_script())
"""


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("own") / "own.py"
    path.write_text(OWN, encoding="utf-8")
    return path


@pytest.fixture
def folders(tmp_path: Path) -> Callable[[], Path]:
    numbers = itertools.count()

    def another() -> Path:
        place = tmp_path / str(next(numbers))
        place.mkdir()
        return place

    return another


def called(argv: list[str], faults: Faults) -> tuple[int, str, str]:
    """A command in this process, with a write that fails."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), injected(faults):
        code = run(argv)
    return code, out.getvalue(), err.getvalue()


def done_by(own: Path) -> list[str]:
    """What was done to the robot since this was asked last."""
    import sys

    module = next(module for name, module in sys.modules.items() if getattr(module, "__file__", None) == str(own))
    done = list(module.DONE)
    module.DONE.clear()
    return done


def record_problems(runs: Path, whole: bool) -> list[str]:
    """What is wrong with the records under a folder: one that reads as finished holds all that it names."""
    found = []
    for path in runs.glob("*/record.json"):
        if path.parent.is_symlink():
            continue
        try:
            record = read_record(path.parent)
        except ConfigError as error:
            found.append(f"a record that cannot be read: {error}")
            continue
        unwritten = set(record.get("unwritten", ()))
        if record["state"] == "finished":
            missing = {name for name in record["files"].values() if not (path.parent / name).is_file()}
            if not missing <= unwritten:
                found.append(f"a finished record lacks {sorted(missing - unwritten)}")
        elif whole:
            found.append(f"the record is {record['state']}")
    return found


def assert_all_well(count: int, outcomes: list[Outcome], at_least: int) -> None:
    wrong = [f"{one.point}: exit {one.code}: {'; '.join(one.wrong)}" for one in outcomes if one.wrong]
    assert count >= at_least
    assert not wrong, f"{len(wrong)} of {len(outcomes)} points:\n" + "\n".join(wrong)


ALL = pytest.param(1, marks=pytest.mark.slow, id="every point")


def named(ended: Ended) -> list[str]:
    """A write that failed for good is told, with its file; one that could be made up for need not be."""
    if not ended.faults.failed:
        return []
    if ended.code == 0 and not ended.faults.lasting:
        return []
    return [] if names_the_file(ended) else [f"{Path(ended.faults.failed).name} is not named: {ended.err[-300:]!r}"]


@pytest.mark.parametrize("lasting", [False, True])
@pytest.mark.parametrize("every", [pytest.param(11, id="sample"), ALL])
def test_run(every: int, lasting: bool, own: Path, folders: Callable[[], Path]) -> None:
    def command(place: Path, faults: Faults) -> tuple[int, str, str]:
        done_by(own)
        argv = ["run", f"{own}:Desk", "--method", f"{own}:Fixed", "--replans", "1", "--out", str(place / "runs")]
        return called([*argv, "--video", str(place / "film.gif")], faults)

    def check(ended: Ended) -> list[str]:
        done = done_by(own)
        found = named(ended) + record_problems(ended.folder / "runs", whole=False)
        if done[-1:] != ["close"]:
            found.append(f"the robot was not closed: {done}")
        if "moves" in done and not ended.out.startswith("UNSCORED"):
            found.append(f"the outcome is not printed: {ended.out!r}")
        if "moves" in done and ended.faults.lasting and ended.code != 2:
            found.append("nothing of it is on disk, and the exit code says nothing")
        return found

    # The file is loaded once: from here on what is done to its robot can be read.
    assert run(["run", f"{own}:Desk", "--method", f"{own}:Fixed", "--out", str(folders())]) == 0
    assert_all_well(*sweep(command, folders, check, every=every, lasting=lasting), 60)


@pytest.mark.parametrize("lasting", [False, True])
@pytest.mark.parametrize("every", [pytest.param(17, id="sample"), ALL])
def test_plan(every: int, lasting: bool, own: Path, folders: Callable[[], Path]) -> None:
    def command(place: Path, faults: Faults) -> tuple[int, str, str]:
        argv = ["plan", DESK, WORDS, "--model", f"{own}:Stub", "--cache", "on", "--cache-file", str(place / "c.sqlite")]
        return called([*argv, "--out", str(place / "runs")], faults)

    def check(ended: Ended) -> list[str]:
        found = named(ended) + record_problems(ended.folder / "runs", whole=False)
        if "actions  " in ended.err and not ended.out.startswith("PLAN"):
            found.append(f"the plan is not printed: {ended.out!r}")
        return found

    assert_all_well(*sweep(command, folders, check, every=every, lasting=lasting), 60)


@pytest.mark.parametrize("every", [pytest.param(23, id="sample"), ALL])
def test_bench(every: int, own: Path, folders: Callable[[], Path]) -> None:
    def study(place: Path) -> list[str]:
        argv = ["bench", f"{own}:Desk", "--method", f"{own}:Fixed", "--no-control", "all", "--seeds", "0:2"]
        return [*argv, "--jobs", "1", "--store", str(place / "s.db"), "--pages", "all", "--out", str(place / "runs")]

    def command(place: Path, faults: Faults) -> tuple[int, str, str]:
        return called(study(place), faults)

    def check(ended: Ended) -> list[str]:
        found = named(ended)
        code, out, err = called([*study(ended.folder), "--json", "--retry-errors"], Faults([]))
        if code != 0:
            return [*found, f"the study does not go on: {err[-300:]}"]
        told = json.loads(out)["result"]
        if (told["done"], told["total"]) != (2, 2):
            found.append(f"{told['done']} of {told['total']} trials")
        with contextlib.closing(sqlite3.connect(ended.folder / "s.db")) as base:
            rows = base.execute("SELECT key, state, outcome FROM trials").fetchall()
        if len(rows) != 2 or any(row[1:] != ("done", "unscored") for row in rows):
            found.append(f"trials in the store: {rows}")
        return found

    assert_all_well(*sweep(command, folders, check, every=every), 60)


@pytest.mark.parametrize("every", [pytest.param(5, id="sample"), ALL])
@pytest.mark.parametrize(
    ("argv", "printed"),
    [
        (["new", "world", "Mine", "--out", "{place}/new"], ""),
        (["list", "prompts", "--out", "{place}/words"], ""),
        (["list", "runs", "--out", "{made}", "--html", "{place}/runs.html"], ""),
        (["show", "{made}/latest", "--replay", "--out", "{place}/runs"], ""),
        (
            ["ground", DESK, "red block", "--model", "{own}:Stub", "--coco", "{place}/c.json", "--out", "{place}/runs"],
            "T1",
        ),
        (["report", "{made}/s.db", "--out", "{place}/page.html", "--latex", "{place}/tex"], "|"),
        (["check", "{own}:Stub", "--seeds", "1"], "checked"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_other_commands(argv: list[str], printed: str, every: int, own: Path, folders: Callable[[], Path]) -> None:
    made = folders()
    assert run(["plan", DESK, WORDS, "--model", f"{own}:Stub", "--out", str(made)]) == 0
    study = ["bench", f"{own}:Desk", "--method", f"{own}:Fixed", "--no-control", "all", "--seeds", "0:1"]
    assert run([*study, "--jobs", "1", "--store", str(made / "s.db"), "--pages", "none"]) == 0

    def command(place: Path, faults: Faults) -> tuple[int, str, str]:
        return called([word.format(place=place, made=made, own=own) for word in argv], faults)

    def check(ended: Ended) -> list[str]:
        found = named(ended)
        if printed and (argv[0] == "report" or ended.faults.failed.endswith("c.json")) and printed not in ended.out:
            found.append(f"the result is not printed: {ended.out!r}")
        return found

    assert_all_well(*sweep(command, folders, check, every=every), 0)


def test_a_profile_that_cannot_be_saved_is_still_shown(own: Path, tmp_path: Path, monkeypatch, capsys) -> None:
    blocked = tmp_path / "config"
    blocked.write_text("a file, where a folder should be", encoding="utf-8")
    monkeypatch.setenv("WONDERFUL_TEAM_CONFIG", str(blocked))
    assert run(["probe", f"{own}:Stub", "--save", "mine"]) == 2
    out, err = capsys.readouterr()
    assert out.startswith("model ")
    assert f"{str(blocked)}" in err
    assert "the profile is not saved" in err


def test_the_injector_fails_what_it_should(tmp_path: Path) -> None:
    """A check that cannot fail would prove nothing."""
    target = tmp_path / "a.txt"
    with injected(Faults([tmp_path])) as counted:
        target.write_text("whole", encoding="utf-8")
        (tmp_path / "b").mkdir()
        os.replace(target, tmp_path / "c.txt")
    assert [point.split()[0] for point in counted.points] == ["open", "write", "close", "mkdir", "replace"]
    with injected(Faults([tmp_path], 2)), pytest.raises(OSError, match="No space left") as caught:
        target.write_text("whole", encoding="utf-8")
    assert caught.value.errno == errno.ENOSPC
    assert target.read_text(encoding="utf-8") == "wh"
    with injected(Faults([tmp_path / "elsewhere"], 1)):
        target.write_text("whole", encoding="utf-8")
