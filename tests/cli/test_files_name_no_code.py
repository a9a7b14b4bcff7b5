"""Records, stores and profiles never name code that runs: FILE.py:NAME comes from the command line or the caller alone."""

from __future__ import annotations

import json
import sqlite3

import pytest

import wonderful_team as wt
from tests.desk import read_record
from wonderful_team.api.probe import probe_model
from wonderful_team.api.trial import run_trial
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError
from wonderful_team.evals.trials import Condition, RunSettings, TrialSpec
from wonderful_team.models.profiles import profile_to_json, profiles_folder


@pytest.fixture
def planted(tmp_path):
    """A file that shows that it ran."""
    file, shown = tmp_path / "x.py", tmp_path / "ran"
    file.write_text(f"open({str(shown)!r}, 'w').close()\n\n\nclass W:\n    pass\n", encoding="utf-8")
    return file, shown


@pytest.fixture
def trial_folder(tmp_path):
    world = wt.make_world("tabletop/visual_manipulation", seed=3)
    try:
        return wt.rollout(wt.Team(out=tmp_path / "runs"), world, seed=3, scene="tabletop/visual_manipulation#3").folder
    finally:
        world.close()


@pytest.mark.parametrize("scene", ["tabletop/../{}:W#3", "tabletop/{}:W#3", "{}:W#3", "tabletop/{}:W?seed=3#3"])
def test_a_record_runs_no_code(planted, trial_folder, scene, capsys):
    file, shown = planted
    record = read_record(trial_folder)
    record["setup"]["scene"] = scene.format(file)
    (trial_folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
    code = run(["show", str(trial_folder), "--from", "act", "--model", "offline"])
    assert not shown.exists()
    # A scene that is not one of our simulators is planned again; nothing is set up for it.
    assert code == (2 if scene.startswith("tabletop/") else 0)
    if code:
        assert "names code" in capsys.readouterr().err
    assert run(["show", str(trial_folder), "--replay"]) == 0
    assert run(["show", str(trial_folder)]) == 0
    assert not shown.exists()


def test_a_profile_runs_no_code(planted, capsys):
    file, shown = planted
    held = json.loads(profile_to_json(probe_model("offline", most_pictures=1).profile))
    profiles_folder().mkdir(parents=True, exist_ok=True)
    (profiles_folder() / "mine.json").write_text(json.dumps({**held, "model": f"{file}:W"}), encoding="utf-8")
    assert run(["plan", "examples/desk.png", "put the red block into the blue bowl", "--model", "mine"]) == 2
    assert "profile 'mine' names code" in capsys.readouterr().err
    assert run(["probe", "mine"]) == 2
    assert not shown.exists()


@pytest.mark.parametrize("column", ["task", "method", "model"])
def test_a_store_runs_no_code(planted, tmp_path, column, capsys):
    file, shown = planted
    store = tmp_path / "study.db"
    argv = ["bench", "tabletop/rotate", "--seeds", "0", "--store", str(store), "--jobs", "1", "--no-control", "all"]
    assert run([*argv, "--max-seconds", "0.000001"]) in (5, 130)
    with sqlite3.connect(store) as base:
        base.execute(f"UPDATE trials SET {column} = ?", (f"{file}:W",))  # noqa: S608  a column of the test's own
    run(argv)
    assert not shown.exists()
    with sqlite3.connect(store) as base:
        rows = base.execute("SELECT outcome, reason FROM trials").fetchall()
    assert all(outcome in (None, "error") for outcome, _ in rows)


def test_the_caller_may_name_code(planted):
    file, shown = planted
    spec = TrialSpec(f"{file}:W", 0, Condition("noop", "-"))
    with pytest.raises(ConfigError, match="the store names code"):
        run_trial(spec, RunSettings(named_code=frozenset()))
    assert not shown.exists()
    with pytest.raises(ConfigError, match="lacks vocabulary"):
        run_trial(spec, RunSettings(named_code=frozenset({f"{file}:W"})))
    assert shown.exists()
