"""The run folder: complete, readable at every moment, without secrets, and blind to the score."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.runtime.runtime_fake_run import TalkingPolicy, world_with_pictures
from tests.runtime.runtime_fakes import Listener, MovesPolicy, SquaresTruth, SquaresWorld
from wonderful_team.images import draw, load_picture
from wonderful_team.record import Recorder, read_plan, read_plan_scene
from wonderful_team.record.record_schema import read_record
from wonderful_team.runtime import rollout

GOALS = {"red": (200.0, 30.0), "blue": (60.0, 60.0)}


def record_of(folder: Path) -> dict:
    return json.loads((folder / "record.json").read_text(encoding="utf-8"))


def run(folder: Path, *, scored: bool = True, **options):
    world, listener = world_with_pictures(), Listener()
    with Recorder(folder) as recorder:
        policy = TalkingPolicy([recorder, listener], **options)
        scorer = SquaresTruth(world, GOALS) if scored else None
        trial = rollout(
            policy, world, replans=3, scorer=scorer, subscribers=[recorder], seed=3, configuration={"model": "offline"}
        )
    return trial, record_of(folder), listener


def test_the_folder_holds_everything(tmp_path):
    trial, record, _ = run(tmp_path)
    assert {"record.json", "plan.json", "final.png", "log.txt", "pictures"} <= {
        path.name for path in tmp_path.iterdir()
    }
    assert record["schema_version"] == 1
    assert (record["state"], record["outcome"]["outcome"]) == ("finished", "success")
    assert record["configuration"]["model"] == "offline"
    assert record["versions"]["numpy"]
    planner = record["planner"]
    assert planner["instruction"]["text"].startswith("put the {red_thing}")
    assert [plan["id"] for plan in planner["plans"]] == [plan.id for plan in trial.plans]
    assert [run["subgoal"] for run in planner["subgoals"]] == ["G1", "G2", "G1"]
    assert planner["executions"][0]["measured"] == {"held": True}
    assert read_plan(tmp_path).id == trial.plans[-1].id
    assert "grounded" in (tmp_path / "log.txt").read_text(encoding="utf-8")


def test_every_request_with_words_pictures_and_answers(tmp_path):
    _, record, _ = run(tmp_path)
    entries = {entry["key"]: entry for entry in record["planner"]["requests"]}
    draft = entries["0/plan/main/DraftPlan/1 try 1"]
    assert draft["parts"][0] == {"words": "Plan the task."}
    assert (draft["output"], draft["role"], draft["answer"]["provenance"]) == ("PlanDraft", "supervisor", "offline")
    assert draft["answer"]["usage"]["tokens_in"] == 900
    assert draft["answer"]["parsed"]["mode"] == "one_step"
    assert draft["answer"]["raw"] == '{"a": 1}'
    bad = entries["0/ground/T1/JudgeBox/1 try 1"]
    assert (bad["answer"], bad["invalid"]["raw"]) == (None, '{"decision": "good"}')
    assert entries["0/ground/T1/JudgeBox/1 try 2"]["answer"]["repairs"] == ["box clamped"]


def test_pictures_are_stored_as_sent_once_and_in_order(tmp_path):
    _, record, listener = run(tmp_path)
    sent = [part for event in listener.events if event.kind == "request" for part in event.content.pictures]
    first = load_picture(tmp_path / "pictures" / "001_top-view.png")
    assert np.array_equal(first, draw(sent[0]))
    numbered = sorted(path.name for path in (tmp_path / "pictures").glob("[0-9]*.png"))
    different = {draw(picture).tobytes() for picture in sent}
    assert len(numbered) == len(different) < len(sent)
    assert all((tmp_path / file).is_file() for file in record["files"].values())


def test_removing_the_scorer_leaves_the_planners_part_bit_identical(tmp_path):
    _, scored, _ = run(tmp_path / "scored")
    _, unscored, _ = run(tmp_path / "unscored", scored=False)
    assert scored["outcome"]["outcome"] != unscored["outcome"]["outcome"]
    assert json.dumps(scored["planner"]) == json.dumps(unscored["planner"])
    assert "sent_s" not in json.dumps(scored["planner"])


def test_a_killed_process_leaves_a_readable_record(tmp_path):
    """The process dies without any clean-up in the middle of the second motion."""
    code = f"""
import os, sys
sys.path.insert(0, {str(Path(__file__).parents[2])!r})
from pathlib import Path
from tests.runtime.runtime_fakes import MovesPolicy, SquaresWorld
from wonderful_team.record import Recorder
from wonderful_team.runtime import rollout
class Dies(SquaresWorld):
    def execute(self, action):
        if self.ran == 1:
            os._exit(9)
        return super().execute(action)
moves = [((60.0, 60.0), (200.0, 30.0)), ((160.0, 90.0), (60.0, 60.0))]
rollout(MovesPolicy([moves]), Dies(), subscribers=[Recorder(Path({str(tmp_path)!r}))])
"""
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 9
    record = read_record(tmp_path)
    assert record["state"] == "running"
    assert [run["subgoal"] for run in record["planner"]["subgoals"]] == ["G1"]
    assert (tmp_path / "plan.json").is_file()


def test_ctrl_c_leaves_a_record_that_says_so(tmp_path):
    world = SquaresWorld(trouble={2: KeyboardInterrupt()})
    moves = [((60.0, 60.0), (200.0, 30.0)), ((160.0, 90.0), (60.0, 60.0))]
    with Recorder(tmp_path) as recorder, pytest.raises(KeyboardInterrupt):
        rollout(MovesPolicy([moves]), world, subscribers=[recorder])
    record = record_of(tmp_path)
    assert (record["outcome"]["outcome"], record["outcome"]["stage"]) == ("error", "interrupted")
    assert record["planner"]["executions"][1]["fault"].startswith("KeyboardInterrupt")


def test_closing_before_the_end_marks_the_run_as_interrupted(tmp_path):
    Recorder(tmp_path).close()
    assert record_of(tmp_path)["state"] == "interrupted"


def test_no_secret_is_written(tmp_path, monkeypatch):
    monkeypatch.setenv("MY_SERVER_API_KEY", "correct-horse-battery")
    secrets = ["sk-abc123def456ghi789", "AIzaSyA1234567890abcdefgh", "tok_9876543210", "correct-horse-battery"]
    words = f" {secrets[0]} {secrets[1]} Authorization: Bearer {secrets[2]} {secrets[3]}"
    run(tmp_path, secret=words)
    for path in tmp_path.rglob("*"):
        if path.suffix in (".json", ".txt"):
            text = path.read_text(encoding="utf-8")
            assert not [secret for secret in secrets if secret in text], path.name
    assert "[redacted]" in (tmp_path / "record.json").read_text(encoding="utf-8")


def test_the_picture_of_a_recorded_plan_is_found_again(tmp_path):
    """A later run compares what it sees with it: noise is let through, a nudge is not."""
    moves = [((60.0, 60.0), (200.0, 30.0))]
    with Recorder(tmp_path) as recorder:
        rollout(MovesPolicy([moves]), SquaresWorld(noise=4.0), subscribers=[recorder])
    plan = read_plan(tmp_path)
    scene = read_plan_scene(tmp_path, plan)
    assert scene is not None
    assert scene.hash == plan.scene_hash
    later, nudged = SquaresWorld(noise=4.0, reobserve=50), SquaresWorld({"red": (63.0, 60.0)}, noise=4.0, reobserve=50)
    assert rollout(MovesPolicy([]), later, plan=plan, plan_observation=scene).stage is None
    assert rollout(MovesPolicy([]), nudged, plan=plan, plan_observation=scene).stage == "gate"
    assert (later.ran, nudged.ran) == (1, 0)
    next((tmp_path / "pictures").glob("view_001*")).unlink()
    assert read_plan_scene(tmp_path, plan) is None
