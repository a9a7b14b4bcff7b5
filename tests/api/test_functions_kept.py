"""Helper functions of a run: replayed from its record, offered to no other run, and there again in a run from its plan."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wonderful_team as wt
from tests.desk import read_record
from tests.planning.rounds import photo
from tests.planning.test_functions_kept import drawing, goal, written
from wonderful_team.api.replay import branch, replay
from wonderful_team.cli.app import run
from wonderful_team.core.actions import ARM
from wonderful_team.errors import ConfigError
from wonderful_team.record import read_plan


def test_a_run_with_a_function_that_is_used_again_is_replayed_and_shown(tmp_path: Path, capsys) -> None:
    model = drawing(goal("G1", "T1"), goal("G2", "T2"))
    made = wt.Team(model=model, out=tmp_path).plan(photo(), "draw round the blocks", vocabulary=ARM)
    assert made.status == "planned", made.message
    found = replay(made.folder)
    assert found.same
    assert found.now == (made.id,)
    assert [one.name for one in read_plan(made.folder).functions] == ["path_1"]
    assert run(["show", str(made.folder)]) == 0
    told = capsys.readouterr().out
    assert "G1: accepted, kept as path_1 (a path round it)" in told
    assert "G2: accepted, the path of path_1 again (a path round it)" in told


def test_a_branch_goes_on_with_the_functions_of_the_answers_before_it(tmp_path: Path) -> None:
    again = drawing(goal("G1", "T1"), goal("G2", "T2"))
    made = wt.Team(model=again, out=tmp_path).plan(photo(), "draw round the blocks", vocabulary=ARM)
    other = drawing(goal("G1", "T1"), goal("G2", "T2"))
    branched = branch(made.folder, "act", other, out=tmp_path)
    assert branched.status == "planned", branched.message
    assert written(other) == [("G1", []), ("G2", ["path_1"])]


def test_a_team_that_plans_twice_offers_the_second_run_nothing_of_the_first(tmp_path: Path) -> None:
    model = drawing(goal("G1", "T1"))
    team = wt.Team(model=model, out=tmp_path)
    for _ in range(2):
        assert team.plan(photo(), "draw round the block", vocabulary=ARM).status == "planned"
    assert written(model) == [("G1", [])] * 2


def test_a_plan_file_with_a_changed_function_is_refused(tmp_path: Path) -> None:
    made = wt.Team(model=drawing(goal("G1", "T1")), out=tmp_path).plan(photo(), "draw", vocabulary=ARM)
    file = made.folder / "plan.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    assert (
        data["plan"]["functions"][0]["code"]
        == read_record(made.folder)["planner"]["plans"][0]["plan"]["functions"][0]["code"]
    )
    crowd = [{**data["plan"]["functions"][0], "name": f"path_{k}"} for k in range(1, 14)]
    for functions, said in (
        ([{**crowd[0], "code": "def path(boxes): return []"}], "it was changed after it was written"),
        ([{**crowd[0], "name": "star"}], "name of a helper function 'star': valid are path_1"),
        (crowd, "13 helper functions, at most 12 are allowed"),
    ):
        file.write_text(json.dumps({**data, "plan": {**data["plan"], "functions": functions}}), encoding="utf-8")
        with pytest.raises(ConfigError, match=said):
            read_plan(file)
