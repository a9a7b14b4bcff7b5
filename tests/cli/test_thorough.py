"""`--thorough` of plan, run and bench: the team asks every question, and what it ran with is told."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.api.trial_setup import reproduce
from wonderful_team.cli.app import run
from wonderful_team.evals.trials import Condition, TrialSpec

DESK = str(Path(__file__).parents[2] / "examples" / "desk.png")
PLAIN = ["plan", DESK, "put the red block into the blue bowl"]


def kinds(folder: Path) -> set[str]:
    record = json.loads((folder / "latest" / "record.json").read_text(encoding="utf-8"))
    assert record["configuration"]["thorough"] == ("--thorough" in record["command"])
    return {request["contract"] for request in record["planner"]["requests"]}


def test_a_plain_plan_is_asked_about_in_full(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*PLAIN, "--out", str(tmp_path / "plain")]) == 0
    assert "not asked" in capsys.readouterr().err
    assert run([*PLAIN, "--thorough", "--out", str(tmp_path / "all")]) == 0
    assert "not asked" not in capsys.readouterr().err
    assert {"ReviewPlan", "WriteSteps", "JudgeBox"} <= kinds(tmp_path / "all") - kinds(tmp_path / "plain")


def test_a_run_takes_it_too(tmp_path: Path) -> None:
    command = [
        "run",
        "tabletop/visual_manipulation",
        "--seed",
        "3",
        "--replans",
        "0",
        "--thorough",
        "--out",
        str(tmp_path),
    ]
    assert run(command) == 0
    assert {"ReviewPlan", "WriteSteps"} <= kinds(tmp_path)


def test_a_study_knows_its_trials_by_it(tmp_path: Path) -> None:
    plain, thorough = (wt.Study("rotate", store=tmp_path / "study.db", thorough=one) for one in (False, True))
    assert plain.plan.how == ""
    assert thorough.plan.how == "thorough"
    spec = TrialSpec("tabletop/rotate", 3, Condition("team", "offline", "", "", 0, "thorough"))
    assert reproduce(spec, {"thorough": True}).endswith("--thorough")
    assert "--thorough" not in reproduce(spec, {})
    command = ["bench", "rotate", "--seeds", "1000:1001", "--jobs", "1", "--no-control", "all", "--thorough"]
    assert run([*command, "--record", "full", "--out", str(tmp_path), "--store", str(tmp_path / "study.db")]) == 0
    (record,) = (tmp_path / "trials").rglob("record.json")
    assert json.loads(record.read_text(encoding="utf-8"))["configuration"]["thorough"] is True
