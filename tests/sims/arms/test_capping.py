"""A screw cap: what turns it, when it comes free, and what counts as an open bottle."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from tests.sims.arms.needed import needs_arms
from tests.sims.arms.playing import by_team, lay_down, play
from wonderful_team.core.actions import Action, Gripper, RotateGripper
from wonderful_team.sims.arms import ArmWorld
from wonderful_team.sims.arms.capping import FREE_RAD, Capped


@pytest.fixture
def world() -> Iterator[ArmWorld]:
    made = ArmWorld("cap", 4)
    yield made
    made.close()


def work_of(world: ArmWorld) -> Capped:
    work = world._table.work
    assert isinstance(work, Capped)
    return work


def turned(world: ArmWorld) -> float:
    """How far the meant cap has been turned [degrees]."""
    work = work_of(world)
    return math.degrees(work.turned_rad(work.wanted.name))


def with_turn(actions: Sequence[Action], *instead: Action) -> list[Action]:
    """The same with other actions in the place of the turn."""
    k = next(k for k, action in enumerate(actions) if isinstance(action, RotateGripper))
    return [*actions[:k], *instead, *actions[k + 1 :]]


def degrees(angle: float) -> RotateGripper:
    return RotateGripper(math.radians(angle))


@needs_arms
def test_the_oracle_unscrews_the_cap_and_the_bottle_stays(world: ArmWorld) -> None:
    assert world.privileged.score().stage == "plan"
    score, reports = play(world, world.privileged.oracle())
    assert score.success, score.reason
    assert all(report.executed for report in reports)
    work, poses = work_of(world), world._table.poses()
    assert turned(world) >= math.degrees(FREE_RAD)
    assert work.free == {work.wanted.name}
    assert work.moved_m(work.wanted.name, poses) < 0.01
    assert world.privileged.oracle() == []


@needs_arms
def test_a_cap_that_was_not_turned_far_enough_takes_the_bottle_along(world: ArmWorld) -> None:
    score, _ = play(world, with_turn(world.privileged.oracle(), degrees(180)))
    assert (score.success, score.stage) == (False, "execution")
    assert "was lifted off the table" in score.reason
    assert 150 < turned(world) < 190


@needs_arms
def test_a_cap_that_is_loose_but_was_left_on_is_not_off(world: ArmWorld) -> None:
    actions = list(world.privileged.oracle())
    k = next(k for k, action in enumerate(actions) if isinstance(action, RotateGripper))
    score, _ = play(world, [*actions[: k + 1], Gripper("open"), *actions[-2:]])
    assert (score.success, score.stage) == (False, "execution")
    assert "is loose, and still lies on it" in score.reason
    rest = world.privileged.oracle()
    assert not any(isinstance(action, RotateGripper) for action in rest), "what is loose needs no more turning"
    score, _ = play(world, rest)
    assert score.success, score.reason


@needs_arms
def test_the_wrong_way_screws_nothing_off(world: ArmWorld) -> None:
    actions = with_turn(world.privileged.oracle(), degrees(-180), Gripper("open"))
    score, _ = play(world, actions[: actions.index(next(a for a in actions if isinstance(a, RotateGripper))) + 2])
    assert score.success is False
    assert "is on its thread: it was turned 0 of 240 degrees" in score.reason


@needs_arms
def test_several_grips_turn_it_as_far_as_one(world: ArmWorld) -> None:
    again = [degrees(135), Gripper("open"), degrees(-135), Gripper("tight"), degrees(135)]
    score, reports = play(world, with_turn(world.privileged.oracle(), *again))
    assert all(report.executed for report in reports)
    assert score.success, score.reason


@needs_arms
def test_a_wrist_at_its_end_says_so_and_does_not_spin_back(world: ArmWorld) -> None:
    actions = world.privileged.oracle()[:3]
    play(world, actions)
    reports = [world.execute(degrees(330)) for _ in range(2)]
    assert "the wrist does not turn so far" in str(reports[-1].fault)
    assert not reports[-1].executed
    before = world._table.robot.yaw_rad
    world.execute(degrees(-90))
    assert math.remainder(before - world._table.robot.yaw_rad - math.pi / 2, 2 * math.pi) == pytest.approx(0, abs=0.02)


@needs_arms
def test_a_fallen_bottle_and_the_wrong_one_have_failed(world: ArmWorld) -> None:
    work = work_of(world)
    meant, other = work.wanted, next(bottle for bottle in work.bottles if bottle is not work.wanted)
    work.wanted = other
    actions = world.privileged.oracle()
    work.wanted = meant
    score, _ = play(world, actions)
    assert (score.success, score.stage) == (False, "wrong object")
    assert f"the {other.name} was opened" in score.reason
    work.free.clear()
    lay_down(world, meant.name)
    assert work._bottle_problem(world._table.poses()) == f"the {meant.name} has fallen"
    assert world.privileged.score().success is False


@needs_arms
def test_fingers_that_close_off_the_middle_are_moved_over_the_cap_and_do_not_tip_the_bottle(world: ArmWorld) -> None:
    work = work_of(world)
    name = work.caps[work.wanted.name].name
    cap = world._table.poses()[name].position_m
    at = cap + np.array([0.004, -0.004, work.caps[work.wanted.name].body.height_m - 0.017])
    off = np.zeros(2)
    for action in (Gripper("open"), work.to(at, 0.0, 0.1), work.to(at, 0.0), Gripper("close"), Gripper("open"),
                   degrees(-90), Gripper("tight")):  # fmt: skip
        report = world.execute(action)
        assert report.executed, report.fault
        poses = world._table.poses()
        off = np.array(report.measured["tool_m"])[:2] - poses[name].position_m[:2]
        assert float(poses[work.wanted.name].position_m[2]) < 0.0005, "it tips"
    assert np.abs(off).max() < 0.001, "centred along both ways of closing"
    assert work.moved_m(work.wanted.name, world._table.poses()) < 0.001


@needs_arms
@pytest.mark.parametrize("seed", [20, 3])
def test_a_camera_some_millimetres_off_does_not_keep_a_cap_on(seed: int) -> None:
    trial = by_team("arms/cap@calibration=2", seed, model="offline")
    assert trial.outcome == "success", trial.reason
