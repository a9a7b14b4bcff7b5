"""What depth shows: a place where something stands is refused, but for what the step names; heights have to be known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, aslant_in_a_bowl, found, looking_down, scene
from wonderful_team.core.actions import (
    PICK_PLACE,
    At,
    Beside,
    OriginOf,
    PickPlace,
    PickPlaceStep,
    Push,
    PushStep,
    Step,
    Vocabulary,
)
from wonderful_team.core.geometry import Camera
from wonderful_team.core.protocols import Act, Done, Situation
from wonderful_team.core.values import (
    GateReport,
    GroundedTarget,
    Instruction,
    Observation,
    Plan,
    PlannedAction,
    StepReport,
    View,
)
from wonderful_team.motion import ground_actions
from wonderful_team.runtime import check_gate, rollout

RED = Block(0.40, -0.30, 0.46, -0.24)
BLUE = Block(0.50, 0.10, 0.56, 0.16)
BLUE_BESIDE = Block(0.40, 0.10, 0.46, 0.16)
GREEN = Block(0.50, 0.17, 0.56, 0.23)
CAMERAS = {"from above": affine_top(), "slanted": looking_down(tilt_deg=15)}


def planned(view: View, grounded: dict[str, GroundedTarget], *steps: Step) -> Plan:
    """A plan as the team makes it, from what is grounded in a view."""
    actions = ground_actions(steps, grounded, view, LIMITS)
    seen = Observation({"top": view})
    return Plan(Instruction("tidy up"), "planned", actions=actions, grounded=grounded, scene_hash=seen.hash)


def gate(plan: Plan, view: View, **options: Any) -> GateReport:
    now = Observation({"top": view})
    words = Vocabulary(("pick_place", "push"))
    return check_gate(
        plan.actions, **{"vocabulary": words, "limits": LIMITS, "plan": plan, "then": now, "now": now, **options}
    )


def failed(report: GateReport) -> set[str]:
    return {check.name for check in report.checks if not check.ok}


def px(camera: Camera, x: float, y: float, z: float = 0.0) -> tuple[float, float]:
    u, v = camera.project([(x, y, z)])[0]
    return float(u), float(v)


def blocks(camera: Camera, **named: Block) -> dict[str, GroundedTarget]:
    return {name: found(camera, name, block) for name, block in named.items()}


@pytest.mark.parametrize("name", CAMERAS)
def test_a_block_is_put_on_a_block_only_when_that_is_asked(name: str) -> None:
    camera = CAMERAS[name]
    view = scene(camera, RED, BLUE, GREEN)
    on_top = px(camera, *BLUE.centre, BLUE.height)
    grounded = {**blocks(camera, T1=RED, T2=BLUE), "A1": area("A1", on_top)}
    asked = planned(view, grounded, PickPlaceStep("G1", "T1", At("T2")))
    assert gate(asked, view).admitted
    unasked = planned(view, grounded, PickPlaceStep("G1", "T1", At("A1")))
    assert "place is level" in failed(gate(unasked, view))


@pytest.mark.parametrize("name", CAMERAS)
def test_a_free_place_is_admitted_and_one_that_reaches_into_a_block_is_not(name: str) -> None:
    camera = CAMERAS[name]
    view = scene(camera, RED, BLUE, GREEN)
    for y, admitted in ((0.0, True), (0.035, True), (0.085, False)):
        grounded = {**blocks(camera, T1=RED), "A1": area("A1", px(camera, 0.53, y))}
        report = gate(planned(view, grounded, PickPlaceStep("G1", "T1", At("A1"))), view)
        assert report.admitted is admitted, report.reasons
    free = next(check for check in report.checks if check.name == "place is free")
    assert (free.ok, free.limit, free.margin) == (False, "at most 0.010 m", "-0.040 m")


def test_beside_a_block_where_another_one_stands_is_refused() -> None:
    camera = affine_top()
    view = scene(camera, RED, BLUE, GREEN)
    grounded = blocks(camera, T1=RED, T2=BLUE)
    taken = planned(view, grounded, PickPlaceStep("G1", "T1", Beside("T2", "right")))
    assert not gate(taken, view).admitted
    free = planned(view, grounded, PickPlaceStep("G1", "T1", Beside("T2", "left")))
    assert gate(free, view).admitted


def test_a_place_that_an_earlier_action_frees_is_admitted_and_one_that_it_fills_is_not() -> None:
    camera = affine_top()
    view = scene(camera, RED, BLUE)
    grounded = {
        **blocks(camera, T1=RED, T2=BLUE),
        "A1": area("A1", px(camera, *BLUE.centre, BLUE.height)),
        "A2": area("A2", px(camera, 0.35, 0.3)),
    }
    away, into = PickPlaceStep("G1", "T2", At("A2")), PickPlaceStep("G2", "T1", At("A1"))
    swapped = planned(view, grounded, away, into)
    assert swapped.actions[1].action.place_m[2] == pytest.approx(0.0, abs=1e-6)  # type: ignore[union-attr]
    assert gate(swapped, view).admitted
    filled = planned(view, grounded, away, PickPlaceStep("G2", "T1", At("A2")))
    assert failed(gate(filled, view)) == {"place is free"}


def test_restoring_goes_back_to_where_it_stood_unless_the_plan_put_something_there() -> None:
    camera = affine_top()
    view = scene(camera, RED, BLUE)
    grounded = {**blocks(camera, T1=RED, T2=BLUE), "A1": area("A1", px(camera, 0.35, 0.3))}
    there, back = PickPlaceStep("G1", "T1", At("A1")), PickPlaceStep("G3", "T1", OriginOf("T1"))
    assert gate(planned(view, grounded, there, back), view).admitted
    taken = PickPlaceStep("G2", "T2", OriginOf("T1"))
    assert "place is free" in failed(gate(planned(view, grounded, there, taken, back), view))


def bowl_scene(camera: Camera) -> tuple[View, GroundedTarget]:
    """A bowl with a rim of 5 cm and a floor of 5 mm."""
    whole, x, y = 0.14, 0.5, 0.2
    parts = [Block(x - whole / 2, y - whole / 2, x + whole / 2, y + whole / 2, 0.005)]
    for dx, dy, a, b in (
        (-0.065, 0, 0.01, whole),
        (0.065, 0, 0.01, whole),
        (0, -0.065, whole, 0.01),
        (0, 0.065, whole, 0.01),
    ):
        parts.append(Block(x + dx - a / 2, y + dy - b / 2, x + dx + a / 2, y + dy + b / 2, 0.05))
    bowl = found(camera, "T2", Block(x - whole / 2, y - whole / 2, x + whole / 2, y + whole / 2, 0.05))
    middle = px(camera, x, y, 0.005)
    return scene(camera, RED, BLUE, *parts), replace(bowl, points={"place": middle})


def test_into_a_bowl_onto_a_sheet_and_onto_a_plate() -> None:
    camera = affine_top()
    view, bowl = bowl_scene(camera)
    grounded = {**blocks(camera, T1=RED), "T2": bowl}
    assert gate(planned(view, grounded, PickPlaceStep("G1", "T1", At("T2"))), view).admitted
    for height in (0.001, 0.015):
        plate = Block(0.45, 0.1, 0.62, 0.27, height)
        view = scene(camera, RED, plate)
        for target in (found(camera, "T2", plate, {"place": (0.5, 0.5)}), area("T2", px(camera, 0.535, 0.185, height))):
            plan = planned(view, {**blocks(camera, T1=RED), "T2": target}, PickPlaceStep("G1", "T1", At("T2")))
            assert gate(plan, view).admitted


@pytest.mark.parametrize("name", CAMERAS)
def test_a_thing_is_let_go_on_the_floor_of_its_bowl_and_never_dropped_into_it(name: str) -> None:
    """Brought back into the bowl that it lay aslant in, it comes down to the floor; higher up it is refused, whatever the sources say."""
    view, grounded = aslant_in_a_bowl(CAMERAS[name])
    plan = planned(view, grounded, PickPlaceStep("G1", "T1", At("A1")), PickPlaceStep("G2", "T1", At("T2")))
    assert gate(plan, view).admitted
    first, back = plan.actions
    assert isinstance(back.action, PickPlace)
    pick, place = back.sources
    for higher_m, names in ((0.015, set()), (0.025, {"drop"}), (0.048, {"drop"})):
        raised = back.action.place_m + (0.0, 0.0, higher_m)
        shown = px(CAMERAS[name], *raised)
        dropped = replace(
            back,
            action=replace(back.action, place_m=raised),
            sources=(pick, replace(place, position_m=tuple(map(float, raised)), point_px=shown, tool_px=None)),
        )
        assert failed(gate(replace(plan, actions=(first, dropped)), view)) == names


def test_a_thing_is_turned_in_place_but_not_into_its_neighbour() -> None:
    camera = affine_top()
    long = Block(0.40, -0.30, 0.44, -0.18)
    grounded = blocks(camera, T1=long)
    turn = PickPlaceStep("G1", "T1", At("T1"), 90.0)
    alone = scene(camera, long)
    assert gate(planned(alone, grounded, turn), alone).admitted
    crowded = scene(camera, long, Block(0.45, -0.27, 0.50, -0.21))
    assert failed(gate(planned(crowded, grounded, turn), crowded)) == {"place is free"}


def test_nothing_is_carried_against_a_tower() -> None:
    camera = affine_top()
    tower = Block(0.40, -0.05, 0.46, 0.05, 0.17)
    for height, admitted in ((0.05, False), (0.02, True)):
        block = replace(RED, height=height)
        view = scene(camera, block, tower)
        grounded = {**blocks(camera, T1=block), "A1": area("A1", px(camera, 0.43, 0.3))}
        report = gate(planned(view, grounded, PickPlaceStep("G1", "T1", At("A1"))), view)
        # The tool travels at 0.2 m; what hangs below it is as high as the block.
        assert report.admitted is admitted, report.reasons
        assert admitted or failed(report) == {"under the way"}


def test_a_world_that_lifts_tall_things_higher_carries_them_over_lower_ones() -> None:
    camera = affine_top()
    tall = replace(RED, height=0.1)
    grounded = {**blocks(camera, T1=tall), "A1": area("A1", px(camera, 0.43, 0.3))}
    step = PickPlaceStep("G1", "T1", At("A1"))
    # Without a lift the tool travels at 0.2 m and the block hangs down to 0.1 m; lifted by 0.16 m, down to 0.16 m.
    for between_m, lift_m, admitted in ((0.12, None, False), (0.12, 0.16, True), (0.17, 0.16, False)):
        view = scene(camera, tall, Block(0.40, -0.05, 0.46, 0.05, between_m))
        report = gate(planned(view, grounded, step), view, limits=replace(LIMITS, lift_m=lift_m))
        assert report.admitted is admitted, report.reasons
        assert admitted or failed(report) == {"under the way"}


def test_a_lift_ends_at_the_top_of_the_workspace() -> None:
    limits = replace(LIMITS, lift_m=0.16)
    assert [limits.carried_z_m(np.array([0, 0, z]), np.zeros(3)) for z in (0.02, 0.1, 0.2)] == pytest.approx(
        [0.2, 0.26, 0.3]
    )
    for wrong in (0.0, -0.1, np.inf, np.nan):
        with pytest.raises(ValueError, match="lift: it must be"):
            replace(LIMITS, lift_m=wrong)


def test_a_push_comes_down_on_free_ground() -> None:
    camera = affine_top()
    view = scene(camera, RED, BLUE)
    seen = Observation({"top": view}).hash

    def push(start: tuple[float, float]) -> Plan:
        action = Push(np.array([*start, 0.0]), np.array([start[0], start[1] + 0.1, 0.0]))
        step = PushStep("G1", At("T9"), At("A9"))
        return Plan(Instruction("push"), "planned", actions=(PlannedAction(step, action),), scene_hash=seen)

    assert gate(push((0.53, -0.1)), view).admitted
    assert failed(gate(push((0.53, 0.14)), view)) == {"push starts on free ground"}


@pytest.mark.parametrize("depth", [np.nan, 0.0, -1.0, np.inf], ids=["NaN", "zero", "negative", "infinite"])
def test_depth_that_says_nothing_is_refused(depth: float) -> None:
    camera = affine_top()
    view = scene(camera, RED)
    blind = View("top", "top", 0.0, view.rgb, np.full(view.rgb.shape[:2], depth), camera)
    grounded = {**blocks(camera, T1=RED), "A1": area("A1", px(camera, 0.53, 0.0))}
    report = gate(planned(blind, grounded, PickPlaceStep("G1", "T1", At("A1"))), blind)
    assert "action 1: heights: no depth at pick, place (valid: depth at every point)" in report.reasons


def test_depth_is_asked_for_where_something_is_touched() -> None:
    camera = affine_top()
    view = scene(camera, RED)
    depth = np.array(view.depth_m)
    u, v = px(camera, 0.53, 0.0)
    depth[int(v) - 12 : int(v) + 13, int(u) - 12 : int(u) + 13] = np.nan
    holed = View("top", "top", 0.0, view.rgb, depth, camera)
    grounded = {**blocks(camera, T1=RED), "A1": area("A1", (u, v))}
    report = gate(planned(holed, grounded, PickPlaceStep("G1", "T1", At("A1"))), holed)
    assert "action 1: heights: no depth at place (valid: depth at every point)" in report.reasons


def test_without_depth_heights_are_asked_for_only_where_they_must_be_measured() -> None:
    camera = affine_top()
    flat = scene(camera, RED, depth=False)
    grounded = {**blocks(camera, T1=replace(RED, height=0.0)), "A1": area("A1", px(camera, 0.53, 0.0))}
    plan = planned(flat, grounded, PickPlaceStep("G1", "T1", At("A1")))
    assert gate(plan, flat).admitted
    report = gate(plan, flat, measured_heights=True)
    assert report.reasons == (
        "action 1: heights: not measured: there is no depth (valid: depth at every point (--depth FILE))",
    )


def method(pick: Any, place: Any) -> tuple[PlannedAction, ...]:
    return (PlannedAction(PickPlaceStep("G1", "thing", At("there")), PickPlace(np.array(pick), np.array(place))),)


def test_a_method_without_a_plan_says_by_its_heights_what_it_touches() -> None:
    camera = affine_top()
    view = scene(camera, RED, BLUE)
    now = Observation({"top": view})
    red, blue = RED.top(), BLUE.top()

    def reasons(pick: Any, place: Any) -> set[str]:
        report = check_gate(method(pick, place), vocabulary=PICK_PLACE, limits=LIMITS, plan=None, then=now, now=now)
        return failed(report)

    assert reasons(red, blue) == set()
    assert reasons(red, (0.6, 0.3, 0.0)) == set()
    assert reasons(red, (*BLUE.centre, 0.0)) == {"place height"}
    assert reasons((*RED.centre, 0.0), (0.6, 0.3, 0.0)) == {"pick height"}
    assert reasons(red, (0.6, 0.3, 0.1)) == {"place height"}


@pytest.mark.parametrize(("apart", "refused"), [(0.045, {"place is free"}), (0.08, set())])
def test_without_a_plan_too_what_was_put_down_takes_its_room(apart: float, refused: set[str]) -> None:
    camera, plate = affine_top(), Block(0.55, -0.05, 0.70, 0.25, 0.02)
    now = Observation({"top": scene(camera, RED, BLUE_BESIDE, plate)})
    first = (0.62, 0.05, 0.02)
    actions = method(RED.top(), first) + method(BLUE_BESIDE.top(), (0.62, 0.05 + apart, 0.02))
    report = check_gate(actions, vocabulary=PICK_PLACE, limits=LIMITS, plan=None, then=now, now=now)
    assert failed(report) == refused


class Nudged:
    """A world in which a block slides to where the second action wants to put something, once the first has run."""

    vocabulary, limits, instruction = PICK_PLACE, LIMITS, Instruction("tidy up")

    def __init__(self, slides: bool) -> None:
        self.slides, self.ran = slides, 0

    def observe(self) -> Observation:
        moved = [replace(RED, x0=0.60, x1=0.66)] if self.ran else [RED]
        taken = self.slides and self.ran
        slid = Block(0.34, 0.30, 0.40, 0.36) if taken else Block(0.34, -0.12, 0.40, -0.06)
        return Observation({"top": scene(affine_top(), *moved, BLUE, slid)})

    def execute(self, action: PickPlace) -> StepReport:
        self.ran += 1
        return StepReport(action, True)

    def stop(self) -> None: ...

    def close(self) -> None: ...


class Twice:
    """Moves the red block away, then the blue one."""

    name = "twice"

    def decide(self, situation: Situation) -> Act | Done:
        if situation.executed or situation.refused is not None:
            return Done("done")
        camera = affine_top()
        grounded = {
            **blocks(camera, T1=RED, T2=BLUE),
            "A1": area("A1", px(camera, 0.63, -0.27)),
            "A2": area("A2", px(camera, 0.37, 0.33)),
        }
        view = situation.observation.main
        plan = planned(view, grounded, PickPlaceStep("G1", "T1", At("A1")), PickPlaceStep("G2", "T2", At("A2")))
        return Act(plan.actions, plan)


@pytest.mark.parametrize("slides", [False, True])
def test_a_place_is_looked_at_again_before_a_later_action(slides: bool) -> None:
    world = Nudged(slides)
    trial = rollout(Twice(), world)  # type: ignore[arg-type]
    assert world.ran == (1 if slides else 2)
    # The pictures are black, so only depth can tell.
    assert ("place is free" in trial.reason) is slides
