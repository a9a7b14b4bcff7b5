"""The safety gate: what it refuses, with all reasons at once, and what it lets through."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from tests.runtime.runtime_fakes import SquaresWorld, camera, make_plan, planned, to_m
from wonderful_team.core.actions import (
    ARM,
    PICK_PLACE,
    At,
    MoveStep,
    MoveTo,
    PickPlace,
    Push,
    PushStep,
    Trajectory,
    Vocabulary,
)
from wonderful_team.core.geometry import Box, Pose
from wonderful_team.core.values import (
    GateReport,
    KeepOut,
    Limits,
    NumberSource,
    Observation,
    PlannedAction,
    RobotState,
    View,
)
from wonderful_team.runtime import Approval, Proposal, actions_id, check_gate

LIMITS = Limits((0.25, -0.5, 0.0), (0.75, 0.5, 0.3))
MOVE = ((60.0, 60.0), (200.0, 30.0))


def gate(actions, **options):
    settings = {"vocabulary": PICK_PLACE, "limits": LIMITS, "plan": None, "then": None, "now": SquaresWorld().observe()}
    return check_gate(actions, **{**settings, **options})


def failed(report):
    return {check.name for check in report.checks if not check.ok}


def put(pick, place):
    """A pick and place given in metres, without sources."""
    return PlannedAction(planned(1, *MOVE).step, PickPlace(np.array(pick), np.array(place)))


def test_a_sound_plan_is_admitted_with_a_margin_for_every_limit():
    now = SquaresWorld().observe()
    plan = make_plan(now, [MOVE])
    report = gate(plan.actions, plan=plan, then=now, now=now, must_run=True)
    assert report.admitted
    margins = {check.name: check.margin for check in report.checks}
    assert margins["workspace x"] == "+0.117 m"
    assert margins["height"] == "+0.000 m"


def test_all_problems_are_reported_at_once():
    bad = put((0.1, 0.0, 0.0), (0.5, 0.7, 0.4))
    report = gate([bad, planned(2, *MOVE)], vocabulary=Vocabulary(("push",)), approval_required=True)
    assert failed(report) == {"approval", "vocabulary", "workspace x", "workspace y", "height", "carrying height"}
    assert "action 1: workspace x: 0.100 to 0.500 m (valid: [0.250, 0.750] m)" in report.reasons
    assert "action 2: vocabulary: pick_place (valid: push)" in report.reasons


def test_nothing_to_run_is_refused():
    assert failed(gate([])) == {"actions"}


def test_a_carry_higher_than_the_workspace_is_refused():
    low_ceiling = Limits((0.25, -0.5, 0.0), (0.75, 0.5, 0.15), clearance_m=0.2)
    report = gate([planned(1, *MOVE)], limits=low_ceiling)
    assert failed(report) == {"height"}


@pytest.mark.parametrize(
    "region",
    [
        KeepOut("cable", Box(120, 35, 140, 60), "px"),
        KeepOut("cable", Box(0.40, -0.03, 0.50, 0.03), "m"),
    ],
    ids=["px", "m"],
)
def test_the_swept_path_may_not_cross_a_keep_out_region(region):
    """Neither end lies in it, but the way between does: in pixels through the camera, or in metres."""
    crossing = gate([planned(1, *MOVE)], limits=replace(LIMITS, keep_out=(region,)))
    assert failed(crossing) == {"keep-out cable"}
    assert "action 1: keep-out cable: enters it (valid: at least 0.010 m)" in crossing.reasons
    round_it = gate([planned(1, (60.0, 100.0), (200.0, 100.0))], limits=replace(LIMITS, keep_out=(region,)))
    assert round_it.admitted


def test_a_thin_region_between_samples_is_not_missed():
    thread = KeepOut("thread", Box(0.25, 0.0001, 0.75, 0.0002), "m")
    assert failed(gate([planned(1, *MOVE)], limits=replace(LIMITS, keep_out=(thread,)))) == {"keep-out thread"}


def test_the_plans_own_keep_out_counts_too():
    now = SquaresWorld().observe()
    plan = make_plan(now, [MOVE], keep_out=(KeepOut("cup", Box(190, 20, 210, 40)),))
    assert "keep-out cup" in failed(gate(plan.actions, plan=plan, then=now, now=now))


def test_pushes_moves_and_trajectories_are_swept():
    wall = replace(LIMITS, keep_out=(KeepOut("wall", Box(0.25, -0.01, 0.75, 0.01), "m"),))
    vocabulary = Vocabulary(("push", *ARM.kinds))
    left, right = np.array([0.5, -0.2, 0.1]), np.array([0.5, 0.2, 0.1])
    push = PlannedAction(PushStep("G1", At("T1"), At("T2")), Push(left, right))
    path = PlannedAction(MoveStep("G1", At("T1")), Trajectory(np.array([left, right])))
    to_left = PlannedAction(MoveStep("G1", At("T1")), MoveTo(Pose.at(left)))
    to_right = PlannedAction(MoveStep("G1", At("T1")), MoveTo(Pose.at(right)))
    for actions in ([push], [path], [to_left, to_right]):
        assert failed(gate(actions, vocabulary=vocabulary, limits=wall)) == {"keep-out wall"}
    assert gate([to_right], vocabulary=vocabulary, limits=wall).admitted
    view = SquaresWorld().observe().main
    standing_left = Observation({"top": view}, RobotState(tool_m=left))
    assert failed(gate([to_right], vocabulary=vocabulary, limits=wall, now=standing_left)) == {"keep-out wall"}


def photo():
    view = SquaresWorld().observe().main
    return Observation({"photo": View("photo", "photo", 0.0, view.rgb)})


def in_pixels(pick, place):
    whole = planned(1, *MOVE)
    sources = (
        NumberSource("pick", "T1", pick, None, "T1 point"),
        NumberSource("place", "T2", place, None, "T2 point"),
    )
    return PlannedAction(whole.step, None, sources)


def test_without_a_camera_a_plan_is_checked_in_pixels_and_says_so():
    report = gate([in_pixels((60.0, 60.0), (200.0, 30.0))], now=photo())
    assert report.admitted
    assert "pixels only" in {check.value for check in report.checks}
    outside = gate([in_pixels((60.0, 60.0), (300.0, 30.0))], now=photo())
    assert failed(outside) == {"picture x"}
    crossing = replace(LIMITS, keep_out=(KeepOut("cable", Box(120, 35, 140, 60)),))
    assert failed(gate([in_pixels(*MOVE)], now=photo(), limits=crossing)) == {"keep-out cable"}


def test_pixels_cannot_run_and_metric_regions_cannot_be_checked_without_a_camera():
    metric = replace(LIMITS, keep_out=(KeepOut("cable", Box(0.4, 0, 0.5, 0.1), "m"),))
    report = gate([in_pixels(*MOVE)], now=photo(), limits=metric, must_run=True)
    assert failed(report) == {"metres", "keep-out cable"}


def test_metres_without_a_camera_are_held_against_regions_in_pixels():
    region = replace(LIMITS, keep_out=(KeepOut("cable", Box(120, 35, 140, 60)),))
    assert failed(gate([planned(1, *MOVE)], now=photo(), limits=region)) == {"keep-out cable"}
    blind = put(to_m(MOVE[0]), to_m(MOVE[1]))
    assert failed(gate([blind], now=photo(), limits=region)) == {"keep-out cable"}


def test_an_approval_must_be_for_this_very_plan_and_by_somebody():
    now = SquaresWorld().observe()
    plan = make_plan(now, [MOVE])
    common = {"plan": plan, "then": now, "now": now, "approval_required": True}
    consent = Proposal(plan, plan.actions, GateReport(()), now.hash).approve("Ada")
    assert gate(plan.actions, **common, approval=consent).admitted
    assert failed(gate(plan.actions, **common)) == {"approval"}

    def without(**change):
        return failed(gate(plan.actions, **common, approval=replace(consent, **change)))

    assert without(plan_id=plan.id[:12]) == {"approval"}
    assert without(by=" ") == {"approval"}
    assert without(picture="") == {"approved picture"}
    assert without(page="0" * 64) == {"approved page"}
    assert without(expires_s=time.time() - 1) == {"approval still holds"}
    assert without(expires_s=0.0) == {"approval still holds"}
    assert failed(gate(plan.actions, **common, approval=consent, page="0" * 64)) == {"approved page"}
    bare = Approval(plan.id, "Ada")
    assert failed(gate(plan.actions, **common, approval=bare)) == {"approved picture", "approval still holds"}
    free = [planned(1, *MOVE)]
    consent = Proposal(None, free, GateReport(()), now.hash).approve("Ada")
    assert consent.plan_id == actions_id(free)
    assert gate(free, approval=consent, approval_required=True).admitted


def test_the_plan_that_was_read_is_the_plan_that_runs():
    now = SquaresWorld().observe()
    read = make_plan(now, [MOVE])
    other = make_plan(now, [((60.0, 60.0), (200.0, 31.0))])
    assert failed(gate(other.actions, plan=other, then=now, now=now, expected_plan_id=read.id)) == {
        "plan that was read"
    }
    smuggled = gate(other.actions, plan=read, then=now, now=now, expected_plan_id=read.id)
    assert failed(smuggled) == {"actions of the plan"}


def test_a_nudged_object_is_noticed_and_sensor_noise_is_not():
    world = SquaresWorld(noise=4.0)
    then = world.observe()
    plan = make_plan(then, [MOVE])
    assert gate(plan.actions, plan=plan, then=then, now=world.observe()).admitted
    for nudge_px in (2.6, 5.1):  # one and two centimetres
        moved = SquaresWorld({"red": (60.0 + nudge_px, 60.0), "blue": (160.0, 90.0)}, noise=4.0)
        moved.reobserve = 7
        assert failed(gate(plan.actions, plan=plan, then=then, now=moved.observe())) == {"unchanged: T1 (pick)"}


def test_something_new_at_the_place_is_noticed_and_elsewhere_is_not():
    then = SquaresWorld().observe()
    plan = make_plan(then, [MOVE])
    common = {"plan": plan, "then": then}
    blocked = SquaresWorld({"red": (60.0, 60.0), "blue": (200.0, 30.0)}).observe()
    assert failed(gate(plan.actions, **common, now=blocked)) == {"unchanged: T2 (place)"}
    elsewhere = SquaresWorld({"red": (60.0, 60.0), "blue": (100.0, 110.0)}).observe()
    assert gate(plan.actions, **common, now=elsewhere).admitted


def test_what_the_plan_itself_changed_is_excused():
    then = SquaresWorld().observe()
    plan = make_plan(then, [MOVE])
    blocked = SquaresWorld({"red": (60.0, 60.0), "blue": (200.0, 30.0)}).observe()
    assert gate(plan.actions, plan=plan, then=then, now=blocked, expected_change=[Box(190, 20, 210, 40)]).admitted


def test_an_old_picture_and_a_foreign_picture_are_refused():
    then = SquaresWorld().observe()
    plan = make_plan(then, [MOVE])
    late = Observation({"top": View("top", "top", 700.0, then.main.rgb, camera=camera())})
    assert failed(gate(plan.actions, plan=plan, then=then, now=late)) == {"picture age"}
    assert gate(plan.actions, plan=plan, then=then, now=late, max_age_s=None).admitted
    other = SquaresWorld({"red": (60.0, 60.0)}).observe()
    assert "picture of the plan" in failed(gate(plan.actions, plan=plan, then=other, now=then))
    assert failed(gate(plan.actions, plan=plan, then=None, now=other)) == {"scene"}
    assert gate(plan.actions, plan=plan, then=None, now=then).admitted


def test_actions_without_sources_are_watched_where_they_project_to():
    then = SquaresWorld().observe()
    moved = SquaresWorld({"red": (63.0, 60.0), "blue": (160.0, 90.0)}).observe()
    bare = put(to_m(MOVE[0]), to_m(MOVE[1]))
    assert gate([bare], then=then, now=then).admitted
    assert failed(gate([bare], then=then, now=moved)) == {"unchanged: T1 (pick)"}
