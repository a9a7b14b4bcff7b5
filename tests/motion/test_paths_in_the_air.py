"""Paths that rise: how high they lead, and what is refused before anybody looks at them."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, looking_down, scene
from wonderful_team.core.actions import ARM, At, CloseStep, FollowStep, MoveStep, OriginOf, Step, Trajectory
from wonderful_team.core.pictures import PathPoint
from wonderful_team.core.values import NO_WORKSPACE, Observation, PlannedAction
from wonderful_team.errors import PlanError
from wonderful_team.motion import ground_actions
from wonderful_team.motion.follow import carried_z_m, most_up_m, path_problem, seen_from
from wonderful_team.runtime.gate import check_gate

CAMERA = affine_top()
RED, BLUE = Block(0.46, -0.1, 0.52, 0.0, 0.06), Block(0.4, 0.2, 0.5, 0.3, 0.08)
VIEW = scene(CAMERA, RED, BLUE)
TARGETS = {"T1": found(CAMERA, "T1", RED), "T2": area("T2", (200, 40))}
HELD: tuple[Step, ...] = (
    MoveStep("G1", At("T1"), "at"), CloseStep("G1", True), MoveStep("G1", At("T1"), "clear"), FollowStep("G1", "G1", "air"),
)  # fmt: skip


def over(*ups: float) -> tuple[PathPoint, ...]:
    x, y = (float(value) for value in CAMERA.project([(0.49, -0.05, 0.06)])[0])
    return tuple((x, y, up) for up in ups)


def run(*steps: Step, path: tuple[PathPoint, ...]) -> tuple[PlannedAction, ...]:
    return ground_actions(steps, TARGETS, VIEW, LIMITS, paths={"G1": path})


def test_what_is_held_is_moved_up_and_down_over_the_height_at_which_it_is_carried() -> None:
    *_, clear, shaken, back = run(*HELD, MoveStep("G1", OriginOf("T1"), "at"), path=over(0.0, 0.05, 0.0, 0.05, 0.0))
    assert isinstance(shaken.action, Trajectory)
    points = shaken.action.waypoints_m
    carried = clear.action.pose.position_m[2]  # type: ignore[union-attr]
    assert points[:, 2] == pytest.approx(carried + np.array([0.0, 0.05, 0.0, 0.05, 0.0]))
    assert np.ptp(points[:, :2], axis=0) == pytest.approx((0, 0), abs=1e-9)
    assert "0.050 m up" in shaken.sources[1].how
    assert back.action.pose.position_m[2] == pytest.approx(0.03, abs=1e-3), "back down to where it was gripped"  # type: ignore[union-attr]


def test_a_path_that_rises_out_of_the_workspace_says_how_much_is_left() -> None:
    with pytest.raises(PlanError, match=r"step 4: point 2 .* rises by 0\.900 m .* at most 0\.\d+ m are left there"):
        run(*HELD, path=over(0.0, 0.9))


def test_a_path_that_rises_is_not_followed_on_the_surface() -> None:
    with pytest.raises(PlanError, match="rises, so it is followed in the air"):
        run(FollowStep("G1", "G1", "surface"), path=over(0.0, 0.05))


@pytest.mark.parametrize(("noise_m", "even"), [(0.0015, True), (0.006, False)], ids=["noise", "steps of a surface"])
def test_points_of_one_surface_lie_on_one_plane_as_far_as_depth_tells(noise_m: float, even: bool) -> None:
    assert VIEW.depth_m is not None
    depth = VIEW.depth_m - np.where(np.arange(VIEW.depth_m.shape[1]) // 16 % 2, noise_m, 0.0).astype(np.float32) - 0.02
    view = replace(VIEW, depth_m=depth)
    path = tuple((float(x), y) for x, y in zip(range(40, 125, 16), (20.0, 20.0, 90.0, 90.0, 20.0, 20.0), strict=True))
    (drawn,) = ground_actions((FollowStep("G1", "G1", "surface"),), TARGETS, view, LIMITS, paths={"G1": path})
    assert isinstance(drawn.action, Trajectory)
    heights = drawn.action.waypoints_m[1:-1, 2]
    across = np.column_stack([drawn.action.waypoints_m[1:-1, :2], np.ones(len(path))])
    off = heights - across @ np.linalg.lstsq(across, heights, rcond=None)[0]
    assert bool(np.abs(off).max() < 1e-6) is even
    assert np.abs(heights - 0.02).max() <= noise_m + 1e-4
    assert ("one plane" in drawn.sources[1].how) is even


def test_how_far_a_path_may_rise_leaves_room_for_whatever_is_held() -> None:
    up_m = most_up_m(carried_z_m(TARGETS, VIEW, LIMITS), LIMITS)
    assert 0 < up_m < LIMITS.high_m[2]
    (*_, shaken) = run(*HELD, path=over(0.0, up_m))
    assert isinstance(shaken.action, Trajectory)
    assert shaken.action.waypoints_m[:, 2].max() <= LIMITS.high_m[2] + 1e-6
    assert most_up_m(carried_z_m(TARGETS, VIEW, NO_WORKSPACE), NO_WORKSPACE) == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("path", "says"),
    [
        (((-3.0, 20.0), (10.0, 20.0)), "point 1 lies outside the picture"),
        (over(0.0, 0.4), r"point 2 has up = 0.400 m; valid: 0 to 0.10 m"),
        (over(0.0, -0.05), "point 2 has up = -0.050 m"),
    ],
)
def test_what_no_arm_could_follow_is_named(path: tuple[PathPoint, ...], says: str) -> None:
    assert re.search(says, path_problem(path, VIEW, LIMITS, 0.1))


def test_a_point_beyond_the_workspace_is_named_with_its_axis_and_limits() -> None:
    path = over(0.0, 0.05)
    assert path_problem(path, VIEW, LIMITS, 0.1) == ""
    near = replace(LIMITS, high_m=(0.45, *LIMITS.high_m[1:]))
    assert "point 1 is out of reach: its x = 0.490 m in the base frame (valid: " in path_problem(path, VIEW, near, 0.1)
    assert "to 0.450 m)" in path_problem(path, VIEW, near, 0.1)


def test_the_gate_refuses_a_path_that_meets_something() -> None:
    (planned,) = run(FollowStep("G1", "G1", "air"), path=over(0.0, 0.05))
    assert isinstance(planned.action, Trajectory)
    low = Trajectory(np.array([[0.49, -0.05, 0.2], [0.45, 0.25, 0.03]]))
    now = Observation({"top": VIEW}, None)
    for action, admitted in ((planned.action, True), (low, False)):
        one = PlannedAction(planned.step, action)
        report = check_gate([one], vocabulary=ARM, limits=LIMITS, plan=None, then=None, now=now)
        checks = [check for check in report.checks if check.name == "under the way"]
        assert [check.ok for check in checks] == [admitted]


def test_a_path_that_rises_is_seen_rising_from_the_side() -> None:
    camera = looking_down(tilt_deg=25)
    side = scene(camera, RED)
    pixels = seen_from(over(0.0, 0.1), 0.15, VIEW, side)
    assert np.array(pixels) == pytest.approx(camera.project([(0.49, -0.05, 0.15), (0.49, -0.05, 0.25)]), abs=1.0)
    assert np.linalg.norm(np.subtract(*pixels)) > 5, "in the main view both are one pixel"
    assert seen_from(over(0.0, 0.1), 0.15, VIEW, scene(None)) == ()
    assert seen_from(over(0.0, 3.0), 0.15, VIEW, side) == (), "what leaves the view is not drawn in it"
