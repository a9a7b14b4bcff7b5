"""The profile of the tool's way: its clearance is the gate's, where it is smallest can be seen in it, and it is bounded."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, looking_down, scene
from tests.runtime.carrying import carried
from wonderful_team.core.actions import ARM, At, PickPlaceStep, Step, Trajectory, Vocabulary
from wonderful_team.core.geometry import Camera
from wonderful_team.core.steps import FollowStep
from wonderful_team.core.values import (
    GateCheck,
    GateReport,
    HeightProfile,
    Instruction,
    Observation,
    Plan,
    PlannedAction,
    RobotState,
    View,
)
from wonderful_team.motion import ground_actions
from wonderful_team.runtime import check_gate
from wonderful_team.runtime.passing import MOST_OF_A_PLAN, MOST_POINTS

RED, TOWER = Block(0.40, -0.30, 0.46, -0.24), Block(0.41, -0.02, 0.45, 0.02, 0.11)
BEHIND = (0.43, 0.25, 0.0)


def judged(camera: Camera, *steps: Step, depth: bool = True) -> GateReport:
    """The gate's word on carrying the red block past the tower, to behind it."""
    view = scene(camera, RED, TOWER, depth=depth)
    (place,) = camera.project([BEHIND])
    grounded = {"T1": found(camera, "T1", RED), "A1": area("A1", (float(place[0]), float(place[1])))}
    actions = ground_actions(steps, grounded, scene(camera, RED, TOWER), LIMITS)
    now = Observation({"top": view}).hash
    plan = Plan(Instruction("tidy up"), "planned", actions=actions, grounded=grounded, scene_hash=now)
    return passed(actions, plan, view)


def passed(actions: tuple[PlannedAction, ...], plan: Plan | None, view: View) -> GateReport:
    now = Observation({"top": view}, RobotState(np.array([0.5, 0.0, 0.25])))
    words = Vocabulary((*ARM.kinds, "pick_place"))
    return check_gate(actions, vocabulary=words, limits=LIMITS, plan=plan, then=now, now=now)


def check_of(report: GateReport, action: int, name: str) -> GateCheck:
    return next(check for check in report.checks if check.action == action and check.name == name)


def agrees(profile: HeightProfile) -> None:
    """What is drawn shows the stated clearance where it is stated to be, and nothing comes nearer."""
    assert profile.clearance_m is not None
    assert profile.nearest is not None
    gaps = profile.low_m - profile.surface_m
    assert gaps[profile.nearest] == pytest.approx(profile.clearance_m, abs=1e-6)
    known = gaps[np.isfinite(gaps)]
    assert known.min() >= profile.clearance_m - 0.003


@pytest.mark.parametrize("camera", [affine_top(), looking_down()], ids=["affine", "pinhole"])
def test_a_carried_block_comes_nearest_to_the_tower_by_the_gates_own_number(camera: Camera) -> None:
    report = judged(camera, PickPlaceStep("G1", "T1", At("A1")))
    assert report.admitted, report.reasons
    (profile,) = report.profiles
    margin = float(check_of(report, 0, "under the way").margin.removesuffix(" m"))
    assert profile.clearance_m == pytest.approx(margin + 0.01, abs=6e-4)
    assert profile.least_m == 0.01
    assert profile.clearance_m == pytest.approx(0.2 - 0.05 - 0.11, abs=2e-3)
    agrees(profile)
    assert profile.points_m[profile.nearest, 1] == pytest.approx(0.0, abs=0.06)
    assert not profile.stays


def test_every_move_of_an_arm_has_the_number_of_its_check() -> None:
    report = judged(affine_top(), *carried("T1", "A1"))
    assert report.admitted, report.reasons
    told = 0
    for profile in report.profiles:
        check = check_of(report, profile.action, "under the way")
        assert profile.stays
        if profile.clearance_m is None:
            assert check.value == "nothing seen"
            continue
        assert check.value == f"{profile.clearance_m:+.3f} m over what is seen"
        agrees(profile)
        told += 1
    assert told >= 3
    past = min((one for one in report.profiles if one.action == 5), key=lambda one: one.clearance_m or math.inf)
    assert past.clearance_m == pytest.approx(0.25 - 0.05 - 0.11, abs=0.06)
    assert past.surface_m[past.nearest] == pytest.approx(0.11, abs=2e-3)


def test_an_action_that_the_gate_refuses_for_its_way_shows_how_far_it_hits() -> None:
    """Straight through the tower."""
    step = FollowStep("G1", "T1")
    path = Trajectory(np.array([[0.43, -0.2, 0.03], [0.43, 0.2, 0.03]]))
    report = passed((PlannedAction(step, path, ()),), None, scene(affine_top(), TOWER))
    assert not check_of(report, 0, "under the way").ok
    (profile,) = report.profiles
    assert profile.clearance_m == pytest.approx(0.03 - 0.11, abs=2e-3)
    agrees(profile)


def test_without_depth_there_is_a_way_and_no_height_is_made_up() -> None:
    report = judged(affine_top(), PickPlaceStep("G1", "T1", At("A1")), depth=False)
    (profile,) = report.profiles
    assert np.isnan(profile.surface_m).all()
    assert (profile.clearance_m, profile.nearest, profile.least_m) == (None, None, None)


def test_profiles_are_bounded_and_keep_the_nearest_point() -> None:
    turns = np.linspace(0, 40 * math.pi, 3000)
    spiral = np.column_stack([0.43 + 0.1 * np.sin(turns), 0.1 * np.cos(turns), np.full(3000, 0.15)])
    action = PlannedAction(FollowStep("G1", "T1"), Trajectory(spiral), ())
    view = scene(affine_top(), TOWER)
    (profile,) = passed((action,), None, view).profiles
    assert len(profile.points_m) <= 2 * MOST_POINTS + 1
    agrees(profile)
    moves = tuple(replace(action, action=Trajectory(spiral[k : k + 2])) for k in range(0, 400, 2))
    many = passed(moves, None, view).profiles
    assert len(many) == 200
    assert sum(len(one.points_m) for one in many) <= 2 * MOST_OF_A_PLAN + 200


def test_a_profile_whose_parts_do_not_fit_together_is_refused() -> None:
    with pytest.raises(ValueError, match=r"surface_m: expected one row for each of 2 points"):
        HeightProfile(0, np.zeros((2, 3)), np.zeros(2), np.zeros(3), np.zeros(2))
