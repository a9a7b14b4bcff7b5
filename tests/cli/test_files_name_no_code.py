"""Records, stores and profiles never name code that runs: FILE.py:NAME comes from the command line or the caller alone."""

from __future__ import annotations

import json
import pickle
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
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
    with closing(sqlite3.connect(store)) as base, base:
        base.execute(f"UPDATE trials SET {column} = ?", (f"{file}:W",))  # noqa: S608  a column of the test's own
    run(argv)
    assert not shown.exists()
    with closing(sqlite3.connect(store)) as base:
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


SCENES = (
    "tabletop/../{file}#3", "tabletop/{file}#3", "tabletop/{file}@L3#3", "tabletop/{file}:W@clutter=2#3", "tabletop/{file}:#3",
    "tabletop/{link}#3", "tabletop/{link}:W#3", "tabletop/rotate#{file}:W", "tabletop/rotate@{file}#3", "tabletop/x/{file}:W#",
    "tabletop/{package}#3", "tabletop/{package}/x.py#3", "vimabench/{file}#3", "vimabench/../{file}:W#3", "tabletop//{file}:W?a=1#3",
    "tabletop/{file}\n#3", "tabletop/rotate\x00{file}:W#3", "tabletop/x.PY:W#3", "tabletop/importlib:import_module#3",
)  # fmt: skip


@pytest.mark.parametrize("scene", SCENES)
def test_no_scene_of_a_record_runs_code(planted, trial_folder, scene, capsys, tmp_path, monkeypatch):
    file, shown = planted
    (tmp_path / "tabletop").mkdir()
    (tmp_path / "link").symlink_to(file)
    (tmp_path / "link.py").symlink_to(file)
    (tmp_path / "package.py").mkdir()
    (tmp_path / "package.py" / "__init__.py").write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for name in (file.name, str(file), f"../{file.name}"):
        record = read_record(trial_folder)
        record["setup"]["scene"] = scene.format(file=name, link="../link.py", package="../package.py")
        (trial_folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
        assert run(["show", str(trial_folder), "--from", "act", "--model", "offline"]) == 2
        assert not shown.exists()
        assert run(["show", str(trial_folder), "--replay"]) == 0
    assert not shown.exists()
    assert "defect" not in capsys.readouterr().err


@pytest.mark.parametrize("key", ["method", "model", "scene", "commit"])
@pytest.mark.parametrize("name", ["{}:W", "{}", "team:{}:W", "*={}:W"])
def test_no_configuration_of_a_record_runs_code(planted, trial_folder, key, name, capsys):
    file, shown = planted
    record = read_record(trial_folder)
    record["configuration"][key] = name.format(file)
    record["command"] = f"wonderful-team run {file}:W; touch {shown}"
    record["words"] = {**record["words"], f"../{file.name}": "x", str(file): "x"}
    (trial_folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
    for argv in (["--replay"], ["--from", "act", "--model", "offline"], [], ["--role", "supervisor"]):
        assert run(["show", str(trial_folder), *argv]) in (0, 2)
    assert not shown.exists()
    assert file.read_text(encoding="utf-8") != "x"
    assert "defect" not in capsys.readouterr().err


def test_words_of_a_record_are_no_templates(planted, trial_folder, capsys):
    """Prompts are data: what stands in braces in them is text."""
    _, shown = planted
    record = read_record(trial_folder)
    code = f"__import__('os').system('touch {shown}')"
    spoiled = f"{{{{ {code} }}}} {{{code}}} {{0.__class__.__init__.__globals__}} %(x)s ${{{code}}} `touch {shown}`"
    record["words"] = {name: f"{text}\n{spoiled}" for name, text in record["words"].items()}
    (trial_folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
    assert run(["show", str(trial_folder), "--from", "plan", "--model", "offline"]) == 0
    assert not shown.exists()
    assert "defect" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["{}:W", "{}", "../{}:W", "mine", "other", "*={}:W", "supervisor={}:W", "simulated:{}:W"]
)
def test_no_profile_runs_code(planted, name, tmp_path, monkeypatch, capsys):
    """A profile may name a profile; two that name each other are no endless loop."""
    file, shown = planted
    photo = str(Path("examples/desk.png").absolute())
    monkeypatch.chdir(tmp_path)
    held = json.loads(profile_to_json(probe_model("offline", most_pictures=1).profile))
    profiles_folder().mkdir(parents=True, exist_ok=True)
    for profile, model in (("mine", name.format(file)), ("other", "mine")):
        text = json.dumps({**held, "name": profile, "model": model})
        (profiles_folder() / f"{profile}.json").write_text(text, encoding="utf-8")
    for profile in ("mine", "other"):
        assert run(["plan", photo, "put the red block into the blue bowl", "--model", profile]) == 2
        assert run(["probe", profile]) == 2
    assert not shown.exists()
    assert "defect" not in capsys.readouterr().err


CAMERA = {"K": [[400, 0, 160], [0, 400, 120], [0, 0, 1]], "size_px": [320, 240]}


@pytest.mark.parametrize("kind", ["yaml", "tag", "pickle", "type", "npy"])
def test_no_camera_plan_or_depth_file_runs_code(kind, planted, trial_folder, tmp_path, capsys):
    file, shown = planted

    class Opens:
        def __reduce__(self):
            return (open, (str(shown), "w"))

    camera, depth, plan = tmp_path / "camera.json", tmp_path / "depth.npy", trial_folder / "plan.json"
    match kind:
        case "yaml":
            camera.write_text(f"!!python/object/apply:builtins.open ['{shown}', 'w']", encoding="utf-8")
        case "tag":
            camera.write_text(json.dumps({**CAMERA, "model": f"{file}:W", "type": f"{file}:W"}), encoding="utf-8")
        case "pickle":
            camera.write_bytes(pickle.dumps(Opens()))
        case "type":
            camera.write_text(json.dumps(CAMERA), encoding="utf-8")
            held = json.loads(plan.read_text(encoding="utf-8"))
            held["plan"]["actions"][0]["action"]["type"] = f"{file}:W"
            plan.write_text(json.dumps(held), encoding="utf-8")
        case _:
            np.save(depth, np.array([Opens()], dtype=object), allow_pickle=True)
            camera.write_text(json.dumps(CAMERA), encoding="utf-8")
    words = "put the red block into the blue bowl"
    argv = ["plan", str(Path("examples/desk.png").absolute()), words, "--camera", str(camera)]
    assert run([*argv, "--depth", str(depth)] if kind == "npy" else argv) == 2
    assert run(["run", "tabletop/visual_manipulation", "--seed", "3", "--plan", str(trial_folder)]) in (0, 1, 2, 4)
    assert not shown.exists()
    assert "defect" not in capsys.readouterr().err
