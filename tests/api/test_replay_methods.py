"""Runs of every method replay from their own answers, and branch, without their model; what cannot says why."""

from __future__ import annotations

import json
import shutil
from functools import cache

import pytest

import wonderful_team as wt
from tests.desk import read_record
from wonderful_team.api.replay import branch, replay
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError, ReplayError, UnknownNameError
from wonderful_team.offline.detector import ClassicalDetector
from wonderful_team.registry.methods import METHODS
from wonderful_team.simulated.model import SimulatedModel

TASK = "tabletop/visual_manipulation"
EVERY = [name for name, row in METHODS.items() if row.plans and (row.team is None or row.team.ablation == "full")]
PRIVILEGED = [name for name in EVERY if METHODS[name].privileged]


class Cramped:
    """A world where no place is near enough for the gate."""

    def __init__(self, inner):
        self.inner, self.limits = inner, wt.Limits((0.25, -0.5, 0.0), (0.5, 0.0, 0.3))

    def __getattr__(self, name):
        return getattr(self.inner, name)


class Clumsy:
    """Writes programs that fail."""

    name = "clumsy"

    def answer(self, request):
        return {"reasoning": "", "code": "found = segment()\npick_place((10**9, 5), (1, 2))"}


def in_world(method, out, model="simulated:perfect", wrap=lambda world: world, scene=f"{TASK}#3", **more):
    world = wt.make_world(TASK, seed=3)
    try:
        kind = wt.Method if METHODS[method].team is None else wt.Team
        made = kind(method=method, model=model, out=out, **more)
        return wt.rollout(made, wrap(world), seed=3, scene=scene, replans=1)
    finally:
        world.close()


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The folder of one run by a method."""
    out = tmp_path_factory.mktemp("runs")
    return cache(lambda method: in_world(method, out).folder)


def same_again(folder):
    """It replays whole, those requests that failed included."""
    found = replay(folder)
    assert found.now == found.then != ()
    ended = [
        one for one in read_record(folder)["planner"]["requests"] if one["answer"] or one["invalid"] or "failed" in one
    ]
    assert found.answers == len(ended) > 0
    return found


def edited(folder, place, change):
    """A copy of a run whose record is another."""
    record = read_record(folder)
    change(record)
    copy = shutil.copytree(folder, place / "edited")
    (copy / "record.json").write_text(json.dumps(record), encoding="utf-8")
    return copy


@pytest.fixture
def nobody_is_asked(monkeypatch):
    for kind, name in ((SimulatedModel, "answer"), (ClassicalDetector, "detect")):
        monkeypatch.setattr(kind, name, lambda *_: pytest.fail("a model or a detector was asked"))


@pytest.mark.parametrize("method", EVERY)
def test_a_run_of_every_method_replays(method, recorded, monkeypatch, request):
    folder = recorded(method)
    request.getfixturevalue("nobody_is_asked")
    if method not in PRIVILEGED:
        monkeypatch.setattr(
            "wonderful_team.registry.worlds.make_world", lambda *_, **__: pytest.fail("a world was made")
        )
    before = sorted(folder.parent.iterdir())
    same_again(folder)
    assert sorted(folder.parent.iterdir()) == before


@pytest.mark.parametrize("method", ["direct:checked", "tg", "nlap:privileged"])
def test_a_second_plan_after_a_refusal_replays(method, tmp_path):
    trial = in_world(method, tmp_path, wrap=Cramped)
    assert [gate.admitted for gate in trial.gates] == [False, False]
    requests = read_record(trial.folder)["planner"]["requests"]
    assert any("safety gate refused" in part.get("words", "") for one in requests for part in one["parts"])
    same_again(trial.folder)


def test_programs_that_fail_fail_again(tmp_path):
    trial = in_world("instruct2act", tmp_path, Clumsy())
    assert trial.stage == "crash"
    same_again(trial.folder)


def test_a_cap_ends_a_rival_again(tmp_path):
    trial = in_world("pivot", tmp_path, max_calls=4)
    assert trial.stage == "budget" or "cap of 4 calls" in trial.reason
    same_again(trial.folder)


def test_the_command_says_whether_the_plan_is_the_same(recorded, capsys):
    assert run(["show", str(recorded("moka")), "--replay"]) == 0
    assert capsys.readouterr().out.startswith("SAME  2 answers replayed")


def test_another_answer_gives_another_plan(recorded, tmp_path, capsys):
    """The plan is made from the answers: it is not read out of the record."""

    def change(record):
        record["planner"]["requests"][0]["answer"]["parsed"]["targets"][0]["points"][0]["point"]["x"] += 5

    folder = edited(recorded("direct"), tmp_path, change)
    assert run(["show", str(folder), "--replay"]) == 1
    assert capsys.readouterr().out.startswith("DIFFERENT")


# -- branches -------------------------------------------------------------------------------------------------------


def answered_by(trial):
    """Who answered at which stage."""
    asked = read_record(trial.folder)["planner"]["requests"]
    return {(one["stage"], one["answer"]["provenance"]) for one in asked}


@pytest.mark.parametrize(
    ("method", "stage", "who"),
    [
        # In the order in which each of them asks: nlap lists what it sees and then plans, pivot finds points last.
        ("nlap", "plan", {("ground", "replayed"), ("plan", "simulated")}),
        ("pivot", "ground", {("plan", "replayed"), ("act", "replayed"), ("ground", "simulated")}),
        ("tg", "replan", {("plan", "replayed"), ("replan", "simulated")}),
        ("nlap:privileged", "plan", {("plan", "simulated")}),
        ("single-call-grounding", "act", {("plan", "replayed"), ("ground", "replayed"), ("act", "simulated"), ("replan", "simulated")}),
    ],
)  # fmt: skip
def test_a_branch_asks_the_model_from_its_stage_on(method, stage, who, recorded, tmp_path):
    made = branch(recorded(method), stage, "simulated:perfect", out=tmp_path)
    assert (made.outcome, answered_by(made)) == ("success", who)
    assert read_record(made.folder)["configuration"]["parent"] == {"run": recorded(method).name, "from": stage}


def test_a_branch_at_a_stage_that_a_method_has_not_is_refused(recorded):
    with pytest.raises(UnknownNameError, match="stage at which 'direct' asks 'ground'. Known: plan, replan"):
        branch(recorded("direct"), "ground", "offline")


# -- what cannot be run again ---------------------------------------------------------------------------------------


def test_a_method_of_a_file_is_code_that_a_record_does_not_run(recorded, tmp_path):
    folder = edited(recorded("direct"), tmp_path, lambda one: one["configuration"].update(method="rival.py:Rival"))
    for again in (replay, lambda run: branch(run, "plan", "offline")):
        with pytest.raises(ConfigError, match=r"method of this record names code: 'rival.py:Rival'"):
            again(folder)


@pytest.mark.parametrize("scene", ["", "desk.py:Desk#3"])
def test_a_truth_that_cannot_be_had_again_is_named(scene, recorded, tmp_path):
    folder = edited(recorded("nlap:privileged"), tmp_path, lambda one: one["setup"].update(scene=scene))
    with pytest.raises(
        ConfigError, match="'nlap:privileged' was told a simulator's truth, .* cannot be made again: it is called"
    ):
        replay(folder)


def test_a_world_that_looks_otherwise_is_not_taken_for_the_one_that_was(recorded, tmp_path):
    folder = edited(recorded("nlap:privileged"), tmp_path, lambda one: one["setup"].update(seed=4))
    with pytest.raises(ReplayError, match="does not look as it did then"):
        replay(folder)


def test_a_rival_does_not_branch_in_a_world_that_cannot_be_made_again(recorded, tmp_path):
    folder = edited(recorded("direct"), tmp_path, lambda one: one["setup"].update(scene="desk.py:Desk#3"))
    same_again(folder)
    with pytest.raises(
        ConfigError, match="'direct' plans in a world only, .* called 'desk.py:Desk#3'; valid: a task of tabletop"
    ):
        branch(folder, "plan", "offline")


@pytest.mark.parametrize("named", ["owlv2:/no/such/weights", "the eyes of somebody", "eyes.py:Eyes"])
def test_a_branch_names_the_detector_that_is_not_there(named, recorded, tmp_path):
    folder = edited(recorded("moka"), tmp_path, lambda one: one["configuration"].update(detector=named))
    same_again(folder)
    with pytest.raises(
        ConfigError, match=f"looked with detector '{named}', which a branch needs and does not have here"
    ):
        branch(folder, "ground", "offline", out=tmp_path)
    made = branch(folder, "ground", "simulated:perfect", out=tmp_path, detector="classical")
    assert made.outcome == "success"


@pytest.mark.parametrize("method", ["team", "direct"])
def test_a_trial_that_looked_again_replays_and_its_page_says_why(method, tmp_path):
    trial = in_world(method, tmp_path, "simulated:perfect:missed=1")
    assert [plan.status for plan in trial.plans] == ["not_found", "not_found"]
    assert (trial.outcome, trial.stage) == ("failure", "grounding")
    record = read_record(trial.folder)
    assert [one.get("again") for one in record["planner"]["decisions"]] == [True, True]
    assert "could not be made ready: " in trial.page.read_text(encoding="utf-8")
    assert replay(trial.folder).same
