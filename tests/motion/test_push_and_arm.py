"""Pushes, and the steps of an arm with a gripper."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, scene
from wonderful_team.core.actions import (
    At,
    Beside,
    CloseStep,
    FollowStep,
    Gripper,
    Home,
    HomeStep,
    MoveStep,
    MoveTo,
    Navigate,
    NavigateStep,
    OpenStep,
    PickPlace,
    PickPlaceStep,
    Push,
    PushStep,
    RotateGripper,
    RotateGripperStep,
    Step,
    Trajectory,
)
from wonderful_team.core.values import NO_WORKSPACE, GroundedTarget, Limits, PlannedAction
from wonderful_team.errors import PlanError
from wonderful_team.motion import ground_actions

CAMERA = affine_top()
RED = Block(0.46, -0.1, 0.52, 0.0, 0.06)
VIEW = scene(CAMERA, RED)
TARGETS = {"T1": found(CAMERA, "T1", RED), "T2": area("T2", (200, 40))}


def run(*steps: Step, targets: dict[str, GroundedTarget] = TARGETS, **options: object) -> tuple[PlannedAction, ...]:
    return ground_actions(steps, targets, VIEW, LIMITS, **options)  # type: ignore[arg-type]


@settings(deadline=None, max_examples=40)
@given(st.floats(40, 216), st.floats(24, 104))
def test_a_push_starts_behind_the_thing_and_brings_its_centre_to_the_end(x: float, y: float) -> None:
    box = TARGETS["T1"].box
    assert box is not None
    if math.dist(box.centre, (x, y)) < 40:
        return
    (planned,) = run(PushStep("G1", At("T1"), At("T2")), targets=TARGETS | {"T2": area("T2", (x, y))})
    action = planned.action
    assert isinstance(action, Push)
    start, end = planned.sources
    assert not box.contains(start.point_px)
    # Start, centre and goal lie on one line, the centre between; the tool stops short by as much as it pushed ahead.
    along = np.array((x, y)) - box.centre
    along /= np.linalg.norm(along)
    behind = (np.array(start.point_px) - box.centre) @ along
    assert behind < 0
    assert np.array(start.point_px) - box.centre == pytest.approx(behind * along, abs=1e-6)
    short = np.array((x, y)) - end.point_px
    assert short @ along == pytest.approx(math.hypot(along[0] * box.width, along[1] * box.height) / 2)
    assert action.start_m[2] == action.end_m[2] == pytest.approx(0.0, abs=1e-6)
    assert start.position_m == pytest.approx(tuple(action.start_m))


def test_chosen_push_points_are_used_as_they_are() -> None:
    chosen = found(CAMERA, "T1", RED)
    chosen = GroundedTarget(
        chosen.target, "found", "top", chosen.box, {"push_start": (90.0, 60.0), "push_end": (180.0, 60.0)}
    )
    (planned,) = run(PushStep("G1", At("T1"), At("T1")), targets={"T1": chosen})
    assert [source.point_px for source in planned.sources] == [(90.0, 60.0), (180.0, 60.0)]
    assert [source.role for source in planned.sources] == ["push_start", "push_end"]


def test_a_start_that_was_chosen_beside_a_thing_is_not_used_again_once_it_has_moved() -> None:
    chosen = found(CAMERA, "T1", RED)
    chosen = GroundedTarget(chosen.target, "found", "top", chosen.box, {"push_start": (90.0, 60.0)})
    targets = TARGETS | {"T1": chosen, "T3": area("T3", (200, 100))}
    first, second = run(PushStep("G1", At("T1"), At("T2")), PushStep("G1", At("T1"), At("T3")), targets=targets)
    assert first.sources[0].point_px == (90.0, 60.0)
    # The second push goes down: it starts above where the first one brought the thing.
    x, y = second.sources[0].point_px
    assert x == pytest.approx(200, abs=2)
    assert y < 40


def test_a_pushed_thing_is_picked_where_it_was_pushed() -> None:
    planned = run(PushStep("G1", At("T1"), At("T2")), PickPlaceStep("G2", "T1", At("T2")))
    action = planned[1].action
    assert isinstance(action, PickPlace)
    goal = CAMERA.on_plane([(200, 40)], 0.0)[0]
    assert action.pick_m == pytest.approx((goal[0], goal[1], 0.06), abs=2e-3)


def test_a_push_that_goes_nowhere_or_starts_outside_is_refused() -> None:
    box = TARGETS["T1"].box
    assert box is not None
    nowhere = TARGETS | {"T2": area("T2", box.centre)}
    with pytest.raises(PlanError, match="step 1: push of 'T1': the push would end where it begins"):
        run(PushStep("G1", At("T1"), At("T2")), targets=nowhere)
    with pytest.raises(PlanError, match="target 'T1' has no point for push_end"):
        run(PushStep("G1", At("T1"), At("T1")))
    edge = Block(0.46, -0.53, 0.52, -0.51)
    with pytest.raises(PlanError, match="its start at .* would lie outside the view of 256 x 128 px"):
        run(PushStep("G1", At("T3"), At("T2")), targets=TARGETS | {"T3": found(CAMERA, "T3", edge)})


def test_a_tool_may_come_down_outside_the_picture_where_the_workspace_reaches() -> None:
    border = Block(0.46, -0.53, 0.52, -0.49)
    found_there = found(CAMERA, "T3", border)
    assert found_there.box is not None
    targets = TARGETS | {"T3": found_there, "T2": area("T2", (200, found_there.box.centre[1]))}
    wide = Limits((0.25, -0.56, 0.0), (0.75, 0.56, 0.3))
    (planned,) = ground_actions([PushStep("G1", At("T3"), At("T2"))], targets, VIEW, wide)
    assert isinstance(planned.action, Push)
    assert planned.sources[0].point_px[0] < 0
    assert -0.56 <= planned.action.start_m[1] < -0.5
    for tight in (LIMITS, NO_WORKSPACE):
        with pytest.raises(PlanError, match="its start at .* would lie outside the view"):
            ground_actions([PushStep("G1", At("T3"), At("T2"))], targets, VIEW, tight)


def heights(planned: tuple[PlannedAction, ...]) -> list[float]:
    return [float(item.action.pose.position_m[2]) for item in planned if isinstance(item.action, MoveTo)]


def test_an_arm_grips_carries_and_lets_go_at_the_right_heights() -> None:
    planned = run(
        OpenStep("G1"),
        MoveStep("G1", At("T1"), "above"),
        MoveStep("G1", At("T1"), "at"),
        CloseStep("G1", tight=True),
        MoveStep("G1", At("T1"), "clear"),
        MoveStep("G1", At("T2"), "above"),
        MoveStep("G1", At("T2"), "at"),
        OpenStep("G1"),
        MoveStep("G1", At("T2"), "clear"),
        HomeStep("G1"),
        MoveStep("G1", At("T1"), "at"),
    )
    # The block is 0.06 m high; fingers close half way up, 0.03 m; held it hangs 0.03 m below the tool.
    assert heights(planned) == pytest.approx([0.14, 0.03, 0.23, 0.11, 0.03, 0.2, 0.03], abs=1e-3)
    kinds = [type(item.action) for item in planned]
    assert kinds.count(Gripper) == 3
    assert planned[3].action == Gripper("tight")
    assert isinstance(planned[9].action, Home)
    last = planned[-1].action
    assert isinstance(last, MoveTo)
    goal = CAMERA.on_plane([(200, 40)], 0.0)[0]
    assert last.pose.position_m[:2] == pytest.approx(goal[:2], abs=2e-3)
    assert all(item.sources[0].role == "waypoint" for item in planned if isinstance(item.action, MoveTo))


def test_turning_the_gripper_lasts_and_turns_what_it_holds_about_its_centre() -> None:
    off_centre = {"T1": found(CAMERA, "T1", RED, {"grasp": (0.5, 0.8)}), "T2": area("T2", (200, 40))}
    planned = run(
        MoveStep("G1", At("T1"), "at"),
        CloseStep("G1"),
        RotateGripperStep("G1", 90.0),
        MoveStep("G1", At("T2"), "at"),
        targets=off_centre,
    )
    assert planned[2].action == RotateGripper(-math.pi / 2)
    grip, put = planned[0].action, planned[3].action
    assert isinstance(grip, MoveTo)
    assert isinstance(put, MoveTo)
    assert put.pose.yaw_rad == pytest.approx(-math.pi / 2)
    offset = np.array(RED.centre) - grip.pose.position_m[:2]
    turned = np.array([offset[1], -offset[0]])
    goal = CAMERA.on_plane([(200, 40)], 0.0)[0]
    assert put.pose.position_m[:2] + turned == pytest.approx(goal[:2], abs=1e-3)


def test_the_bare_tool_moves_beside_a_thing() -> None:
    planned = run(MoveStep("G1", Beside("T1", "right"), "at"))
    action = planned[0].action
    assert isinstance(action, MoveTo)
    box = TARGETS["T1"].box
    assert box is not None
    assert planned[0].sources[0].point_px[0] > box.x1
    assert action.pose.position_m[2] == pytest.approx(0.0, abs=1e-6)


PATH = ((50.0, 50.0), (60.0, 60.0), (70.0, 50.0))


def test_a_path_says_itself_whether_it_touches_the_surface() -> None:
    (clear,) = run(FollowStep("G1", "G1", "air"), paths={"G1": PATH})
    (touching,) = run(FollowStep("G1", "G1", "surface"), paths={"G1": PATH})
    assert isinstance(clear.action, Trajectory)
    assert isinstance(touching.action, Trajectory)
    assert clear.action.waypoints_m[:, 2] == pytest.approx([0.2] * 3, abs=1e-6)
    # Lowered at the first point, lifted after the last: the height of the surface comes from the view.
    assert touching.action.waypoints_m[:, 2] == pytest.approx([0.2, 0.0, 0.0, 0.0, 0.2], abs=1e-6)
    assert CAMERA.project(touching.action.waypoints_m[1:4]) == pytest.approx(np.array(PATH))
    assert touching.action.waypoints_m[0, :2] == pytest.approx(touching.action.waypoints_m[1, :2])
    assert [source.point_px for source in touching.sources] == [PATH[0], *PATH, PATH[-1]]
    assert len(touching.sources) == len(touching.action.points())


def test_a_path_in_the_air_stays_there_after_the_tool_was_down() -> None:
    after = run(MoveStep("G1", At("T2"), "at"), FollowStep("G1", "G1", "air"), paths={"G1": PATH})[1]
    assert isinstance(after.action, Trajectory)
    assert after.action.waypoints_m[:, 2] == pytest.approx([0.2] * 3, abs=1e-6)


def test_a_second_push_of_a_thing_says_that_it_guesses() -> None:
    first, second = run(PushStep("G1", At("T1"), At("T2")), PushStep("G1", At("T1"), Beside("T2", "below")))
    assert not any("a guess" in source.how for source in first.sources)
    assert "where step 1 should leave it: a guess" in second.sources[0].how


def test_missing_and_stray_paths_are_named() -> None:
    with pytest.raises(PlanError, match="step 1: there is no path for function 'G1'; paths: G7"):
        run(FollowStep("G1", "G1"), paths={"G7": PATH})
    with pytest.raises(PlanError, match=r"point 2 of path 'G1' at \(60, 600\) px lies outside the view"):
        run(FollowStep("G1", "G1"), paths={"G1": ((50, 50), (60, 600))})


def test_navigate_drives_to_the_place() -> None:
    (planned,) = run(NavigateStep("G1", At("T2")))
    assert isinstance(planned.action, Navigate)
    assert planned.action.path_m[-1] == pytest.approx(CAMERA.on_plane([(200, 40)], 0.0)[0][:2])


def test_without_a_camera_an_arm_plan_is_in_pixels() -> None:
    steps = (
        MoveStep("G1", At("T1"), "at"),
        CloseStep("G1"),
        MoveStep("G1", At("T2"), "at"),
        OpenStep("G1"),
        PushStep("G1", At("T1"), Beside("T2", "left")),
        FollowStep("G1", "G1"),
        HomeStep("G1"),
        NavigateStep("G1", At("T2")),
    )
    planned = ground_actions(steps, TARGETS, scene(None), LIMITS, paths={"G1": PATH})
    assert [item.action is None for item in planned] == [True, False, True, False, True, True, False, True]
    assert planned[2].sources[0].point_px == pytest.approx((200, 40))
