"""An arm that grips by contact: what it does, what it measures, what it refuses. One short episode runs by default."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.sims.arms.needed import needs_arms
from wonderful_team.core.actions import Gripper, Home, MoveTo, PickPlace, RotateGripper
from wonderful_team.core.geometry import Pose
from wonderful_team.errors import ConfigError, MissingExtraError
from wonderful_team.sims.arms import ArmWorld, make_world, task_names
from wonderful_team.sims.arms.cameras import REACH_HIGH_M


@pytest.fixture
def world() -> Iterator[ArmWorld]:
    made = make_world("block_in_bowl", seed=4)
    yield made
    made.close()


def at(world: ArmWorld, name: str) -> np.ndarray[Any, Any]:
    return np.array(world.privileged.truth()["things"][name]["position_m"])


def wanted(world: ArmWorld) -> str:
    return f"{world.privileged.truth()['words']['colour']} block"


@needs_arms
def test_the_oracle_puts_the_block_into_the_bowl_by_contact_alone(world: ArmWorld) -> None:
    name = wanted(world)
    assert world.privileged.score().success is False
    reports = [world.execute(action) for action in world.privileged.oracle()]
    assert all(report.executed for report in reports)
    closed = next(report for report in reports if isinstance(report.action, Gripper) and report.action.state == "close")
    assert closed.measured["holding"]
    assert closed.measured["held_width_m"] == pytest.approx(0.045, abs=0.002)
    assert world.privileged.truth()["grips"][0]["held"] == [name]
    lifted = reports[reports.index(closed) + 1]
    assert lifted.measured["holding"]
    assert world.privileged.score().success
    # Nothing ties a thing to the gripper: the model has no weld at all but those of the gripper's own linkage.
    table = world._table
    assert not any(table.built.model.equality(k).name.startswith("hold") for k in range(table.built.model.neq))
    view = world.observe().main
    assert view.depth_m is not None
    assert view.camera is not None
    # The arm is parked out of the top view, and the calibrated camera finds the block where it is.
    block = at(world, name) + np.array([0.0, 0.0, 0.045])
    (x, y) = view.camera.project(block[None])[0]
    seen = view.camera.deproject([(x, y)], [view.depth_m[int(y), int(x)]])[0]
    assert np.linalg.norm(seen - block) < 0.003


@needs_arms
def test_stop_holds_and_never_opens(world: ArmWorld) -> None:
    for action in list(world.privileged.oracle())[:5]:
        world.execute(action)
    name = wanted(world)
    height = at(world, name)[2]
    assert height > 0.1
    world.stop()
    report = world.execute(Gripper("open"))
    assert not report.executed
    assert "stopped" in str(report.fault)
    world._table.robot.rest(1.0)
    assert report.measured["holding"]
    assert abs(at(world, name)[2] - height) < 0.005


@needs_arms
def test_what_slips_out_of_the_fingers_is_noticed(world: ArmWorld) -> None:
    actions = list(world.privileged.oracle())
    for action in actions[:5]:
        assert world.execute(action).executed
    # The block is knocked out of the fingers.
    table, name = world._table, wanted(world)
    table.put(name, np.array([0.65, 0.3, 0.0]), 0.0)
    report = world.execute(actions[5])
    assert not report.executed
    assert "hold nothing any more" in str(report.fault)
    assert report.measured["holding"] is False


@needs_arms
def test_a_touch_on_the_way_down_stops_the_arm_and_is_reported(world: ArmWorld) -> None:
    name = wanted(world)
    x, y, _ = at(world, name)
    empty = world.execute(Gripper("close"))
    assert not empty.executed
    assert "closed on nothing" in str(empty.fault)
    report = world.execute(MoveTo(Pose.at((x, y, 0.012))))
    assert not report.executed
    assert "touched something" in str(report.fault)
    assert report.measured["contact"]
    assert report.measured["tool_m"][2] > 0.03
    assert abs(at(world, name)[2]) < 0.005


@needs_arms
def test_what_is_held_may_land_a_little_early_and_no_more(world: ArmWorld) -> None:
    for action in list(world.privileged.oracle())[:5]:
        assert world.execute(action).executed
    x, y, z = world._table.robot.tool_m
    name = wanted(world)
    hangs = float(z) - float(at(world, name)[2])
    early = world.execute(MoveTo(Pose.at((x, y, hangs - 0.015))))
    assert early.executed
    assert "mm before its goal (limit 30 mm)" in str(early.fault)
    world.execute(MoveTo(Pose.at((x, y, z))))
    # Something stands on the way.
    other = next(one for one in world.privileged.truth()["things"] if one.endswith("block") and one != name)
    world._table.put(other, np.array([x, y, 0.0]), 0.0)
    stopped = world.execute(MoveTo(Pose.at((x, y, hangs))))
    assert (stopped.executed, stopped.measured["holding"], stopped.measured["contact"]) == (False, True, True)
    assert stopped.measured["pose_error_m"] > 0.03
    assert "before its goal (limit 30 mm)" in str(stopped.fault)


@needs_arms
def test_what_it_cannot_reach_or_run_is_refused(world: ArmWorld) -> None:
    far = world.execute(MoveTo(Pose.at((0.9, 0.0, 0.2))))
    assert not far.executed
    assert "out of reach [0.25, 0.71] m" in str(far.fault)
    leaning = world.execute(MoveTo(Pose(np.array([0.5, 0.0, 0.2]), np.array([0.9, 0.4, 0.0, 0.0]))))
    assert "straight down" in str(leaning.fault)
    with pytest.raises(ConfigError, match="this world runs move_to"):
        world.execute(PickPlace(np.zeros(3), np.zeros(3)))
    world.close()
    with pytest.raises(ConfigError, match="closed"):
        world.execute(Home())


@needs_arms
def test_turning_is_relative_and_in_place(world: ArmWorld) -> None:
    world.execute(MoveTo(Pose.at((0.5, 0.0, 0.25), 0.2)))
    report = world.execute(RotateGripper(0.5))
    assert report.executed
    assert report.measured["yaw_rad"] == pytest.approx(0.7, abs=0.02)
    assert report.measured["tool_m"] == pytest.approx((0.5, 0.0, 0.25), abs=0.003)


@needs_arms
def test_the_same_seed_sets_the_same_table_and_faults_of_sensors_are_named_options() -> None:
    plain, faulty, moved = (
        make_world(f"block_in_bowl{options}", seed=7) for options in ("", "@depth=3", "@calibration=2")
    )
    try:
        seen, noisy, wrong = (world.observe().main for world in (plain, faulty, moved))
        assert np.array_equal(seen.rgb, noisy.rgb)
        assert seen.depth_m is not None
        assert noisy.depth_m is not None
        assert np.isfinite(seen.depth_m).all()
        lost = ~np.isfinite(noisy.depth_m)
        assert 0.002 < lost.mean() < 0.2
        assert (
            0.001
            < np.std((noisy.depth_m - seen.depth_m)[~lost & (np.abs(noisy.depth_m - seen.depth_m) < 0.015)])
            < 0.006
        )
        assert seen.camera is not None
        assert wrong.camera is not None
        point = np.array([[0.5, 0.1, 0.0]])
        assert 1.0 < np.linalg.norm(seen.camera.project(point) - wrong.camera.project(point)) < 8.0
    finally:
        for world in (plain, faulty, moved):
            world.close()


@needs_arms
@pytest.mark.parametrize("name", ["block_in_bowl@depth=9", "block_in_bowl@xarm9", "block_in_bowl@depth=1"])
def test_options_that_mean_nothing_are_refused(name: str) -> None:
    with pytest.raises(ConfigError):
        make_world(name, seed=1, depth=2 if name.endswith("=1") else 0)


def test_tasks_are_listed_without_the_optional_part() -> None:
    assert {"block_in_bowl", "fruit_placement/both"} <= set(task_names())


def test_a_missing_part_is_named_with_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    from wonderful_team.sims.arms import rows

    monkeypatch.setattr(rows, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match="mink"):
        make_world("block_in_bowl", seed=1)


@needs_arms
@pytest.mark.parametrize("tier", [1, 3])
def test_a_moved_camera_sees_all_that_the_arm_reaches_and_planners_are_told_where_it_stands(tier: int) -> None:
    usual, moved = make_world("block_in_bowl", seed=5), make_world(f"block_in_bowl@camera={tier}", seed=5)
    try:
        was, now = usual.observe().main, moved.observe().main
        assert was.camera is not None
        assert now.camera is not None
        assert now.depth_m is not None
        low, high = moved.limits.low_m, moved.limits.high_m
        corners = np.array([(x, y, 0.0) for x in (low[0], high[0]) for y in (low[1], high[1])])
        seen = now.camera.project(corners)
        assert (seen > 0).all()
        assert (seen < np.array(now.size_px)).all()
        assert np.abs(seen - was.camera.project(corners)).max() > 4.0
        block = at(moved, wanted(moved)) + np.array([0.0, 0.0, 0.045])
        (x, y) = now.camera.project(block[None])[0]
        found = now.camera.deproject([(x, y)], [now.depth_m[int(y), int(x)]])[0]
        assert np.linalg.norm(found - block) < 0.004
        assert "aslant" in moved.facts
    finally:
        usual.close()
        moved.close()


@needs_arms
@pytest.mark.parametrize("task", ["lid_box/one", "star", "lid_box/one@slip=1"])
def test_a_world_that_nobody_holds_is_gone_at_once(task: str) -> None:
    world = make_world(task, 1000)
    world.observe()
    table = world.privileged._table
    gone = [weakref.ref(one) for one in (table, table.robot, table.work, table.built)]
    gc.collect()
    gc.disable()
    try:
        world.close()
        del world, table
        assert [one() for one in gone] == [None] * len(gone)
    finally:
        gc.enable()


@pytest.mark.parametrize("task", [name for name in task_names() if name.startswith(("superhero", "fruit_price"))])
def test_the_papers_implicit_goals_stand_within_the_arms_reach(task: str) -> None:
    for seed in range(3):
        world = make_world(task, seed=seed)
        try:
            moves = [action for action in world.privileged.oracle() if isinstance(action, MoveTo)]
            assert moves
            for move in moves:
                assert abs(float(move.pose.position_m[1])) <= REACH_HIGH_M[1]
        finally:
            world.close()
