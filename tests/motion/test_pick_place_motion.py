"""Pick and place: heights, centres, turns, sides, and things that were moved before."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, cameras, found, planar, scene
from wonderful_team.core.actions import At, Beside, OriginOf, PickPlace, PickPlaceStep, Place
from wonderful_team.core.values import GroundedTarget, PlannedAction, Target
from wonderful_team.errors import PlanError
from wonderful_team.motion import ground_actions

CAMERAS = cameras()
RED = Block(0.38, -0.2, 0.44, -0.1, 0.05)
PAN = Block(0.5, 0.05, 0.62, 0.2, 0.01)
EACH = pytest.mark.parametrize("name", CAMERAS)


def put(place: Place, rotate_deg: float = 0.0, pick: str = "T1") -> PickPlaceStep:
    return PickPlaceStep("G1", pick, place, rotate_deg)


def both(camera: Any, pick: tuple[float, float] = (0.5, 0.5)) -> dict[str, GroundedTarget]:
    return {
        "T1": found(camera, "T1", RED, {"pick": pick}),
        "T2": found(camera, "T2", PAN, {"place": (0.5, 0.5)}),
    }


def one(planned: tuple[PlannedAction, ...], number: int = 0) -> PickPlace:
    action = planned[number].action
    assert isinstance(action, PickPlace)
    return action


def carried(action: PickPlace, point: Any) -> np.ndarray:
    """Where a point (x, y) of the thing ends when a robot runs the action."""
    c, s = math.cos(action.yaw_rad), math.sin(action.yaw_rad)
    offset = np.array(point)[:2] - action.pick_m[:2]
    return action.place_m[:2] + np.array([[c, -s], [s, c]]) @ offset


@EACH
def test_picks_the_top_and_puts_on_the_surface(name: str) -> None:
    camera = CAMERAS[name]
    action = one(ground_actions([put(At("T2"))], both(camera), scene(camera, RED, PAN), LIMITS))
    assert action.pick_m == pytest.approx((0.41, -0.15, 0.05), abs=0.004)
    assert action.place_m == pytest.approx((0.56, 0.125, 0.01), abs=0.006)
    assert action.yaw_rad == 0.0


@settings(deadline=None, max_examples=40)
@given(st.floats(-360, 360), st.floats(0.1, 0.9), st.floats(0.1, 0.9))
def test_the_centre_lands_on_the_place_wherever_it_is_picked(rotate: float, across: float, along: float) -> None:
    camera = affine_top()
    targets = both(camera, (across, along))
    action = one(ground_actions([put(At("T2"), rotate)], targets, scene(camera, RED, PAN), LIMITS))
    assert carried(action, RED.centre) == pytest.approx(PAN.centre, abs=1e-3)
    assert action.yaw_rad == pytest.approx(-math.radians(rotate))


@EACH
def test_clockwise_is_clockwise_in_a_picture_from_above(name: str) -> None:
    camera = CAMERAS[name]
    action = one(ground_actions([put(OriginOf("T1"), 90.0)], both(camera), scene(camera, RED, PAN), LIMITS))
    assert action.yaw_rad == pytest.approx(-math.pi / 2)
    centre = np.array(camera.project([(*RED.centre, 0.05)])[0])
    right = camera.on_plane([centre + (6, 0)], 0.05)[0]
    after = np.array(camera.project([(*carried(action, right), 0.05)])[0]) - centre
    # What was right of the centre is below it after a quarter turn clockwise.
    assert after[1] > 3
    assert abs(after[0]) < 0.5 * after[1]


@settings(deadline=None, max_examples=30)
@given(st.floats(-180, 180), st.floats(0.1, 0.9))
def test_turning_in_place_turns_about_the_own_centre(rotate: float, along: float) -> None:
    camera = affine_top()
    for place in (OriginOf("T1"), At("T1")):
        action = one(ground_actions([put(place, rotate)], both(camera, (0.5, along)), scene(camera, RED, PAN), LIMITS))
        assert carried(action, RED.centre) == pytest.approx(RED.centre, abs=1e-3)
        assert action.place_m[2] == pytest.approx(0.0, abs=1e-6)


@EACH
@pytest.mark.parametrize("side", ["left", "right", "above", "below"])
def test_beside_is_on_that_side_in_the_picture_and_touches_nothing(name: str, side: Any) -> None:
    camera = CAMERAS[name]
    block = Block(0.46, -0.06, 0.54, 0.06, 0.04)
    small = Block(0.4, -0.16, 0.44, -0.12, 0.04)
    targets = {"T1": found(camera, "T1", small), "T2": found(camera, "T2", block, {})}
    planned = ground_actions([put(Beside("T2", side))], targets, scene(camera, small, block), LIMITS)
    place_px = planned[0].sources[1].point_px
    box, mine = targets["T2"].box, targets["T1"].box
    assert box is not None
    assert mine is not None
    expected = {
        "left": place_px[0] < box.x0 - mine.width / 2,
        "right": place_px[0] > box.x1 + mine.width / 2,
        "above": place_px[1] < box.y0 - mine.height / 2,
        "below": place_px[1] > box.y1 + mine.height / 2,
    }
    assert [direction for direction, holds in expected.items() if holds] == [side]
    assert one(planned).place_m[2] == pytest.approx(0.0, abs=0.003)
    seen = camera.project([one(planned).place_m])[0]
    assert seen == pytest.approx(place_px, abs=3.0)


def test_beside_leaves_room_for_a_turned_thing() -> None:
    camera = affine_top()
    view, targets = scene(camera, RED, PAN), both(camera)
    straight = ground_actions([put(Beside("T2", "left"))], targets, view, LIMITS)[0].sources[1].point_px
    turned = ground_actions([put(Beside("T2", "left"), 90.0)], targets, view, LIMITS)[0].sources[1].point_px
    # The block is 24 px wide and 14.4 px high in the picture.
    assert turned[0] - straight[0] == pytest.approx((24 - 14.4) / 2, abs=0.01)


def test_beside_without_room_says_so() -> None:
    camera = affine_top()
    edge = Block(0.45, -0.5, 0.55, -0.45)
    targets = {"T1": found(camera, "T1", RED), "T2": found(camera, "T2", edge, {})}
    with pytest.raises(PlanError, match=r"step 1: no room for T1 left of 'T2': 8 px .* 24 px are needed"):
        ground_actions([put(Beside("T2", "left"))], targets, scene(camera, RED, edge), LIMITS)


def test_put_and_restored() -> None:
    camera = affine_top()
    steps = [put(At("T2"), 30.0), put(OriginOf("T1"), -30.0)]
    planned = ground_actions(steps, both(camera, (0.3, 0.2)), scene(camera, RED, PAN), LIMITS)
    there, back = one(planned), one(planned, 1)
    assert back.pick_m[:2] == pytest.approx(there.place_m[:2])
    # It stands 0.05 m high on the pan's 0.01 m.
    assert back.pick_m[2] == pytest.approx(0.06, abs=1e-3)
    assert back.place_m == pytest.approx((*there.pick_m[:2], 0.0), abs=1e-3)
    assert "moved along by step 1" in planned[1].sources[0].how


def test_a_place_moves_with_the_thing_it_is_on() -> None:
    camera = affine_top()
    targets = both(camera) | {
        "T2": found(camera, "T2", PAN, {"pick": (0.5, 0.5), "place": (0.5, 0.5)}),
        "T3": area("T3", (60, 100)),
    }
    steps = [put(At("T3"), pick="T2"), put(At("T2"))]
    planned = ground_actions(steps, targets, scene(camera, RED, PAN), LIMITS)
    assert one(planned, 1).place_m[:2] == pytest.approx(one(planned, 0).place_m[:2], abs=1e-3)
    assert one(planned, 1).place_m[2] == pytest.approx(0.01, abs=1e-3)
    steps = [put(At("T3"), pick="T2"), put(Beside("T2", "right"))]
    beside = ground_actions(steps, targets, scene(camera, RED, PAN), LIMITS)[1].sources[1].point_px
    assert beside[0] > 60 + 18
    assert beside[1] == pytest.approx(100, abs=0.5)


@EACH
def test_every_number_has_a_source(name: str) -> None:
    camera = CAMERAS[name]
    planned = ground_actions([put(At("T2"), 45.0)], both(camera, (0.3, 0.3)), scene(camera, RED, PAN), LIMITS)
    action, (pick, place) = one(planned), planned[0].sources
    assert (pick.role, pick.target, place.role, place.target) == ("pick", "T1", "place", "T2")
    assert pick.position_m == pytest.approx(tuple(action.pick_m))
    assert place.position_m == pytest.approx(tuple(action.place_m))
    assert "depth 0." in pick.how
    assert "so that the centre of T1 lands there" in place.how
    assert "turned 45 degrees clockwise" in place.how


def test_without_a_camera_the_plan_is_in_pixels() -> None:
    camera = affine_top()
    planned = ground_actions([put(At("T2")), put(OriginOf("T1"))], both(camera), scene(None), LIMITS)
    assert [item.action for item in planned] == [None, None]
    assert planned[0].sources[0].point_px == both(camera)["T1"].points["pick"]
    assert planned[0].sources[1].position_m is None
    assert planned[1].sources[0].point_px == pytest.approx(both(camera)["T2"].points["place"])


@pytest.mark.parametrize("camera", [affine_top(), planar()], ids=["affine", "planar"])
def test_without_depth_everything_lies_on_the_table(camera: Any) -> None:
    action = one(ground_actions([put(At("T2"))], both(affine_top()), scene(camera, depth=False), LIMITS))
    assert action.pick_m == pytest.approx((*RED.centre, 0.0), abs=1e-3)
    assert action.place_m == pytest.approx((*PAN.centre, 0.0), abs=1e-3)


def test_what_is_missing_is_named() -> None:
    camera = affine_top()
    view, targets = scene(camera, RED, PAN), both(camera)
    absent = GroundedTarget(Target("T3", "object", "green mug"), "absent", "top")
    elsewhere = GroundedTarget(Target("T4", "object", "mug"), "found", "front", None, {"place": (1, 1)})
    outside = GroundedTarget(Target("T5", "object", "mug"), "found", "top", None, {"place": (300, 20)})
    targets |= {"T3": absent, "T4": elsewhere, "T5": outside}
    for place, says in (
        (At("T9"), "step 2: target 'T9' was not grounded; grounded targets: T1, T2, T3"),
        (At("T3"), r"step 2: target 'T3' \(green mug\) is not in the picture"),
        (At("T4"), "step 2: target 'T4' was found in view 'front', not in 'top'"),
        (At("T5"), r"step 2: the place point of 'T5' at \(300, 20\) px lies outside the view of 256 x 128 px"),
        (Beside("T5", "left"), "step 2: target 'T5' has no box"),
    ):
        with pytest.raises(PlanError, match=says):
            ground_actions([put(At("T2")), put(place)], targets, view, LIMITS)
    with pytest.raises(PlanError, match="target 'T2' has no point for pick or grasp; it has: place"):
        ground_actions([put(At("T1"), pick="T2")], targets, view, LIMITS)
