"""Against the user's own copy of VIMA-Bench; skipped without one. A few seconds of processor time a test."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from wonderful_team.cli.app import run
from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.errors import WorldUnavailableError
from wonderful_team.registry.worlds import make_world
from wonderful_team.sims.vimabench import VimaWorld
from wonderful_team.sims.vimabench.tasks import TASKS, partitions

pytestmark = pytest.mark.vimabench
Open = Callable[..., VimaWorld]


def solve(world: VimaWorld) -> int:
    """Run the oracle to its end, asked again after every action; returns how many actions it took."""
    for count in range(world.horizon):
        actions = world.privileged.oracle()
        if not actions:
            return count
        report = world.execute(actions[0])
        assert report.executed, report.fault
    return world.horizon


@pytest.mark.slow
@pytest.mark.parametrize("task", TASKS)
def test_the_oracle_solves_every_task(open_world: Open, task: str) -> None:
    world = open_world(task, seed=3)
    assert world.horizon > solve(world) > 0
    score = world.privileged.score()
    assert score.success is True, score


@pytest.mark.slow
@pytest.mark.parametrize("task", TASKS)
def test_every_task_exists_at_the_levels_that_we_list(open_world: Open, task: str) -> None:
    for level in partitions(task):
        world = open_world(f"{task}@{level}", seed=1)
        assert world.privileged.oracle()
        world.close()


@pytest.mark.parametrize("task", ["visual_manipulation", "sweep_without_exceeding"])
def test_cameras_put_every_thing_where_it_is_seen(open_world: Open, task: str) -> None:
    world = open_world(task, seed=0)
    observation = world.observe()
    for name, thing in world.privileged.things().items():
        rows, columns = np.nonzero(world.privileged.masks()[name])
        camera = observation.main.camera
        assert camera is not None
        corners = camera.project(np.column_stack([thing.outline_m, np.full(len(thing.outline_m), thing.height_m)]))
        seen = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        assert (*corners.min(axis=0), *corners.max(axis=0)) == pytest.approx(seen, abs=1.5), name


def test_following_fails_only_after_a_step(open_world: Open) -> None:
    world = open_world("follow_motion", seed=0)
    before = world.privileged.score()
    assert (before.success, before.stage) == (False, None)
    assert "rule" not in before.reason
    world.execute(PickPlace(np.array([0.3, 0.4, 0.0]), np.array([0.3, 0.3, 0.0])))
    missed = world.privileged.score()
    assert (missed.success, missed.stage) == (False, "grounding")
    assert "rule" in missed.reason


def test_a_wrong_thing_in_the_container_is_a_failure(open_world: Open) -> None:
    world = open_world("visual_manipulation", seed=0)
    truth = world.privileged.truth()
    (target,) = truth["goals"][0]["targets"]
    (wrong,) = truth["distractors"]
    report = world.execute(PickPlace(world.privileged.things()[wrong].grasp_m, np.array(target["position_m"])))
    assert report.measured["held"]
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "wrong object")


def test_a_turn_the_wrong_way_is_not_a_success(open_world: Open) -> None:
    world = open_world("rotate", seed=1)
    (action,) = world.privileged.oracle()
    assert isinstance(action, PickPlace)
    assert world.execute(PickPlace(action.pick_m, action.place_m, -action.yaw_rad)).measured["held"]
    assert world.privileged.score().success is False


def test_a_push_moves_a_block_as_far_as_it_says(open_world: Open) -> None:
    world = open_world("sweep_without_touching", seed=1)
    things = world.privileged.things()
    name = next(name for name, thing in things.items() if thing.kind == "object")
    at = things[name].position_m
    start, end = at + [0.05, 0.0, 0.0], at - [0.06, 0.0, 0.0]
    report = world.execute(Push(start, end))
    assert report.measured["short_of_end_m"] == 0.0
    moved = world.privileged.things()[name].position_m
    # The blade stops with its front at the end; the block of 3 cm lies before it.
    assert end[0] - moved[0] == pytest.approx(0.018, abs=0.012)
    assert abs(moved[1] - at[1]) < 0.02


def test_an_arm_that_never_arrives_is_an_error_of_the_world(open_world: Open) -> None:
    world = open_world("sweep_without_exceeding", seed=0)
    point = np.array([0.5, 0.0], np.float32)
    upright = np.array([0, 0, 0, 1], np.float32)
    # A push without length, which the adapter itself refuses: the real arm is then told to go to no number.
    said, _ = world._simulator.ask(
        "step", {"pose0_position": point, "pose0_rotation": upright, "pose1_position": point, "pose1_rotation": upright}
    )
    assert said["late"]
    assert world.privileged.score().success is None
    with pytest.raises(WorldUnavailableError):
        world.execute(Push(np.array([0.7, -0.3, 0.0]), np.array([0.6, -0.3, 0.0])))


def test_two_worlds_at_once_both_work(open_world: Open) -> None:
    one, two = open_world("visual_manipulation", 1), open_world("rotate", 2)
    assert solve(one) == solve(two) == 1
    assert one.privileged.score().success is True
    assert two.privileged.score().success is True


def test_a_world_by_its_name_is_the_same_every_time() -> None:
    pictures = set()
    for _ in range(2):
        world = make_world("vimabench/rotate", seed=7)
        world.execute(world.privileged.oracle()[0])  # type: ignore[attr-defined]
        pictures.add(world.observe().hash)
        world.close()
    assert len(pictures) == 1


def test_run_in_it_ends_with_the_simulators_own_word(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "vimabench/rotate", "--seed", "3"]) == 0
    assert "every goal is met" in capsys.readouterr().out
