"""What the gate cannot decide it refuses: foreign actions, numbers without sense, steps and sources that say something else."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest

from tests.runtime.runtime_fakes import HALF_PX, SquaresWorld, camera, make_plan, planned, to_m
from wonderful_team.core.actions import (
    ARM,
    At,
    CloseStep,
    EndEffectorDelta,
    Gripper,
    Home,
    HomeStep,
    MoveStep,
    MoveTo,
    OpenStep,
    PickPlace,
    PickPlaceStep,
    Push,
    PushStep,
    RotateGripper,
    RotateGripperStep,
    Vocabulary,
)
from wonderful_team.core.geometry import Box, PlanarCamera, Pose
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
from wonderful_team.runtime import check_gate

LIMITS = Limits((0.25, -0.5, 0.0), (0.75, 0.5, 0.3))
WORDS = Vocabulary(("pick_place", "push", "end_effector_delta", *ARM.kinds))
STEP = PickPlaceStep("G1", "T1", At("T2"))
MOVE = ((60.0, 60.0), (200.0, 30.0))


def gate(*actions: Any, **options: Any) -> GateReport:
    given = {"vocabulary": WORDS, "limits": LIMITS, "plan": None, "then": None, "now": SquaresWorld().observe()}
    return check_gate(actions, **{**given, **options})


def failed(report: GateReport) -> set[str]:
    return {check.name for check in report.checks if not check.ok}


def put(pick: Any, place: Any, yaw_rad: float = 0.0) -> PlannedAction:
    step = replace(STEP, rotate_deg=-math.degrees(yaw_rad)) if abs(yaw_rad) < 100 else STEP
    return PlannedAction(step, PickPlace(np.array(pick), np.array(place), yaw_rad))


def keep_out(*box: float) -> Limits:
    return replace(LIMITS, keep_out=(KeepOut("wall", Box(*box), "m"),))


def delta(*numbers: float) -> PlannedAction:
    return PlannedAction(MoveStep("G1", At("T1")), EndEffectorDelta(np.array(numbers)))


def test_a_step_of_a_learned_policy_needs_to_know_where_the_tool_is() -> None:
    assert failed(gate(delta(50, 0, 0, 0, 0, 0, 0))) == {"tool position"}
    assert failed(gate(delta(0.01, 0, 0, 0, 0, 0, 0))) == {"tool position"}
    view = SquaresWorld().observe().main
    known = Observation({"top": view}, RobotState(np.array([0.5, 0.0, 0.2])))
    assert gate(delta(0.01, 0, 0, 0, 0, 0, 0), delta(0.01, 0, 0, 0, 0, 0, 1), now=known).admitted
    assert failed(gate(delta(50, 0, 0, 0, 0, 0, 0), now=known)) == {"workspace x"}
    assert failed(gate(delta(0, 0, 0, 9.0, 0, 0, 0), now=known)) == {"turn"}
    assert failed(gate(delta(0, 0, 0, 0, 0, 0, 7.0), now=known)) == {"gripper"}
    lost = Observation({"top": view}, RobotState(np.array([np.nan, 0.0, 0.2])))
    assert failed(gate(delta(0.01, 0, 0, 0, 0, 0, 0), now=lost)) == {"tool position"}


@dataclass(frozen=True)
class Teleport:
    """Says that it is a pick and place, and is not."""

    kind: ClassVar[str] = "pick_place"
    secret: object = None


class Quicker(PickPlace):
    """Is a pick and place, but might do anything."""


@pytest.mark.parametrize(
    "action", [Teleport(), Quicker(np.zeros(3), np.zeros(3)), "pick_place", 7], ids=["own", "sub", "text", "number"]
)
def test_an_action_of_an_unknown_class_is_refused(action: Any) -> None:
    report = gate(PlannedAction(STEP, action))
    assert failed(report) == {"class of action"}
    assert type(action).__name__ in report.reasons[0]
    assert "PickPlace, Push, MoveTo" in report.reasons[0]


def test_a_step_or_a_planned_action_of_an_unknown_class_is_refused() -> None:
    action = PickPlace(np.array([0.5, 0, 0]), np.array([0.5, 0.1, 0]))
    assert failed(gate(PlannedAction("pick it", action))) == {"class of action"}  # type: ignore[arg-type]
    assert failed(gate(action)) == {"class of action"}


def test_a_gripper_has_three_states() -> None:
    with pytest.raises(ValueError, match="state: expected open, close, tight, got 'explode'"):
        Gripper("explode")  # type: ignore[arg-type]
    forged = Gripper("open")
    object.__setattr__(forged, "state", "explode")
    assert "gripper" in failed(gate(PlannedAction(OpenStep("G1"), forged)))


@pytest.mark.parametrize("yaw_rad", [1e300, 10_000.0, -10_000.0, 6.3])
def test_more_than_one_whole_turn_is_refused(yaw_rad: float) -> None:
    assert "turn" in failed(gate(put((0.5, -0.2, 0), (0.5, 0.2, 0), yaw_rad)))
    step = RotateGripperStep("G1", -math.degrees(yaw_rad) if abs(yaw_rad) < 100 else 0.0)
    assert "turn" in failed(gate(PlannedAction(step, RotateGripper(yaw_rad))))


def test_a_whole_turn_is_admitted() -> None:
    assert gate(put((0.5, -0.2, 0), (0.5, 0.2, 0), -2 * math.pi)).admitted


def test_the_step_has_to_say_what_the_action_does() -> None:
    ends = np.array([0.5, -0.2, 0.0]), np.array([0.5, 0.2, 0.0])
    turned = PlannedAction(STEP, PickPlace(*ends, 0.5))
    assert failed(gate(turned)) == {"turn of the step"}
    assert failed(gate(PlannedAction(OpenStep("G1"), PickPlace(*ends)))) == {"step and action"}
    assert failed(gate(PlannedAction(OpenStep("G1"), Gripper("close")))) == {"grip of the step"}
    assert failed(gate(PlannedAction(CloseStep("G1"), Gripper("tight")))) == {"grip of the step"}
    assert gate(PlannedAction(CloseStep("G1", tight=True), Gripper("tight"))).admitted


def with_source(number: int, **changes: Any) -> PlannedAction:
    whole = planned(1, *MOVE)
    sources = list(whole.sources)
    sources[number] = replace(sources[number], **changes)
    return replace(whole, sources=tuple(sources))


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        (with_source(0, position_m=(0.4, 0.4, 0.0)), "sources"),
        (with_source(1, position_m=None), "sources"),
        (with_source(0, target="T2"), "sources"),
        (with_source(1, role="pick"), "sources"),
        (with_source(0, point_px=(90.0, 60.0)), "sources"),
        (with_source(1, point_px=(200.0, 90.0)), "sources"),
        (replace(planned(1, *MOVE), sources=planned(1, *MOVE).sources[:1]), "sources"),
        (with_source(0, point_px=(-500.0, 60.0)), "inside the picture"),
        (with_source(1, point_px=(200.0, 4000.0)), "inside the picture"),
    ],
)
def test_sources_have_to_agree_with_step_and_numbers(changed: PlannedAction, name: str) -> None:
    assert gate(planned(1, *MOVE)).admitted
    assert name in failed(gate(changed))


def test_sources_outside_the_picture_do_not_hide_that_the_scene_has_changed() -> None:
    then = SquaresWorld().observe()
    moved = SquaresWorld({"red": (90.0, 60.0), "blue": (160.0, 90.0)}).observe()
    far = tuple(replace(source, point_px=(-900.0, -900.0)) for source in planned(1, *MOVE).sources)
    hidden = replace(planned(1, *MOVE), sources=far)
    assert {"unchanged: T1 (pick)", "unchanged: T2 (place)"} <= failed(gate(hidden, then=then, now=moved))


def test_where_nothing_says_what_to_watch_the_whole_picture_is_watched() -> None:
    def bare(world: SquaresWorld) -> Observation:
        view = world.observe().main
        return Observation({"top": View("top", "top", 0.0, view.rgb)})

    action = put(to_m(MOVE[0]), to_m(MOVE[1]))
    then = bare(SquaresWorld())
    assert gate(action, then=then, now=bare(SquaresWorld())).admitted
    moved = bare(SquaresWorld({"red": (60.0, 60.0), "blue": (100.0, 90.0)}))
    assert failed(gate(action, then=then, now=moved)) == {"unchanged: whole picture"}


def test_the_way_between_two_actions_may_not_cross_a_keep_out_region() -> None:
    wall = keep_out(0.25, -0.01, 0.75, 0.01)
    left, right = put((0.5, -0.4, 0), (0.4, -0.4, 0)), put((0.5, 0.4, 0), (0.4, 0.4, 0))
    assert gate(left, limits=wall).admitted
    assert gate(right, limits=wall).admitted
    report = gate(left, right, limits=wall)
    assert report.reasons == ("action 2: keep-out wall: enters it (valid: at least 0.010 m)",)


def test_the_way_between_a_push_and_a_pick_is_looked_at_too() -> None:
    wall = keep_out(0.25, -0.01, 0.75, 0.01)
    push = PlannedAction(
        PushStep("G1", At("T1"), At("T2")), Push(np.array([0.5, -0.3, 0.0]), np.array([0.5, -0.2, 0.0]))
    )
    assert failed(gate(push, put((0.5, 0.4, 0), (0.4, 0.4, 0)), limits=wall)) == {"keep-out wall"}


def test_a_way_home_that_nobody_knows_is_refused_beside_a_keep_out_region() -> None:
    home = PlannedAction(HomeStep("G1"), Home())
    assert gate(home).admitted
    assert failed(gate(home, limits=keep_out(0.25, -0.01, 0.75, 0.01))) == {"keep-out wall"}


def test_the_size_of_what_is_carried_is_kept_clear() -> None:
    """A thing of 20 cm whose middle passes 1.1 cm beside a region is refused; a small one is not."""
    now = SquaresWorld().observe()
    wall = keep_out(0.25, 0.4, 0.75, 0.45)
    edge_px = float(camera().project([(0.5, 0.4, 0.0)])[0][0])
    place = (edge_px - 2.9 - HALF_PX, 60.0)  # the square's edge comes to lie 1.1 cm from the wall
    plan = make_plan(now, [((60.0, 60.0), place)])
    assert gate(*plan.actions, plan=plan, limits=wall).admitted
    wide = replace(plan.grounded["T1"], box=Box.around((60.0, 60.0), 0.2 * 256, 0.2 * 256))
    big = replace(plan, grounded={**plan.grounded, "T1": wide})
    assert failed(gate(*big.actions, plan=big, limits=wall)) == {"keep-out wall"}


def test_a_thing_of_unknown_size_is_taken_to_be_large() -> None:
    beside = put((0.5, -0.4, 0), (0.5, 0.36, 0))
    report = gate(beside, limits=keep_out(0.25, 0.4, 0.75, 0.45))
    assert failed(report) == {"keep-out wall"}
    assert gate(put((0.5, -0.4, 0), (0.5, 0.2, 0)), limits=keep_out(0.25, 0.4, 0.75, 0.45)).admitted


def test_what_a_gripper_holds_is_kept_clear_until_it_opens() -> None:
    near = PlannedAction(MoveStep("G1", At("T2")), MoveTo(Pose.at((0.5, 0.36, 0.2))))
    wall = keep_out(0.25, 0.4, 0.75, 0.45)
    close, open_ = PlannedAction(CloseStep("G1"), Gripper("close")), PlannedAction(OpenStep("G1"), Gripper("open"))
    assert gate(near, limits=wall).admitted
    assert failed(gate(close, near, limits=wall)) == {"keep-out wall"}
    assert gate(close, open_, near, limits=wall).admitted
    holding = Observation({"top": SquaresWorld().observe().main}, RobotState(holding=True))
    assert failed(gate(near, limits=wall, now=holding)) == {"keep-out wall"}


def test_a_keep_out_region_above_the_horizon_of_four_corners_refuses() -> None:
    lens = PlanarCamera.from_corners(
        [(100, 60), (156, 60), (250, 120), (6, 120)], [(0.25, -0.5), (0.25, 0.5), (0.75, 0.5), (0.75, -0.5)]
    )
    seen = SquaresWorld().observe().main
    now = Observation({"top": View("top", "top", 0.0, seen.rgb, camera=lens)})
    action = put((0.5, -0.2, 0), (0.5, 0.2, 0))
    assert gate(action, now=now).admitted
    across = replace(LIMITS, keep_out=(KeepOut("lamp", Box(120, 5, 130, 118)),))
    report = gate(action, now=now, limits=across)
    assert report.reasons == ("action 1: keep-out lamp: meets no table (valid: a region on the table)",)


def test_source_of_a_push_may_lie_just_outside_of_the_picture_and_its_way_is_watched() -> None:
    def push() -> PlannedAction:
        ends = (-12.0, 60.0), (60.0, 60.0)
        sources = tuple(
            NumberSource(role, target, px, tuple(to_m(px).tolist()), "test")
            for role, target, px in zip(("push_start", "push_end"), ("T1", "T2"), ends, strict=True)
        )
        return PlannedAction(PushStep("G1", At("T1"), At("T2")), Push(to_m(ends[0]), to_m(ends[1])), sources)

    wide = replace(LIMITS, low_m=(0.25, -0.55, 0.0))
    then = SquaresWorld({"red": (30.0, 60.0)}).observe()
    assert gate(push(), then=then, now=then, limits=wide).admitted
    other = SquaresWorld({"red": (45.0, 60.0)}).observe()
    assert "unchanged: T1 (push_start)" in failed(gate(push(), then=then, now=other, limits=wide))
