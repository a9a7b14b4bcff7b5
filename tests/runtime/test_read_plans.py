"""A plan that was read beforehand runs as it is, in its own instruction and scene, or nothing moves."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from tests.runtime.runtime_fakes import COLOURS, Listener, MovesPolicy, SquaresTruth, SquaresWorld, camera, make_plan
from wonderful_team.core.geometry import AffineCamera
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Instruction, Observation, ReadPlan, Slot
from wonderful_team.errors import ConfigError
from wonderful_team.record import read_run_plan
from wonderful_team.record.recorder import Recorder
from wonderful_team.runtime import rollout

RED, BLUE = (60.0, 60.0), (160.0, 90.0)
UP, MIDDLE = (200.0, 30.0), (120.0, 60.0)


def read_in(world, moves=((RED, UP),), **fields):
    """A plan that was made from what the world shows now."""
    seen = world.observe()
    return ReadPlan(make_plan(seen, list(moves), **fields), seen)


def run_read(world, read, answers=(), **options):
    policy = MovesPolicy([list(moves) for moves in answers])
    return rollout(policy, world, plan=read, **options), policy


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"instruction": Instruction("put the red square at the lower left")}, "instruction of the plan"),
        ({"scene_hash": "0" * 64}, "picture of the plan"),
        ({"scene_hash": ""}, "picture of the plan"),
        ({"status": "not_found"}, "status of the plan"),
    ],
)
def test_a_plan_for_something_else_moves_nothing_and_is_not_replanned(fields, says):
    world = SquaresWorld()
    read = read_in(world, **fields)
    trial, policy = run_read(world, read, answers=[[(RED, UP)]] * 3, replans=3)
    assert (trial.outcome, trial.stage, world.ran) == ("failure", "gate", 0)
    assert says in trial.reason
    assert len(policy.asked) == 1


def test_every_reason_is_said_at_once():
    world = SquaresWorld({"red": (30.0, 60.0), "blue": BLUE})
    read = read_in(SquaresWorld(), instruction=Instruction("put it away"), verified=False)
    trial, _ = run_read(world, read, answers=[[(RED, UP)]], replans=3, strict=True)
    for reason in ("instruction of the plan", "Verification (strict)", "unchanged: T1 (pick)"):
        assert reason in trial.reason


def test_once_it_ran_replans_go_on():
    world = SquaresWorld()
    trial, policy = run_read(
        world, read_in(world, [(RED, MIDDLE)]), [[(MIDDLE, UP)]], replans=1, scorer=SquaresTruth(world, {"red": UP})
    )
    assert (trial.outcome, world.ran) == ("success", 2)
    assert [asked.plan is not None for asked in policy.asked] == [True, False, False]


def test_a_plan_that_was_read_is_not_replanned_when_its_second_action_is_refused():
    world = SquaresWorld(nudge={5: ("blue", 6.0)})
    read = read_in(world, [(RED, MIDDLE), (BLUE, RED)])
    trial, policy = run_read(world, read, answers=[[(RED, UP)]] * 3, replans=3)
    assert (trial.stage, world.ran, len(policy.asked)) == ("gate", 1, 1)


def test_a_noisy_camera_changes_nothing_and_a_moved_thing_does():
    noisy = SquaresWorld(noise=4.0)
    read = read_in(noisy)
    assert noisy.observe().hash != read.observation.hash
    trial, _ = run_read(noisy, read, scorer=SquaresTruth(noisy, {"red": UP}))
    assert trial.outcome == "success"
    moved = SquaresWorld({"red": (63.0, 60.0), "blue": BLUE}, noise=4.0, reobserve=5)
    trial, _ = run_read(moved, read)
    assert (trial.stage, moved.ran) == ("gate", 0)
    elsewhere = SquaresWorld({"red": RED, "blue": (100.0, 110.0)}, noise=4.0, reobserve=5)
    assert run_read(elsewhere, read)[0].stage is None


def test_without_its_picture_the_scene_must_be_the_same_pixel_for_pixel():
    bare = replace(read_in(SquaresWorld()), observation=None)
    assert run_read(SquaresWorld(), bare)[0].stage is None
    trial, _ = run_read(SquaresWorld(noise=4.0), bare)
    assert (trial.stage, "picture of the plan is not at hand" in trial.reason) == ("gate", True)
    unnamed = replace(bare, plan=replace(bare.plan, scene_hash=""))
    trial, _ = run_read(SquaresWorld(), unnamed)
    assert (trial.stage, "the plan names none" in trial.reason) == ("gate", True)


def test_strict_refuses_what_verification_did_not_approve():
    read = read_in(SquaresWorld(), verified=False)
    world = SquaresWorld()
    trial, _ = run_read(world, read, strict=True)
    assert (trial.stage, world.ran) == ("gate", 0)
    assert run_read(SquaresWorld(), read)[0].stage is None


class ShiftedCamera(SquaresWorld):
    """The same pixels, with another calibration: 3 cm to the side."""

    def observe(self):
        seen = super().observe()
        matrix = camera().matrix.copy()
        matrix[0, 3] += 0.03 * 256
        return Observation({"top": replace(seen.main, camera=AffineCamera(matrix))})


def test_metres_of_another_calibration_do_not_run():
    world = ShiftedCamera()
    trial, _ = run_read(world, read_in(SquaresWorld()))
    assert (trial.stage, world.ran) == ("gate", 0)
    assert "camera of the plan" in trial.reason
    assert "px apart" in trial.reason


@pytest.mark.parametrize("time_s", [-5000.0, 5000.0])
def test_the_clock_of_an_earlier_run_says_nothing(time_s):
    world = SquaresWorld(noise=4.0)
    seen = world.observe()
    old = Observation({"top": replace(seen.main, time_s=time_s)})
    read = ReadPlan(make_plan(old, [(RED, UP)]), old)
    trial, _ = run_read(world, read)
    assert (trial.stage, "picture age" in trial.reason) == ("gate", True)
    assert run_read(world, replace(read, same_clock=False))[0].stage is None


def test_pictures_of_the_instruction_count():
    def asking_for(colour):
        seen = SquaresWorld({colour: RED}).observe().main
        picture = replace(seen, id="slot:thing:top", camera=None, depth_m=None)
        return _said(picture)

    world = SquaresWorld(instruction=asking_for("red"))
    trial, _ = run_read(world, read_in(world, instruction=asking_for("green")))
    assert (trial.stage, "another picture for 'thing'" in trial.reason) == ("gate", True)
    world = SquaresWorld(instruction=asking_for("red"))
    assert run_read(world, read_in(world, instruction=asking_for("red")))[0].stage is None


def _said(picture):
    return Instruction("put the {thing} at the upper right", {"thing": Slot("thing", "object", {"top": picture})})


@pytest.fixture
def recorded(tmp_path):
    """The folder of a run that planned in a noisy world."""
    world = SquaresWorld(noise=4.0)
    seen = world.observe()
    plan = make_plan(seen, [(RED, UP)])
    with Recorder(tmp_path / "run") as recorder:
        for event in (
            Event("run", "plan", {"task": world.instruction, "limits": world.limits}),
            Event("observe", "start", seen),
            Event("plan", plan.id, plan),
            Event("done", "planned", plan),
        ):
            recorder.on_event(event)
    (tmp_path / "run" / "page.html").write_text("a page", encoding="utf-8")
    return tmp_path / "run"


def test_a_run_folder_gives_the_plan_with_its_picture_and_page(recorded):
    read = read_run_plan(recorded)
    assert read.observation is not None
    assert read.observation.hash == read.plan.scene_hash
    assert read.observation.main.camera is not None
    assert len(read.page_hash) == 64
    world = SquaresWorld(noise=4.0, reobserve=9)
    assert run_read(world, read)[0].stage is None
    assert world.ran == 1


def test_a_picture_that_was_changed_since_is_not_at_hand(recorded):
    record = json.loads((recorded / "record.json").read_text(encoding="utf-8"))
    file = recorded / next(iter(record["files"].values()))
    rgb = np.array(Image.open(file).convert("RGB"))
    rgb[5, 5] = COLOURS["green"]
    Image.fromarray(rgb).save(file)
    read = read_run_plan(recorded)
    assert read.observation is None
    world = SquaresWorld(noise=4.0, reobserve=9)
    trial, _ = run_read(world, read)
    assert (trial.stage, world.ran) == ("gate", 0)


def test_a_record_that_is_broken_is_named(recorded):
    (recorded / "record.json").write_text("[" * 100_000, encoding="utf-8")
    with pytest.raises(ConfigError, match=r"record\.json' is nested too deeply"):
        read_run_plan(recorded)


def test_the_question_of_a_plan_that_was_read_is_in_the_record():
    listener = Listener()
    world = SquaresWorld()
    run_read(world, read_in(world), subscribers=[listener])
    gates = [event.content for event in listener.events if event.kind == "gate"]
    assert {"status of the plan", "instruction of the plan", "plan that was read", "camera of the plan"} <= {
        check.name for check in gates[0].checks
    }
