"""What counts as shaking a bottle: strokes in the air, and a bottle that stands again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.sims.arms.needed import needs_arms
from tests.sims.arms.playing import by_team, lay_down, play
from wonderful_team.core.actions import Action, Gripper, MoveTo, Trajectory
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms import ArmWorld
from wonderful_team.sims.arms.shaking import REVERSALS, Shaking, reversals


def track(*heights: float, along: tuple[float, float, float] = (0.0, 0.0, 1.0), noise_m: float = 0.002) -> Array:
    """A way through these distances along a direction, a point every few millimetres, not quite straight."""
    values = np.concatenate([np.linspace(a, b, 30) for a, b in zip(heights[:-1], heights[1:], strict=True)])
    way = values[:, None] * np.array(along) / np.linalg.norm(along)
    return np.asarray(way + np.random.default_rng(0).normal(0.0, noise_m, way.shape))


@pytest.mark.parametrize(
    ("heights", "count"),
    [
        ((0.0, 0.2), 0),
        ((0.0, 0.2, 0.0), 1),
        ((0.0, 0.2, 0.15, 0.2, 0.15, 0.2, 0.15, 0.0), 5),
        ((0.0, 0.2, 0.17, 0.2, 0.17, 0.2, 0.17, 0.2, 0.0), 1),
    ],
    ids=["lifted", "up and down once", "three times", "trembling"],
)
@pytest.mark.parametrize("along", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, -1.0, 0.0), (0.5, 0.2, 1.0)])
def test_ways_back_of_a_stroke_are_counted_in_any_direction(
    heights: tuple[float, ...], count: int, along: tuple[float, float, float]
) -> None:
    assert reversals(track(*heights, along=along)) == count


@pytest.fixture
def world() -> Iterator[ArmWorld]:
    made = ArmWorld("shake", 3)
    yield made
    made.close()


def work_of(world: ArmWorld) -> Shaking:
    work = world._table.work
    assert isinstance(work, Shaking)
    return work


def raised(action: Action) -> Action:
    """The same move at the height at which the oracle carries."""
    assert isinstance(action, MoveTo)
    return MoveTo(Pose.at(action.pose.position_m + np.array([0.0, 0.0, 0.08]), action.pose.yaw_rad))


@needs_arms
def test_the_oracle_shakes_the_bottle_and_puts_it_back(world: ArmWorld) -> None:
    assert world.privileged.score().stage == "plan"
    score, reports = play(world, world.privileged.oracle())
    assert score.success, score.reason
    assert all(report.executed for report in reports)
    assert work_of(world).shaken >= REVERSALS
    assert world.privileged.oracle() == []


@needs_arms
@pytest.mark.parametrize("times", [0, 1])
def test_lifted_and_shaken_at_most_once_is_not_shaken(world: ArmWorld, times: int) -> None:
    actions: list[Action] = []
    for action in world.privileged.oracle():
        if not isinstance(action, Trajectory):
            actions.append(action)
        elif times:
            actions.append(Trajectory(action.waypoints_m[:3]))
    score, _ = play(world, actions)
    assert score.success is False
    assert score.stage == "execution"
    assert "turned back 1 times in the air (at least 5" in score.reason


@needs_arms
def test_a_bottle_that_is_pushed_about_on_the_table_is_not_shaken(world: ArmWorld) -> None:
    actions = list(world.privileged.oracle())
    grip = next(k for k, action in enumerate(actions) if isinstance(action, Gripper) and action.state == "tight")
    at = actions[grip - 1]
    assert isinstance(at, MoveTo)
    slides = [
        MoveTo(Pose.at(at.pose.position_m + np.array([0.0, side, 0.0]), at.pose.yaw_rad)) for side in (0.06, 0.0) * 4
    ]
    score, _ = play(world, [*actions[: grip + 1], *slides, Gripper("open")])
    assert score.success is False
    assert "turned back 0 times in the air" in score.reason


@needs_arms
def test_a_bottle_that_is_dropped_or_not_put_back_has_failed(world: ArmWorld) -> None:
    actions = list(world.privileged.oracle())
    path = next(k for k, action in enumerate(actions) if isinstance(action, Trajectory))
    score, _ = play(world, actions[: path + 1])
    assert work_of(world).shaken >= REVERSALS
    assert score.success is False
    assert "not put back" in score.reason
    name = work_of(world).wanted.name
    score, _ = play(world, [raised(actions[path - 1]), Gripper("open")])
    assert (score.success, score.stage) == (False, "execution")
    assert "was dropped from" in score.reason or "does not stand any more" in score.reason
    assert work_of(world).dropped_m > 0.03, "also where it happens to land on its foot"
    lay_down(world, name)
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "execution")
    assert "does not stand any more" in score.reason
    assert world.privileged.oracle() == []


@needs_arms
def test_the_wrong_bottle_is_a_wrong_object(world: ArmWorld) -> None:
    work = work_of(world)
    meant, other = work.wanted, next(bottle for bottle in work.bottles if bottle is not work.wanted)
    work.wanted = other
    actions = world.privileged.oracle()
    work.wanted = meant
    score, _ = play(world, actions)
    assert (score.success, score.stage) == (False, "wrong object")
    assert f"the {other.name} was lifted" in score.reason


@needs_arms
def test_what_the_robot_did_not_drop_does_not_count_against_it() -> None:
    trial = by_team("arms/shake@slip=1", 0, replans=3)
    assert trial.outcome == "success", trial.reason
    assert any("hold nothing any more" in str(report.fault) for report in trial.reports)
