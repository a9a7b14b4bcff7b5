"""Names of the last release go on working for one release, and say what they are called now."""

from __future__ import annotations

import importlib
import json
import shutil
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

import wonderful_team as wt
from wonderful_team.cli.app import group
from wonderful_team.evals.monitor import StudyStatus
from wonderful_team.evals.spending import Spending
from wonderful_team.evals.study import StudyResult
from wonderful_team.record.plan_file import plan_from_json, plan_to_json
from wonderful_team.record.setup import read_setup
from wonderful_team.registry.methods import load_method

OLD_METHOD = """
import wonderful_team as wt

class Asking:
    name = "asking"

    def __init__(self, door):
        self.door = door

    def decide(self, situation):
        return wt.Done()
"""


@pytest.mark.parametrize(("old", "new"), [("MadePlan", "PlanResult"), ("RecordedTrial", "TrialResult")])
def test_old_public_names_are_the_new_things(old: str, new: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"{old} is called .*{new} now"):
        assert getattr(wt, old) is getattr(wt, new)
    assert old not in wt.__all__


def test_old_arguments_and_attributes() -> None:
    with pytest.warns(DeprecationWarning, match="look"):
        assert wt.Act((), look=True).reobserve  # type: ignore[call-arg]
    photo = wt.Observation.from_files(Path(__file__).parents[2] / "examples" / "desk.png")
    situation = wt.Situation(
        photo, wt.Instruction("wait"), wt.PICK_PLACE, wt.Limits((0, 0, 0), (1, 1, 1)), reobserve_left=2
    )
    with pytest.warns(DeprecationWarning, match="looks_left is called reobserve_left now"):
        assert situation.looks_left == 2
    with pytest.warns(DeprecationWarning, match="looks"):
        assert wt.Study(suite="vima17", seeds=range(2), looks=3).reobserve == 3  # type: ignore[call-arg]
    with pytest.warns(DeprecationWarning, match="standing is called status now"):
        assert StudyResult(StudyStatus(4, 3, 3, {}, Spending(), 1.0)).standing.done == 3
    with pytest.raises(TypeError, match="old name of reobserve"):
        wt.Act((), look=True, reobserve=True)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("old", "name", "home"),
    [
        ("replays", "replay", "api.replay"),
        ("interfaces", "Privileged", "core.protocols"),
        ("photos", "instruction_with_pictures", "api.photos"),
    ],
)
def test_modules_that_the_documents_named_can_be_imported_by_their_old_names(old: str, name: str, home: str) -> None:
    sys.modules.pop(f"wonderful_team.{old}", None)
    with pytest.warns(DeprecationWarning, match=f"wonderful_team.{old} is called wonderful_team.{home} now"):
        module = importlib.import_module(f"wonderful_team.{old}")
    assert getattr(module, name) is getattr(importlib.import_module(f"wonderful_team.{home}"), name)
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module("wonderful_team.no_such_module")


def test_a_method_that_asks_for_the_door_is_given_the_client(tmp_path: Path) -> None:
    (tmp_path / "asking.py").write_text(OLD_METHOD, encoding="utf-8")
    client = wt.Method().client()
    with pytest.warns(DeprecationWarning, match="'door' is called 'client' now"):
        method = load_method(f"{tmp_path}/asking.py:Asking", client)
    assert method.door is client  # type: ignore[attr-defined]


def test_the_old_flag_is_taken_and_said(tmp_path: Path) -> None:
    done = CliRunner().invoke(group, ["run", "tabletop/nothing", "--looks", "2", "--out", str(tmp_path)])
    assert "--looks is called --reobserve now" in done.output
    assert "No such option" not in done.output


def test_records_and_plans_of_the_last_release_open(tmp_path: Path) -> None:
    golden = Path(__file__).parents[1] / "golden" / "records" / "v1" / "trial"
    held = json.loads((golden / "plan.json").read_text(encoding="utf-8"))
    held["plan"]["questions"] = [
        {
            "type": "Doubt",
            "about": "G1",
            "kind": "collision",
            "question": "?",
            "answer": "",
            "changed": False,
            "provenance": "offline",
        }
    ]
    plan = plan_from_json(held)
    assert [type(question).__name__ for question in plan.questions] == ["Critique"]
    assert plan_from_json(plan_to_json(plan)).questions == plan.questions
    shutil.copytree(golden, tmp_path / "run")
    record = json.loads((tmp_path / "run" / "record.json").read_text(encoding="utf-8"))
    assert read_setup({**record, "setup": {**record["setup"], "looks": 4}}, "record").reobserve == 4
