"""Real offline runs, recorded, then run again from their own answers: the same plans, bit for bit."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from tests.desk import WORDS, draw_desk, read_record
from wonderful_team.api.replay import branch, replay
from wonderful_team.cli.app import run
from wonderful_team.core.values import LaterPicture
from wonderful_team.errors import ConfigError, NotUnderstoodError, ReplayError, UnknownNameError
from wonderful_team.offline import OfflineModel
from wonderful_team.record.stored import stored_instruction, stored_observation


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    return draw_desk(tmp_path_factory.mktemp("desk"))


@pytest.fixture
def photo_run(desk, tmp_path):
    """A recorded plan for that photo."""
    photo = wt.Observation.from_files(desk / "desk.png", depth=desk / "depth.png", camera=desk / "camera.json")
    return wt.Team(out=tmp_path / "runs").plan(photo, WORDS)


@pytest.fixture
def network_off(monkeypatch):
    def refused(*_):
        raise AssertionError("a replay opened a connection")

    monkeypatch.setattr(socket.socket, "connect", refused)


@pytest.fixture(scope="module")
def trials(tmp_path_factory):
    """One recorded trial by each way of working."""
    out = tmp_path_factory.mktemp("trials")

    def record(method):
        world = wt.make_world("tabletop/visual_manipulation", seed=3)
        try:
            team = wt.Team(method=method, out=out)
            return wt.rollout(team, world, seed=3, scene="tabletop/visual_manipulation#3", replans=1)
        finally:
            world.close()

    return {method: record(method) for method in ("team", "team:paper")}


def _edit(folder, change):
    record = read_record(folder)
    change(record)
    (Path(folder) / "record.json").write_text(json.dumps(record), encoding="utf-8")


# -- the same plan --------------------------------------------------------------------------------------------------


def test_a_photo_with_depth_and_camera_gives_the_same_plan(photo_run, network_off):
    found = replay(photo_run.folder)
    assert found.now == (photo_run.id,)
    assert found.same
    assert photo_run.status == "planned"
    assert found.answers == len(read_record(photo_run.folder)["planner"]["requests"])
    assert found.differences == ()


@pytest.mark.parametrize("method", ["team", "team:paper"])
def test_a_trial_on_the_tabletop_gives_the_same_plan(trials, method, network_off):
    trial = trials[method]
    found = replay(trial.folder)
    assert found.now == tuple(plan.id for plan in trial.plans)
    assert found.same


def test_no_model_and_no_world_is_asked_and_no_folder_is_left(trials, monkeypatch):
    trial = trials["team"]
    before = sorted(trial.folder.parent.iterdir())
    latest = (trial.folder.parent / "latest").resolve()
    monkeypatch.setattr("wonderful_team.registry.worlds.make_world", lambda *_: pytest.fail("a world was made"))
    monkeypatch.setattr(OfflineModel, "answer", lambda *_: pytest.fail("a model was asked"))
    assert replay(trial.folder).same
    assert sorted(trial.folder.parent.iterdir()) == before
    assert (trial.folder.parent / "latest").resolve() == latest


class Stuck:
    """A tabletop whose robot reports a fault the first time and does nothing."""

    def __init__(self, inner):
        self.inner, self.tries = inner, 0

    def __getattr__(self, name):
        return getattr(self.inner, name)

    def execute(self, action):
        self.tries += 1
        if self.tries == 1:
            return wt.StepReport(action, False, {"tool_m": [0.1, 0.2, 0.3]}, "the suction cup did not reach")
        return self.inner.execute(action)


def test_a_trial_with_a_second_plan_is_replayed_whole(tmp_path):
    """The first plan runs into a fault: it is judged from what the robot reported, and the second one is made anew."""
    inner = wt.make_world("tabletop/visual_manipulation", seed=3)
    trial = wt.rollout(wt.Team(out=tmp_path), Stuck(inner), replans=2)
    inner.close()
    record = read_record(trial.folder)
    assert trial.outcome == "success"
    assert len(record["planner"]["decisions"]) == 3
    asked = [entry for entry in record["planner"]["requests"] if entry["answer"]]
    assert any("did not reach" in part.get("words", "") for entry in asked for part in entry["parts"])
    found = replay(trial.folder)
    assert found.now == tuple(dict.fromkeys(plan.id for plan in trial.plans))
    assert found.answers == len(asked)


def test_a_trial_that_the_gate_refused_is_replayed(tmp_path):
    inner = wt.make_world("tabletop/visual_manipulation", seed=3)
    world = Stuck(inner)
    world.limits = wt.Limits((0.25, -0.5, 0.0), (0.5, 0.0, 0.3))
    trial = wt.rollout(wt.Team(out=tmp_path), world, replans=2)
    inner.close()
    record = read_record(trial.folder)
    assert [gate["admitted"] for gate in record["planner"]["gates"]][0] is False
    asked = [entry for entry in record["planner"]["requests"] if entry["answer"]]
    assert any("safety gate refused" in part.get("words", "") for entry in asked for part in entry["parts"])
    found = replay(trial.folder)
    assert found.same
    assert found.answers == len(asked)


def test_grounding_alone_is_replayed(desk, tmp_path):
    found = wt.Team(out=tmp_path).ground(wt.Observation.from_files(desk / "desk.png"), ["red circle"])
    assert found.status == "grounded"
    assert replay(found.folder).now == (found.id,)


def test_a_run_that_ended_in_an_error_of_the_model_ends_so_again(desk, tmp_path):
    photo = wt.Observation.from_files(desk / "desk.png")
    made = wt.Team(out=tmp_path).plan(photo, "put the flurb on the blue square")
    assert made.status == "not_understood"
    failed = [entry["failed"] for entry in read_record(made.folder)["planner"]["requests"] if "failed" in entry]
    assert failed[0]["error"] == NotUnderstoodError.__name__
    found = replay(made.folder)
    assert found.same
    assert found.answers >= 1


def test_a_run_that_ended_at_a_cap_ends_so_again(desk, tmp_path):
    made = wt.Team(out=tmp_path, max_calls=2).plan(wt.Observation.from_files(desk / "desk.png"), WORDS)
    assert made.status == "budget"
    assert replay(made.folder).same


def test_an_invalid_answer_is_replayed_as_invalid(desk, tmp_path):
    class Stumbling(OfflineModel):
        def answer(self, request):
            if request.contract == "ReviewSteps" and request.attempt == 0:
                return '{"reasoning": 3}'
            return super().answer(request)

    made = wt.Team(model=Stumbling(), out=tmp_path).plan(wt.Observation.from_files(desk / "desk.png"), WORDS)
    entries = read_record(made.folder)["planner"]["requests"]
    assert any(entry["invalid"] for entry in entries)
    found = replay(made.folder)
    assert (found.same, found.answers) == (True, len(entries))


def test_the_pictures_come_back_bit_for_bit(photo_run):
    record = read_record(photo_run.folder)
    seen = stored_observation(photo_run.folder, record)
    assert seen.hash == photo_run.observation.hash
    assert np.array_equal(seen.main.depth_m, photo_run.observation.main.depth_m, equal_nan=True)
    assert np.array_equal(seen.main.camera.K, photo_run.observation.main.camera.K)


def test_the_instructions_pictures_come_back(trials):
    folder = trials["team"].folder
    instruction = stored_instruction(folder, read_record(folder))
    assert set(instruction.slots) == {"dragged_obj_1", "base_obj"}
    assert list(instruction.slots["base_obj"].views) == ["top", "front"]


# -- what does not match --------------------------------------------------------------------------------------------


def test_other_words_are_named(photo_run):
    def change(record):
        entry = next(e for e in record["planner"]["requests"] if e["contract"] == "DraftPlan")
        words = next(part for part in entry["parts"] if "words" in part)
        words["words"] = "Something else. " + words["words"]

    _edit(photo_run.folder, change)
    with pytest.raises(ReplayError, match=r"request 0/plan/main/DraftPlan/1 \(try 1\) .* part \d+: words .*Something"):
        replay(photo_run.folder)
    found = replay(photo_run.folder, tolerant=True)
    assert found.same
    assert "0/plan/main/DraftPlan/1" in found.differences[0]


def test_another_picture_is_named(photo_run):
    def change(record):
        entry = next(e for e in record["planner"]["requests"] if e["contract"] == "JudgeBoxes")
        next(part for part in entry["parts"] if "picture" in part)["clean"] = "0" * 16

    _edit(photo_run.folder, change)
    with pytest.raises(ReplayError, match=r"JudgeBoxes/1 \(try 1\) .* has other pixels"):
        replay(photo_run.folder)


def test_pictures_that_an_earlier_release_named_by_their_pixels_are_known(desk, tmp_path, monkeypatch):
    with monkeypatch.context() as earlier:
        earlier.setattr(LaterPicture, "source_hash", property(lambda picture: picture.hash))
        made = wt.Team(out=tmp_path / "runs").plan(wt.Observation.from_files(desk / "desk.png"), WORDS)
    assert replay(made.folder).same


def test_a_request_that_was_never_asked_is_named(photo_run):
    def change(record):
        requests = record["planner"]["requests"]
        record["planner"]["requests"] = [e for e in requests if e["contract"] != "ReviewSteps"]

    _edit(photo_run.folder, change)
    with pytest.raises(ReplayError, match=r"0/act/main/ReviewSteps/1 \(try 1\) is not in the record"):
        replay(photo_run.folder)


def test_a_changed_picture_file_is_refused(photo_run):
    record = read_record(photo_run.folder)
    key = next(iter(record["planner"]["observations"][0]["views"].values()))
    file = photo_run.folder / record["files"][key]
    rgb = cv2.imread(str(file))
    rgb[0, 0] += 1
    cv2.imwrite(str(file), rgb)
    with pytest.raises(ConfigError, match="is not the picture that was recorded"):
        replay(photo_run.folder)


def test_a_record_of_an_earlier_release_says_why_it_cannot_be_run_again(photo_run):
    _edit(photo_run.folder, lambda record: record.pop("setup"))
    with pytest.raises(ConfigError, match="does not say how it was called"):
        replay(photo_run.folder)


# -- branches -------------------------------------------------------------------------------------------------------


class Counting(OfflineModel):
    def __init__(self):
        super().__init__()
        self.asked = []

    def answer(self, request):
        self.asked.append(request)
        return super().answer(request)


@pytest.mark.parametrize(
    ("stage", "asked"),
    [("plan", {"plan", "ground", "act"}), ("ground", {"ground", "act"}), ("act", {"act"})],
)
def test_a_branch_asks_the_model_from_its_stage_on_only(photo_run, tmp_path, stage, asked):
    model = Counting()
    made = branch(photo_run.folder, stage, model, out=tmp_path / "branches")
    assert {request.stage for request in model.asked} == asked
    assert made.id == photo_run.id
    record = read_record(made.folder)
    assert record["configuration"]["parent"] == {"run": photo_run.folder.name, "from": stage}
    assert made.folder.parent == tmp_path / "branches"
    marks = {
        entry["stage"]: entry["answer"]["provenance"] for entry in record["planner"]["requests"] if entry["answer"]
    }
    assert marks["act"] == "offline"
    assert marks["plan"] == ("offline" if stage == "plan" else "replayed")
    assert "branched off" in made.page.read_text(encoding="utf-8")


def test_a_branch_that_leads_back_to_the_plan_goes_on_with_the_model(photo_run, tmp_path):
    """The model does not find what was found: the plan goes back to the Supervisor, whom the record cannot answer for."""

    class Blind(Counting):
        def answer(self, request):
            answer = super().answer(request)
            if request.contract == "ReadScene":
                missing = [{"id": item.id, "found": False, "box": None, "points": []} for item in answer.value.targets]
                return {**answer.value.model_dump(), "targets": missing}
            return answer

    model = Blind()
    made = branch(photo_run.folder, "ground", model, out=tmp_path / "branches")
    assert made.status == "not_found"
    assert "plan" in {request.stage for request in model.asked}


def test_a_branch_of_a_trial_runs_in_the_simulator(trials, tmp_path):
    made = branch(trials["team"].folder, "replan", "offline", out=tmp_path)
    assert made.outcome == trials["team"].outcome == "success"
    assert {
        entry["answer"]["provenance"] for entry in read_record(made.folder)["planner"]["requests"] if entry["answer"]
    } == {
        "offline",
        "replayed",
    }
    # The branch is a run like any other.
    assert replay(made.folder).same


def test_a_branch_needs_a_stage_that_exists(photo_run):
    with pytest.raises(UnknownNameError, match="Did you mean 'ground'"):
        branch(photo_run.folder, "grond", "offline")


# -- the command line -----------------------------------------------------------------------------------------------


def test_show_replay_says_the_same(photo_run, capsys):
    assert run(["show", str(photo_run.folder), "--replay", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)["result"]
    assert result["same"] is True
    assert result["plan_ids"] == result["recorded_plan_ids"] == [photo_run.id]


def test_show_replay_fails_with_a_message_when_the_record_was_changed(photo_run, capsys):
    _edit(photo_run.folder, lambda record: record["planner"]["requests"][0].update(role="nobody"))
    assert run(["show", str(photo_run.folder), "--replay"]) == 2
    assert "role is 'verification', was 'nobody'" in capsys.readouterr().err


def test_show_replay_tells_another_plan(photo_run, capsys):
    _edit(photo_run.folder, lambda record: record["planner"]["plans"][0].update(id="0" * 12))
    assert run(["show", str(photo_run.folder), "--replay"]) == 1
    assert f"plan 1: {'0' * 12} -> {photo_run.id}" in capsys.readouterr().out


def test_show_from_writes_a_run_beside_its_parent(photo_run, capsys):
    assert run(["show", str(photo_run.folder), "--from", "act", "--model", "offline"]) == 0
    said = capsys.readouterr().out
    assert f"branched off {photo_run.folder.name} at act" in said
    assert said.strip().splitlines()[-1].startswith("page:")
    assert len([path for path in photo_run.folder.parent.iterdir() if not path.is_symlink()]) == 2


def test_show_diff_puts_runs_side_by_side(photo_run, desk, capsys):
    other = wt.Team(out=photo_run.folder.parent).plan(
        wt.Observation.from_files(desk / "desk.png"), "put the blue square on the red circle"
    )
    assert run(["show", str(photo_run.folder), "--diff", str(other.folder)]) == 0
    said = capsys.readouterr().out
    assert "plans: different" in said
    row = next(line for line in said.splitlines() if line.startswith("subgoal G1"))
    assert "*" in row
    assert "put the red circle" in row.split("|")[0]
    assert "put the blue square" in row.split("|")[1]
    assert run(["show", str(photo_run.folder), "--diff", str(photo_run.folder), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)["result"]
    assert (result["same_plans"], result["answers"]) == (True, [])


@pytest.mark.parametrize(
    "words",
    [["--replay", "--from", "act", "--model", "offline"], ["--from", "act"], ["--model", "offline"], ["--tolerant"]],
)
def test_options_that_do_not_go_together_are_wrong_use(photo_run, words, capsys):
    assert run(["show", str(photo_run.folder), *words]) == 2
