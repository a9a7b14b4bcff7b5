"""The commands whose every write is made to fail, and what must hold for each: `every_write(place)` runs them all."""

from __future__ import annotations

import contextlib
import io
import itertools
import json
import os
import sqlite3
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

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
from tests.planning.stub_model import stub_script

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


@dataclass(frozen=True)
class Setting:
    """What the cases share: the user's own file, a run and a study that were made before, and new folders.

    Attributes:
        own: The file with a world, a method and a model.
        made: Holds a run (`latest`) and a study (`s.db`).
        folders: Makes a new, empty folder at each call.
    """

    own: Path
    made: Path
    folders: Callable[[], Path]


def prepare(place: Path) -> Setting:
    """Write the user's file and run once what the cases start from; nothing fails here."""
    own, made = place / "own.py", place / "made"
    own.write_text(OWN, encoding="utf-8")
    numbers = itertools.count()

    def another() -> Path:
        folder = place / str(next(numbers))
        folder.mkdir()
        return folder

    study = ["bench", f"{own}:Desk", "--method", f"{own}:Fixed", "--no-control", "all", "--seeds", "0:1"]
    for argv in (
        ["run", f"{own}:Desk", "--method", f"{own}:Fixed", "--out", str(another())],
        [*study, "--jobs", "1", "--store", str(made / "s.db"), "--record", "none"],
        ["plan", DESK, WORDS, "--model", f"{own}:Stub", "--out", str(made)],
    ):
        code, _, err = called(argv, Faults([]))
        if code != 0:
            raise RuntimeError(f"{argv[0]} fails although every write works: {err}")
    return Setting(own, made, another)


def called(argv: list[str], faults: Faults) -> tuple[int, str, str]:
    """A command in this process, with a write that fails."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), injected(faults):
        code = run(argv)
    return code, out.getvalue(), err.getvalue()


def done_to_the_robot(own: Path) -> list[str]:
    """What was done to it since this was asked last."""
    module = next(module for module in sys.modules.values() if getattr(module, "__file__", None) == str(own))
    done = list(module.DONE)
    module.DONE.clear()
    return done


def record_problems(runs: Path) -> list[str]:
    """What is wrong with the records under a folder: one that reads as finished holds all that it names, or says what it lacks."""
    found = []
    for path in runs.glob("*/record.json"):
        if path.parent.is_symlink():
            continue
        try:
            record = read_record(path.parent)
        except ConfigError as error:
            found.append(f"a record that cannot be read: {error}")
            continue
        missing = {name for name in record["files"].values() if not (path.parent / name).is_file()}
        missing -= set(record.get("unwritten", ()))
        if record["state"] == "finished" and missing:
            found.append(f"a finished record lacks {sorted(missing)}")
    return found


def unnamed(ended: Ended) -> list[str]:
    """A write that failed for good is told, with its file; one that was made up for need not be."""
    if not ended.faults.failed or (ended.code == 0 and not ended.faults.lasting) or names_the_file(ended):
        return []
    return [f"{Path(ended.faults.failed).name} is not named: {ended.err[-300:]!r}"]


class Case(Protocol):
    """One command: its name, how it is called, and what must hold afterwards."""

    name: str

    def command(self, setting: Setting, place: Path, faults: Faults) -> tuple[int, str, str]: ...

    def check(self, setting: Setting, ended: Ended) -> list[str]: ...


class Run:
    """The robot is closed, and what became of it is printed."""

    name = "run"

    def command(self, setting: Setting, place: Path, faults: Faults) -> tuple[int, str, str]:
        done_to_the_robot(setting.own)
        argv = ["run", f"{setting.own}:Desk", "--method", f"{setting.own}:Fixed", "--replans", "1"]
        return called([*argv, "--out", str(place / "runs"), "--video", str(place / "film.gif")], faults)

    def check(self, setting: Setting, ended: Ended) -> list[str]:
        done = done_to_the_robot(setting.own)
        found = unnamed(ended) + record_problems(ended.folder / "runs")
        if done[-1:] != ["close"]:
            found.append(f"the robot was not closed: {done}")
        if "moves" in done and not ended.out.startswith("UNSCORED"):
            found.append(f"the outcome is not printed: {ended.out!r}")
        if "moves" in done and ended.faults.lasting and ended.faults.failed and ended.code != 2:
            found.append("files are missing, and the exit code says nothing")
        return found


class Plan:
    """The plan is printed once it is made, and a paid answer is not lost with the cache's file."""

    name = "plan"

    def command(self, setting: Setting, place: Path, faults: Faults) -> tuple[int, str, str]:
        argv = ["plan", DESK, WORDS, "--model", f"{setting.own}:Stub", "--out", str(place / "runs")]
        return called([*argv, "--cache", "on", "--cache-file", str(place / "c.sqlite")], faults)

    def check(self, setting: Setting, ended: Ended) -> list[str]:
        found = unnamed(ended) + record_problems(ended.folder / "runs")
        if "actions  " in ended.err and not ended.out.startswith("PLAN"):
            found.append(f"the plan is not printed: {ended.out!r}")
        return found


class Bench:
    """The same command goes on afterwards: every trial is done, once."""

    name = "bench"

    def study(self, setting: Setting, place: Path) -> list[str]:
        argv = ["bench", f"{setting.own}:Desk", "--method", f"{setting.own}:Fixed", "--no-control", "all"]
        argv += ["--seeds", "0:2", "--jobs", "1", "--record", "full"]
        return [*argv, "--store", str(place / "s.db"), "--out", str(place / "runs")]

    def command(self, setting: Setting, place: Path, faults: Faults) -> tuple[int, str, str]:
        return called(self.study(setting, place), faults)

    def check(self, setting: Setting, ended: Ended) -> list[str]:
        # On a disk that stays full the store is the first whose failure ends the command.
        store_named = ended.faults.lasting and "s.db" in ended.err
        found = [] if store_named else unnamed(ended)
        self._end_the_process(ended.folder / "s.db")
        code, out, err = called([*self.study(setting, ended.folder), "--json", "--retry-errors"], Faults([]))
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

    def _end_the_process(self, store: Path) -> None:
        """The command would have ended with its process; here the process lives, and with it what it had claimed."""
        with contextlib.suppress(sqlite3.Error), contextlib.closing(sqlite3.connect(store)) as base:
            base.execute("UPDATE trials SET owner = replace(owner, ?, '|0|')", (f"|{os.getpid()}|",))
            base.commit()


@dataclass(frozen=True)
class Other:
    """A command by its words; `printed` stands on stdout although the file `although` could not be written."""

    name: str
    argv: tuple[str, ...]
    printed: str = ""
    although: str = ""

    def command(self, setting: Setting, place: Path, faults: Faults) -> tuple[int, str, str]:
        names = {"place": place, "made": setting.made, "own": setting.own}
        return called([word.format(**names) for word in self.argv], faults)

    def check(self, setting: Setting, ended: Ended) -> list[str]:
        found = unnamed(ended)
        if self.printed and self.although in ended.faults.failed and self.printed not in ended.out:
            found.append(f"the result is not printed: {ended.out!r}")
        return found


CASES: tuple[Case, ...] = (
    Run(),
    Plan(),
    Bench(),
    Other("new", ("new", "world", "Mine", "--out", "{place}/new")),
    Other("list prompts", ("list", "prompts", "--out", "{place}/words")),
    Other("list runs", ("list", "runs", "--out", "{made}", "--html", "{place}/runs.html")),
    Other(
        "ground",
        ("ground", DESK, "red block", "--model", "{own}:Stub", "--coco", "{place}/c.json", "--out", "{place}/runs"),
        "T1",
        "c.json",
    ),
    Other("report", ("report", "{made}/s.db", "--out", "{place}/page.html", "--latex", "{place}/tex"), "|"),
)


def every_write(
    place: Path, *, every: int = 1, lasting: bool = False, setting: Setting | None = None
) -> dict[str, tuple[int, list[Outcome]]]:
    """Fail every n-th write of every command.

    Args:
        place: An empty folder.
        every: Take every n-th point.
        lasting: All writes after it fail too, as on a disk that stays full.
        setting: From `prepare`, where it was called before.

    Returns:
        By command: how many points it has, and what came of those taken.
    """
    known = setting or prepare(place)
    return {case.name: fail_writes(case, known, every=every, lasting=lasting) for case in CASES}


def fail_writes(case: Case, setting: Setting, *, every: int = 1, lasting: bool = False) -> tuple[int, list[Outcome]]:
    """The same for one command."""
    return sweep(
        lambda place, faults: case.command(setting, place, faults),
        setting.folders,
        lambda ended: case.check(setting, ended),
        every=every,
        lasting=lasting,
    )
