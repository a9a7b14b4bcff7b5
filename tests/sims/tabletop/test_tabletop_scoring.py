"""Success, failure and the stage of a failure, to the letter of the tasks' rules."""

from __future__ import annotations

import math

import numpy as np
import pytest

from wonderful_team.core.actions import PickPlace
from wonderful_team.sims.tabletop import TabletopWorld, make_world


def _move(world: TabletopWorld, name: str, place: tuple[float, ...], yaw_rad: float = 0.0) -> None:
    """Pick a thing at its grasp point so that its centre lands at `place`."""
    thing = world.privileged.truth()["things"][name]
    pick, centre = np.array(thing["grasp_m"]), np.array(thing["position_m"])
    turn = np.array([[math.cos(yaw_rad), -math.sin(yaw_rad)], [math.sin(yaw_rad), math.cos(yaw_rad)]])
    end = np.array(place[:2]) + turn @ (pick - centre)[:2]
    assert world.execute(PickPlace(pick, (*end, 0.0), yaw_rad)).measured["held"]


def _where(world: TabletopWorld, name: str) -> tuple[float, ...]:
    return world.privileged.truth()["things"][name]["position_m"]


def _manipulation(movable_distractor: bool = True) -> tuple[TabletopWorld, str, str, str]:
    for seed in range(40):
        world = make_world("visual_manipulation", seed)
        truth = world.privileged.truth()
        carried, base = truth["slots"]["dragged_obj_1"], truth["slots"]["base_obj"]
        other = truth["distractors"][0]
        if truth["things"][other]["movable"] == movable_distractor:
            return world, carried, base, other
        world.close()
    raise AssertionError("no seed below 40 has such a distractor")


def _bare(world: TabletopWorld) -> tuple[float, float]:
    """A point of bare table, far from everything."""
    things = world.privileged.truth()["things"].values()
    points = [(x, y) for x in np.arange(0.3, 0.71, 0.02) for y in np.arange(-0.45, 0.46, 0.02)]
    return max(points, key=lambda p: min(math.dist(p, thing["position_m"][:2]) for thing in things))


def test_any_yaw_within_a_decimetre_counts() -> None:
    world, carried, base, _ = _manipulation()
    x, y, _ = _where(world, base)
    _move(world, carried, (x, y), yaw_rad=1.0)
    assert world.privileged.score().success
    world.close()


def test_a_distractor_in_the_container_fails_for_good() -> None:
    world, carried, base, other = _manipulation()
    _move(world, other, _where(world, base))
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "wrong object")
    assert "distractor" in score.reason
    _move(world, other, _bare(world))
    _move(world, carried, _where(world, base))
    assert not world.privileged.score().success
    world.close()


def test_putting_the_thing_on_the_wrong_container_fails() -> None:
    world, carried, _, other = _manipulation(movable_distractor=False)
    _move(world, carried, _where(world, other))
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "wrong object")
    world.close()


def test_a_missed_pick_changes_nothing_and_the_task_can_still_be_solved() -> None:
    world, carried, base, _ = _manipulation()
    empty = _bare(world)
    report = world.execute(PickPlace((*empty, 0.0), _where(world, base)))
    assert report.measured["held"] is False
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "grounding")
    _move(world, carried, _where(world, base))
    assert world.privileged.score().success
    world.close()


def test_moving_the_wrong_thing_to_bare_table_is_not_a_failure_yet_names_its_stage() -> None:
    world, carried, base, other = _manipulation()
    _move(world, other, _bare(world))
    assert world.privileged.score().stage == "wrong object"
    _move(world, carried, _where(world, base))
    assert world.privileged.score().success
    world.close()


def test_nothing_after_the_horizon_counts() -> None:
    world, carried, base, _ = _manipulation()
    empty = _bare(world)
    for _ in range(world.horizon):
        world.execute(PickPlace((*empty, 0.0), (*empty, 0.0)))
    _move(world, carried, _where(world, base))
    score = world.privileged.score()
    assert score.success is False
    assert "horizon of 5" in score.reason
    world.close()


def test_leaving_the_table_fails() -> None:
    world, carried, _, _ = _manipulation()
    world.privileged.nudge(carried, dx_m=0.8)
    empty = _bare(world)
    world.execute(PickPlace((*empty, 0.0), (*empty, 0.0)))
    assert "left the table" in world.privileged.score().reason
    world.close()


@pytest.mark.parametrize(
    ("extra_deg", "success", "stage"), [(0, True, None), (10, True, None), (20, False, "plan"), (-20, False, "plan")]
)
def test_rotation_must_be_clockwise_within_fifteen_degrees(extra_deg: float, success: bool, stage: str | None) -> None:
    world = make_world("rotate", 1)
    truth = world.privileged.truth()
    name, angle = truth["slots"]["dragged_obj"], float(truth["words"]["angle"])
    _move(world, name, _where(world, name), -math.radians(angle + extra_deg))
    score = world.privileged.score()
    assert (score.success, score.stage) == (success, stage)
    world.close()


def test_rotation_the_other_way_is_a_wrong_plan() -> None:
    world = make_world("rotate", 1)
    truth = world.privileged.truth()
    name = truth["slots"]["dragged_obj"]
    _move(world, name, _where(world, name), math.radians(float(truth["words"]["angle"])))
    assert world.privileged.score().stage == "plan"
    world.close()


def test_nothing_done_has_no_stage() -> None:
    world = make_world("rotate", 1)
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, None)
    world.close()


def test_a_fruit_without_an_area_must_stay_off_every_area() -> None:
    world = make_world("fruit_placement/no_area", 2)
    truth = world.privileged.truth()
    homeless = next(goal["thing"] for goal in truth["goals"] if goal["off"])
    area = next(name for name, thing in truth["things"].items() if thing["kind"] == "area")
    for action in world.privileged.oracle():
        world.execute(action)
    assert world.privileged.score().success
    x, y, _ = _where(world, area)
    _move(world, homeless, (x + 0.06, y + 0.06))
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "plan"), "the state at the end counts"
    assert homeless in score.reason
    world.close()


def test_a_fruit_on_the_wrong_area_is_the_wrong_object() -> None:
    world = make_world("fruit_placement/all_match", 3)
    truth = world.privileged.truth()
    goals = [goal for goal in truth["goals"] if goal["inside"]]
    fruit, wrong = goals[0]["thing"], goals[1]["inside"][0]
    _move(world, fruit, _where(world, wrong))
    assert world.privileged.score().stage == "wrong object"
    world.close()
