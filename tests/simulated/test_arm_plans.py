"""An arm's actions as the moves that they make: one pick and place, or a path."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.contracts import arm_steps, can_carry, step_list_type
from wonderful_team.core.actions import ARM, Action, Gripper, Home, MoveTo, PickPlace, RotateGripper, Trajectory
from wonderful_team.core.geometry import Pose
from wonderful_team.simulated.plan import carried


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
