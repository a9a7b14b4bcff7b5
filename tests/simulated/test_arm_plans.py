"""An arm's actions as the moves that they make: one pick and place, or a path."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.contracts import arm_steps, can_carry, step_list_type
from wonderful_team.core.actions import ARM, Action, Gripper, Home, MoveTo, PickPlace, RotateGripper, Trajectory
from wonderful_team.core.geometry import Pose
from wonderful_team.simulated.draft import Names, write
from wonderful_team.simulated.plan import Handled, Put, Spot, carried


def to(x: float, y: float, z: float, yaw: float = 0.0) -> MoveTo:
    return MoveTo(Pose.at((x, y, z), yaw))


def test_what_is_gripped_and_let_go_is_one_pick_and_place() -> None:
    actions: list[Action] = [
        Gripper("open"), to(0.4, 0.1, 0.2, 0.5), to(0.4, 0.1, 0.02, 0.5), Gripper("close"), to(0.4, 0.1, 0.2, 0.5),
        to(0.6, -0.1, 0.2, 1.0), to(0.6, -0.1, 0.03, 1.0), Gripper("open"), to(0.6, -0.1, 0.2, 1.0), Home(),
    ]  # fmt: skip
    (put,) = carried(actions)
    assert isinstance(put, PickPlace)
    assert np.allclose(put.pick_m, (0.4, 0.1, 0.02))
    assert np.allclose(put.place_m, (0.6, -0.1, 0.03))
    assert math.isclose(put.yaw_rad, 0.5)
    assert carried([*actions, *actions]) != [put]
    assert len(carried([*actions, *actions])) == 2


def test_what_carries_nothing_is_no_move_and_paths_stay() -> None:
    path = Trajectory(np.array([[0.4, 0.0, 0.2], [0.4, 0.0, 0.0]]))
    assert carried([Gripper("open"), to(0.4, 0.1, 0.2), RotateGripper(0.3), Home(), path]) == [path]
    assert carried([to(0.4, 0.1, 0.02), Gripper("close"), Home()]) == []


def test_steps_of_an_arm_travel_clear_and_end_at_home() -> None:
    place = {"target": "T2", "how": "at", "side": None}
    steps = step_list_type(ARM.step_kinds).model_validate(
        {"reasoning": "", "steps": arm_steps("G1", "T1", place, 30.0, ARM.step_kinds)}
    ).to_steps()  # fmt: skip
    told = [f"{step.kind} {getattr(step, 'height', '')}".strip() for step in steps]
    assert told == [
        "open", "move clear", "move above", "move at", "close", "move clear", "rotate_gripper", "move clear", "move at", "open",
        "move clear", "home",
    ]  # fmt: skip
    assert can_carry(ARM.step_kinds)
    assert not can_carry(("move", "home"))
    assert arm_steps("G1", "T1", place, 0.0, ("move", "open", "close"))[-1]["kind"] == "move"


SHAKEN = Trajectory(np.array([[0.4, 0.1, 0.2], [0.4, 0.1, 0.28], [0.4, 0.1, 0.2]]))


def test_what_is_turned_in_place_or_moved_in_the_air_while_it_is_held_is_one_thing_handled() -> None:
    grip = [Gripper("open"), to(0.4, 0.1, 0.02), Gripper("tight")]
    (shaken,) = carried([*grip, to(0.4, 0.1, 0.2), SHAKEN, to(0.4, 0.1, 0.02), Gripper("open")])
    assert isinstance(shaken, Handled)
    assert (shaken.twist_rad, shaken.tight) == (0.0, True)
    assert shaken.path_m is SHAKEN.waypoints_m
    turn = math.radians(270)
    (twisted,) = carried([*grip, RotateGripper(turn), to(0.6, 0.1, 0.02, turn), Gripper("open")])
    assert isinstance(twisted, Handled)
    assert twisted.path_m is None
    assert twisted.twist_rad == turn
    assert math.isclose(twisted.carry.yaw_rad, 0.0, abs_tol=1e-9)


def test_handled_things_are_written_as_a_subgoal_with_its_steps() -> None:
    shaken = Put(
        "b", Spot("origin", (0.4, 0.1)), 0.0, (0.05, 0.05), path_m=((0.4, 0.1, 0.0), (0.4, 0.1, 0.08)), tight=True
    )
    twisted = Put("c", Spot("spot", (0.6, 0.1)), 0.0, (0.03, 0.03), twist_deg=-270.0, tight=True)
    plan = write([shaken, twisted], Names({"b": "red bottle", "c": "pink cap"}))
    first, second = plan.subgoals
    assert first.function is not None
    assert first.text.startswith("lift the red bottle, move it along a path of 2 points in the air, then put")
    assert second.text.startswith("turn the pink cap by 270 degrees anticlockwise where it is, then put")
    assert (first.move, second.move, second.function) == (None, None, None)
    assert plan.paths[first.text].up_m == (0.0, 0.08)
    place = {"target": "T1", "how": "origin", "side": None}
    steps = arm_steps("G1", "T1", place, 0.0, ARM.step_kinds, tight=True, twist_deg=-270.0, function="G1")
    # What is turned about its own axis is gripped twice, a quarter apart: that centres the fingers on it.
    assert [step["kind"] for step in steps] == [
        "open", "move", "move", "move", "close", "open", "rotate_gripper", "close", "rotate_gripper",
        "move", "follow", "move", "move", "open", "move", "home",
    ]  # fmt: skip
    assert [step["rotate_deg"] for step in steps if step["kind"] == "rotate_gripper"] == [90.0, -270.0]
    assert [step["tight"] for step in steps if step["kind"] == "close"] == [False, True]
    put = arm_steps("G1", "T1", place, 0.0, ARM.step_kinds, tight=True)
    assert [step["kind"] for step in put].count("close") == 1
