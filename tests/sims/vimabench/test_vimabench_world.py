"""The adapter over the real pipe, with a stand-in for the benchmark at the other end."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from wonderful_team.core.actions import Home, PickPlace, Push
from wonderful_team.core.protocols import Act, Done, SceneTruth, Situation, World, offers
from wonderful_team.errors import ConfigError, UnknownNameError, WorldUnavailableError
from wonderful_team.evals.controls import planned
from wonderful_team.runtime import rollout
from wonderful_team.sims.process import client
from wonderful_team.sims.vimabench import VimaWorld
from wonderful_team.sims.vimabench.client import start
from wonderful_team.sims.vimabench.finding import find_installation

NO_ROOM, CRASH, HANG, LATE, SLOW, ENDS_BADLY = 100, 101, 102, 103, 104, 105
Open = Callable[..., VimaWorld]


def pick(world: VimaWorld, name: str, to: tuple[float, float], yaw_rad: float = 0.0) -> PickPlace:
    x, y, _ = world.privileged.things()[name].position_m
    return PickPlace(np.array([x, y, 0.06]), np.array([*to, 0.0]), yaw_rad)


def test_a_world_looks_like_every_other_world(open_world: Open) -> None:
    world = open_world("rotate", seed=3)
    assert isinstance(world, World)
    assert offers(world.privileged, SceneTruth)
    observation = world.observe()
    assert list(observation.views) == ["top", "front"]
    assert observation.main.size_px == (256, 128)
    assert observation.main.depth_m is None
    assert world.vocabulary.kinds == ("pick_place",)
    assert (world.limits.low_m[:2], world.limits.high_m[:2]) == ((0.25, -0.5), (0.75, 0.5))
    assert world.instruction.text == "Rotate the {dragged_obj} 30 degrees."
    assert world.instruction.slots["dragged_obj"].views["top"].id == "slot:dragged_obj:top"
    # The benchmark's own evaluation reads it before the first reset, and adds two.
    assert world.horizon == 3 + 2
    assert world.observe().hash == observation.hash


def test_the_same_seed_is_the_same_scene_and_another_is_not(open_world: Open) -> None:
    first, again, other = open_world("rotate", 1), open_world("rotate", 1), open_world("rotate", 2)
    assert first.observe().hash == again.observe().hash != other.observe().hash


def test_pictures_of_sequences_and_pairs_say_what_they_are(open_world: Open) -> None:
    follow = open_world("follow_motion").instruction
    assert [(slot.name, slot.kind, slot.index) for slot in follow.slots.values()] == [
        ("dragged_obj", "object", None),
        ("frame_0", "frame", 0),
        ("frame_1", "frame", 1),
    ]
    twist = open_world("twist").instruction
    assert [(slot.kind, slot.index) for slot in twist.slots.values()] == [("before", 1), ("after", 1)]
    assert open_world("visual_manipulation").instruction.slots["base_obj"].kind == "scene"


def test_the_oracle_solves_and_the_simulator_judges(open_world: Open) -> None:
    for task in ("rotate", "visual_manipulation", "sweep_without_exceeding"):
        world = open_world(task)
        assert world.privileged.score().success is False
        (action,) = world.privileged.oracle()
        assert world.execute(action).executed
        assert world.privileged.score().success is True, task
        assert not world.privileged.oracle()


def test_a_turn_is_our_yaw(open_world: Open) -> None:
    world = open_world("rotate")
    before = world.privileged.start()["ruby cube"]
    (action,) = world.privileged.oracle()
    assert isinstance(action, PickPlace)
    assert action.yaw_rad == pytest.approx(-math.radians(30), abs=1e-6)
    report = world.execute(action)
    assert report.measured == {"held": True, "turned_rad": round(action.yaw_rad, 4)}
    after = world.privileged.things()["ruby cube"]
    assert after.yaw_rad - before.yaw_rad == pytest.approx(-math.radians(30), abs=1e-3)


@pytest.mark.parametrize(
    ("what", "stage"),
    [("table", "grounding"), ("jade cube", "wrong object"), ("ruby cube", "execution")],
)
def test_a_failure_says_at_which_stage(open_world: Open, what: str, stage: str) -> None:
    world = open_world("visual_manipulation")
    away = (0.7, 0.4)
    if what == "table":
        world.execute(PickPlace(np.array([0.7, -0.45, 0.0]), np.array([*away, 0.0])))
    else:
        world.execute(pick(world, what, away))
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, stage)


def test_a_broken_rule_is_a_failure_whatever_comes_after(open_world: Open) -> None:
    world = open_world("visual_manipulation")
    world.execute(pick(world, "jade cube", (0.45, 0.2)))
    assert world.privileged.oracle() == []
    world.execute(pick(world, "jade cube", (0.7, 0.4)))
    world.execute(pick(world, "ruby cube", (0.45, 0.2)))
    score = world.privileged.score()
    assert score.success is False
    assert "rule" in score.reason


def test_nothing_after_success_or_the_horizon_counts(open_world: Open) -> None:
    world = open_world("visual_manipulation", seed=ENDS_BADLY)
    (action,) = world.privileged.oracle()
    world.execute(action)
    # The real simulator may not bear to be judged again after its end; the arm moves all the same.
    assert world.execute(pick(world, "ruby cube", (0.7, 0.4))).executed
    assert world.privileged.things()["ruby cube"].position_m[0] == pytest.approx(0.7, abs=0.01)
    assert world.privileged.score().success is True
    slow = open_world("visual_manipulation")
    for _ in range(slow.horizon):
        slow.execute(PickPlace(np.array([0.7, -0.45, 0.0]), np.array([0.7, 0.4, 0.0])))
    slow.execute(pick(slow, "ruby cube", (0.45, 0.2)))
    assert slow.privileged.score().success is False


def test_no_name_of_a_thing_comes_with_what_an_agent_may_see() -> None:
    simulator = start(find_installation())
    try:
        path = find_installation().path
        opened = simulator.ask("open", path=path, task="rotate", level="", seed=0)
        half = np.array([0, 0, 0, 1], np.float32)
        point = np.array([0.5, 0.0], np.float32)
        action = {"pose0_position": point, "pose0_rotation": half, "pose1_position": point, "pose1_rotation": half}
        stepped = simulator.ask("step", action)
        for said, arrays in (opened, stepped):
            told = json.dumps(said)
            assert not [
                name for name in ("ruby", "jade", "amber", "cube", "tray", "success", "failure") if name in told
            ]
            assert {name.partition(":")[0] for name in arrays} <= {"view", "slot"}
    finally:
        simulator.close()


def test_truth_names_everything_when_it_is_asked(open_world: Open) -> None:
    world = open_world("visual_manipulation")
    things = world.privileged.things()
    assert {name: thing.kind for name, thing in things.items()} == {
        "amber tray": "container",
        "ruby cube": "object",
        "jade cube": "object",
    }
    cube = things["ruby cube"]
    assert (cube.shape, cube.cover, cube.words) == ("cube", "ruby", "ruby cube")
    assert cube.height_m == pytest.approx(0.06)
    sides = np.linalg.norm(np.diff(np.vstack([cube.outline_m, cube.outline_m[:1]]), axis=0), axis=1)
    assert sides == pytest.approx([0.07] * 4, abs=1e-4)
    truth = world.privileged.truth()
    assert truth["slots"] == {"dragged_obj_1": "ruby cube", "base_obj": None}
    assert [one["thing"] for one in truth["pictures"]["base_obj"]["stands"]] == ["ruby cube", "prop base_obj 1"]
    assert truth["props"]["prop base_obj 1"] == {"shape": "cube", "texture": "onyx"}
    assert truth["distractors"] == ["jade cube"]
    assert open_world("sweep_without_exceeding").privileged.things()["amber tray"].kind == "area"


def test_sights_are_what_was_seen_newest_first(open_world: Open) -> None:
    world = open_world("rotate")
    before = world.observe()
    world.execute(world.privileged.oracle()[0])
    world.execute(pick(world, "ruby cube", (0.7, 0.4)))
    observation_log = world.privileged.observation_log("top")
    assert [sight.view.hash for sight in observation_log] == [look.main.hash for look in reversed(world.looks)]
    assert observation_log[-1].view.hash == before.main.hash
    for sight in (observation_log[0], observation_log[-1]):
        rows, columns = np.nonzero(sight.masks["ruby cube"])
        assert (sight.view.rgb[rows, columns] == (200, 30, 30)).all()
    thing = world.privileged.things()["ruby cube"]
    seen = world.observe().main.camera.project([thing.position_m])[0]  # type: ignore[union-attr]
    rows, columns = np.nonzero(observation_log[0].masks["ruby cube"])
    assert seen == pytest.approx((columns.mean() + 0.5, rows.mean() + 0.5), abs=1.0)
    (slot,) = world.privileged.observation_log("slot:dragged_obj:front")
    assert slot.view.id == "slot:dragged_obj:front"
    assert slot.masks["ruby cube"].sum() == 28 * 28
    assert world.privileged.observation_log("slot:other:top") == ()


def test_a_grasp_point_lies_on_what_is_seen(open_world: Open) -> None:
    world = open_world("rotate")
    for name, thing in world.privileged.things().items():
        column, row = world.observe().main.camera.project([thing.grasp_m])[0]  # type: ignore[union-attr]
        assert world.privileged.masks()[name][int(row), int(column)], name


def test_levels_come_from_the_benchmarks_own_tables(open_world: Open) -> None:
    world = open_world("visual_manipulation@L1")
    sides = np.ptp(world.privileged.things()["jade cube"].outline_m, axis=0)
    assert sides == pytest.approx([0.08, 0.08], abs=1e-6)
    with pytest.raises(UnknownNameError, match="partition of follow_motion"):
        open_world("follow_motion@L1")
    with pytest.raises(ConfigError, match="does not exist at level L3"):
        open_world("rotate@L3")


def test_a_seed_that_cannot_be_set_up_is_kept_and_told(open_world: Open) -> None:
    with pytest.raises(WorldUnavailableError, match=r"no free place after 10 tries.*seed is kept"):
        open_world("rotate", seed=NO_ROOM)


class OneAction:
    """A method that does what it is given."""

    name = "one action"

    def __init__(self, action: PickPlace) -> None:
        self._action = action

    def decide(self, situation: Situation) -> Act | Done:
        return Done() if situation.executed else Act((planned(self._action, 1),))


def test_an_arm_that_is_late_is_an_error_of_the_world_and_not_of_the_method(open_world: Open) -> None:
    world = open_world("rotate", seed=LATE)
    (action,) = world.privileged.oracle()
    trial = rollout(OneAction(action), world, scorer=world.privileged)  # type: ignore[arg-type]
    assert (trial.outcome, trial.stage) == ("error", "world")
    assert "did not arrive" in trial.reason
    assert world.privileged.score().success is None
    with pytest.raises(WorldUnavailableError, match="run the trial again"):
        world.execute(action)


def test_a_busy_machine_does_not_make_the_arm_late(open_world: Open) -> None:
    world = open_world("rotate", seed=SLOW)
    assert world.notes == ()
    (action,) = world.privileged.oracle()
    assert world.execute(action).executed
    assert world.privileged.score().success is True


def test_a_crash_tells_what_was_printed_last(open_world: Open) -> None:
    world = open_world("rotate", seed=CRASH)
    (action,) = world.privileged.oracle()
    with pytest.raises(WorldUnavailableError, match=r"ended while it was asked 'step'(.|\n)*something broke inside"):
        world.execute(action)
    with pytest.raises(ConfigError, match="closed"):
        world.observe()


def test_a_simulator_that_hangs_is_ended(open_world: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    world = open_world("rotate", seed=HANG)
    (action,) = world.privileged.oracle()
    monkeypatch.setattr("wonderful_team.sims.vimabench.world.STEP_TIMEOUT_S", 0.3)
    with pytest.raises(WorldUnavailableError, match=r"did not answer 'step' within 0\.3 s"):
        world.execute(action)
    assert world._simulator._process.poll() is not None


def test_what_cannot_be_done_is_a_fault_and_what_is_wrong_an_error(open_world: Open) -> None:
    world = open_world("rotate")
    start = world.observe().hash
    report = world.execute(PickPlace(np.array([0.5, 0.0, 0.0]), np.array([0.8, 0.0, 0.0])))
    assert not report.executed
    assert report.fault == "place x = 0.800 m is out of reach [0.25, 0.75] m"
    with pytest.raises(ConfigError, match="runs pick_place; got push"):
        world.execute(Push(np.array([0.5, 0.0, 0.0]), np.array([0.6, 0.0, 0.0])))
    with pytest.raises(ConfigError, match="runs pick_place; got home"):
        world.execute(Home())
    world.stop()
    assert world.execute(world.privileged.oracle()[0]).fault == "the world was stopped"
    assert world.observe().hash == start


def test_two_worlds_at_once_do_not_meet(open_world: Open) -> None:
    one, two = open_world("visual_manipulation", 1), open_world("visual_manipulation", 2)
    seen = two.observe().hash
    one.execute(one.privileged.oracle()[0])
    assert two.observe().hash == seen
    assert two.privileged.score().success is False
    two.execute(two.privileged.oracle()[0])
    assert one.privileged.score().success is True
    assert two.privileged.score().success is True


def test_closing_ends_the_process_and_wipes_its_folder(open_world: Open) -> None:
    world = open_world("rotate")
    process, scratch = world._simulator._process, world._simulator._scratch
    assert scratch.is_dir()
    world.close()
    world.close()
    assert process.poll() is not None
    assert not scratch.exists()
    with pytest.raises(ConfigError, match="closed; make a new one"):
        world.execute(PickPlace(np.array([0.5, 0.0, 0.0]), np.array([0.5, 0.1, 0.0])))


def test_a_world_that_is_forgotten_leaves_no_process_behind() -> None:
    world = VimaWorld("rotate")
    process = world._simulator._process
    del world
    assert process.poll() is not None


@pytest.mark.skipif(not hasattr(os, "kill"), reason="needs signals")
def test_the_process_ends_when_ours_is_killed(tmp_path: Path) -> None:
    code = (
        "import os, sys\nfrom wonderful_team.sims.vimabench import VimaWorld\n"
        "world = VimaWorld('rotate')\nprint(world._simulator._process.pid, world._simulator._scratch, flush=True)\nsys.stdin.read()\n"
    )
    ours = subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    with ours:
        assert ours.stdout is not None
        pid, scratch = ours.stdout.readline().split()
        theirs = int(pid)
        assert _runs(theirs)
        ours.send_signal(signal.SIGKILL)
    until = time.monotonic() + 10
    while _runs(theirs) and time.monotonic() < until:
        time.sleep(0.05)
    assert not _runs(theirs)
    assert not Path(scratch).exists()


def _runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_secrets_stay_here(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[dict[str, Any]] = []
    real = subprocess.Popen

    def record(*args: Any, **more: Any) -> Any:
        started.append(more)
        return real(*args, **more)

    monkeypatch.setenv("SOME_API_KEY", "secret")
    monkeypatch.setattr(client.subprocess, "Popen", record)
    start(find_installation()).close()
    assert "SOME_API_KEY" not in started[0]["env"]
