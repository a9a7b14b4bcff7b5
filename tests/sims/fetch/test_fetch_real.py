"""Against gymnasium-robotics' own Fetch; skipped without it. A few seconds of processor time a test."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from wonderful_team.cli.app import run
from wonderful_team.core.actions import Gripper, Home, MoveTo
from wonderful_team.core.geometry import Pose
from wonderful_team.sims.fetch import FetchWorld, check_ready
from wonderful_team.sims.fetch.things import HANDLE_M, RIM_M

pytestmark = pytest.mark.fetch
Open = Callable[..., FetchWorld]


def to(point: np.ndarray, z: float) -> MoveTo:
    return MoveTo(Pose.at(np.array([*point[:2], z])))


def test_it_is_ready() -> None:
    assert {"mujoco", "gymnasium-robotics"} <= set(check_ready())


@pytest.mark.parametrize("task", ["lid", "lid_two"])
def test_the_oracle_solves_it_by_contact_alone(open_world: Open, task: str) -> None:
    world = open_world(task, seed=1002)
    for action in world.privileged.oracle():
        report = world.execute(action)
        assert report.executed, report.words
    score = world.privileged.score()
    assert score.success is True, score
    assert world.privileged.track().held["lid"].any()


def test_the_handle_is_between_the_fingers_and_the_lid_comes_up(open_world: Open) -> None:
    world = open_world("lid", seed=1001)
    for action in world.privileged.oracle()[:5]:
        report = world.execute(action)
    assert report.measured["holding"]
    lid = world.privileged.track().poses["lid"][-1]
    assert lid[2] > RIM_M + 0.1
    assert report.measured["held_width_m"] == pytest.approx(HANDLE_M[1], abs=0.003)


def test_a_lid_that_is_pushed_off_sideways_is_seen(open_world: Open) -> None:
    world = open_world("lid", seed=1001)
    handle = world.privileged.things()["handle"].position_m
    beside = handle + (0.0, 0.06, 0.0)
    world.execute(Gripper("close"))
    world.execute(to(beside, 0.3))
    world.execute(to(beside, 0.115))
    for y in (0.0, -0.06, -0.12):
        world.execute(to(handle + (0.0, y, 0.0), 0.115))
    world.execute(Home())
    score = world.privileged.score()
    assert score.success is False
    assert "pushed off" in score.reason


def test_cameras_and_depth_put_everything_where_it_stands(open_world: Open) -> None:
    world = open_world("lid_two", seed=1003)
    main = world.observe().main
    assert main.camera is not None
    assert main.depth_m is not None
    sight = world.privileged.observation_log("top")[0]
    for name, thing in sight.things.items():
        rows, columns = np.nonzero(sight.masks[name])
        points = main.camera.deproject(np.column_stack([columns + 0.5, rows + 0.5]), main.depth_m[rows, columns])
        assert points[:, 2].max() == pytest.approx(thing.height_m, abs=0.002), name
        top = points[points[:, 2] > points[:, 2].max() - 0.002]
        low, high = thing.outline_m.min(axis=0), thing.outline_m.max(axis=0)
        assert (top[:, :2].min(axis=0) > low - 0.003).all(), name
        assert (top[:, :2].max(axis=0) < high + 0.003).all(), name


def test_the_same_seed_and_actions_are_the_same_episode(open_world: Open) -> None:
    ends = []
    for _ in range(2):
        world = open_world("lid", seed=1004)
        for action in world.privileged.oracle()[:8]:
            world.execute(action)
        ends.append(world.observe().hash)
    assert ends[0] == ends[1]


@pytest.mark.parametrize("task", ["lid", "lid_two"])
def test_the_command_runs_it(task: str, tmp_path: Path) -> None:
    words = ["run", f"fetch/{task}", "--seed", "1000", "--model", "simulated:perfect", "--replans", "0"]
    assert run([*words, "--out", str(tmp_path)]) == 0
