"""Rivals plan once, again after a refusal, and never judge what came of it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from tests.planning.baselines.runs import ON_PICTURES, RIVALS, Listening, contracts, decided, photo, run
from wonderful_team.cli import main
from wonderful_team.core.protocols import Act, Done, GaveUp
from wonderful_team.core.values import GateCheck, GateReport, Words
from wonderful_team.errors import ConfigError
from wonderful_team.planning import TeamPolicy
from wonderful_team.registry.methods import METHODS

REFUSED = GateReport((GateCheck(0, "reach", False, "1.2 m", "at most 0.8 m"),))
TEAM_ALONE = {"supervisor", "verification", "manager", "checker", "mover", "memory", "replanner"}


@pytest.mark.parametrize("name", RIVALS)
def test_every_rival_says_what_it_is_and_has_no_member_of_the_team(name: str) -> None:
    policy = wt.Method(method=name, model="offline").policy()
    assert policy.name == name
    assert not isinstance(policy, TeamPolicy)
    assert METHODS[name].words
    assert METHODS[name].roles
    assert not {role.name for role in METHODS[name].roles} & TEAM_ALONE


@pytest.mark.parametrize("name", ON_PICTURES)
def test_what_a_rival_is_asked_names_nothing_that_the_team_alone_has(name: str, tmp_path: Path) -> None:
    model = Listening(wt.make_model("offline"))
    decided(name, photo(tmp_path), model)
    assert model.heard
    for request in model.heard:
        said = request.system + " ".join(part.text for part in request.parts if isinstance(part, Words))
        said += json.dumps(request.output.model_json_schema())
        for word in ("Supervisor", "Verification", "Manager", "Checker", "Mover", "Replanner", "helper function"):
            assert word not in said, f"{request.contract} speaks of {word}"


@pytest.mark.parametrize("name", ON_PICTURES)
def test_a_photo_becomes_a_plan_in_pixels(name: str, tmp_path: Path) -> None:
    made = decided(name, photo(tmp_path))
    assert isinstance(made, Act)
    assert [action.step.kind for action in made.actions] == ["pick_place"]
    pick, place = made.actions[0].sources
    assert pick.point_px == pytest.approx((80, 150), abs=26)
    assert place.point_px == pytest.approx((230, 90), abs=30)


@pytest.mark.parametrize("name", ON_PICTURES)
def test_why_the_last_plan_did_not_run_is_said(name: str, tmp_path: Path) -> None:
    first = replace(photo(tmp_path), attempt=1)
    for situation, said in (
        (replace(first, refused=REFUSED, replans_left=1), "action 1: reach: 1.2 m (valid: at most 0.8 m)"),
        (replace(first, refused=REFUSED, advice="too near the edge"), "A person declined the plan: too near the edge"),
    ):
        model = Listening(wt.make_model("offline"))
        assert isinstance(decided(name, situation, model), Act)
        assert any(said in part.text for one in model.heard for part in one.parts if isinstance(part, Words))
        assert all(one.id.startswith("1/") for one in model.heard)


def test_without_replans_left_a_refusal_ends_it_at_the_gate(tmp_path: Path) -> None:
    ended = decided("direct", replace(photo(tmp_path), refused=REFUSED))
    assert isinstance(ended, GaveUp)
    assert ended.stage == "gate"
    assert "reach: 1.2 m (valid: at most 0.8 m)" in ended.reason


def test_after_execution_it_asks_nothing_and_judges_nothing(tmp_path: Path) -> None:
    trial = run("direct", "visual_manipulation", tmp_path)
    assert (trial.outcome, trial.verdicts) == ("success", ())
    assert contracts(trial) == ["PlanDirectly"]


def test_what_is_not_there_ends_it_with_the_best_so_far(tmp_path: Path) -> None:
    class Missing:
        name = "missing"

        def answer(self, request: wt.Request) -> dict[str, Any]:
            said: dict[str, Any] = json.loads(wt.make_model("offline").answer(request).raw)  # type: ignore[union-attr]
            said["targets"][0] |= {"box": None, "points": []}
            return said | {"absent": [said["targets"][0]["id"]]}

    made = decided("direct", photo(tmp_path), Missing())
    assert isinstance(made, GaveUp)
    assert made.plan is not None
    assert (made.plan.status, made.stage, made.reason) == ("not_found", "grounding", "T1 not found: red circle")
    assert [item.status for item in made.plan.grounded.values()] == ["absent", "found"]


def test_words_that_mean_nothing_end_it_as_not_understood(tmp_path: Path) -> None:
    made = decided("direct", replace(photo(tmp_path), instruction=wt.Instruction("frobnicate the zork")))
    assert isinstance(made, GaveUp)
    assert made.plan is not None
    assert made.plan.status == "not_understood"


def test_a_plan_that_was_read_runs_as_it_is(tmp_path: Path) -> None:
    made = decided("direct", photo(tmp_path))
    assert isinstance(made, Act)
    model = Listening(wt.make_model("offline"))
    taken = decided("direct", replace(photo(tmp_path), plan=made.plan), model)
    assert isinstance(taken, Act)
    assert (taken.plan, taken.actions, model.heard) == (made.plan, made.actions, [])


def test_nothing_to_do_is_done(tmp_path: Path) -> None:
    class Satisfied:
        name = "satisfied"

        def answer(self, request: wt.Request) -> dict[str, object]:
            return {"reasoning": "", "subgoals": [], "targets": [], "absent": [], "steps": []}

    made = decided("direct", photo(tmp_path), Satisfied())
    assert isinstance(made, Done)
    assert "already fulfilled" in made.reason


@pytest.mark.parametrize("name", ["tg", "moka"])
def test_a_cap_on_calls_ends_those_that_look_with_a_detector_at_stage_budget(name: str, tmp_path: Path) -> None:
    trial = run(name, "visual_manipulation", tmp_path, max_calls=1)
    assert (trial.outcome, trial.stage, trial.usage.calls) == ("failure", "budget", 1)
    assert trial.page.is_file()


def test_the_command_line_runs_lists_and_shows_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def told(*command: str) -> str:
        with pytest.raises(SystemExit) as ended:
            main(list(command))
        assert ended.value.code == 0
        return capsys.readouterr().out

    listed = json.loads(told("list", "methods", "--json"))["result"]["methods"]
    assert set(RIVALS) <= set(listed)
    assert all(("PRIVILEGED" in listed[name]) == METHODS[name].privileged for name in METHODS)
    told("run", "tabletop/visual_manipulation", "--seed", "500", "--method", "direct", "--out", str(tmp_path))
    assert "PlanDirectly" in told("show", "latest", "--out", str(tmp_path), "--role", "planner")


def test_a_study_estimates_and_runs_a_rival_and_isolates_none_of_its_parts(tmp_path: Path) -> None:
    asked: dict[str, Any] = {"methods": ("direct",), "models": ("simulated:perfect",), "controls": (), "jobs": 1}
    study = wt.Study("tabletop/rotate", seeds=(1000,), store=tmp_path / "s.db", record="none", **asked)
    assert study.run().status.outcomes == {"success": 1}
    line = study.estimate().lines[0]
    assert (line.calls, line.measured) == (1, 1)
    with pytest.raises(ConfigError, match="'direct' does not ask as one role .* valid: .*pivot"):
        wt.Study("tabletop/rotate", isolate="grounding", **asked)
