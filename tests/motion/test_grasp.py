"""Grips from the points that depth shows: turn, width, middle; and what is refused."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, area, found, looking_down, scene
from wonderful_team.core.actions import At, CloseStep, MoveStep, MoveTo, OpenStep, RotateGripperStep
from wonderful_team.core.values import Fingers, View
from wonderful_team.errors import GeometryError
from wonderful_team.motion import ground_actions
from wonderful_team.motion.grasp import Grip, grip_of

FINGERS = Fingers(0.085, 0.022, 0.022)
SIZE = (640, 400)
CAMERA = replace(looking_down(1.1), K=np.array([[780.0, 0, 320], [0, 780.0, 200], [0, 0, 1]]))


def view_of(*blocks: Block) -> View:
    return scene(CAMERA, *blocks, size=SIZE)


def gripped(view: View, block: Block, share: tuple[float, float] = (0.5, 0.5)) -> Grip:
    target = found(CAMERA, "T1", block, {"pick": share})
    assert target.box is not None
    return grip_of(view, target.box, target.points["pick"], 0.0, block.height / 2, FINGERS)


def turned_box(yaw_rad: float, half: tuple[float, float] = (0.06, 0.02), height: float = 0.04) -> tuple[View, Any]:
    """A box turned about its centre, and the pixels of its corners."""
    view = view_of()
    assert view.depth_m is not None
    columns, rows = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    on_top = CAMERA.on_plane(np.column_stack([columns.ravel(), rows.ravel()]), height)
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    away = (on_top[:, :2] - np.array([0.5, 0.05])) @ np.array([[c, -s], [s, c]])
    hit = (np.abs(away) <= np.array(half)).all(axis=1).reshape(rows.shape)
    depth = np.where(hit, view.depth_m - height, view.depth_m)
    corners = np.array([[a * half[0], b * half[1]] for a in (-1, 1) for b in (-1, 1)]) @ np.array([[c, s], [-s, c]])
    points = np.column_stack([corners + np.array([0.5, 0.05]), np.full(4, height)])
    return replace(view, depth_m=depth), CAMERA.project(points)


@pytest.mark.parametrize("degrees", [-60, -30, 0, 21, 45, 75])
def test_the_fingers_close_across_the_narrow_side(degrees: int) -> None:
    yaw = math.radians(degrees)
    view, corners = turned_box(yaw)
    box = type(found(CAMERA, "T", Block(0.4, 0, 0.5, 0.1)).box).bounding([(float(x), float(y)) for x, y in corners])  # type: ignore[union-attr]
    px = CAMERA.project([[0.5, 0.05, 0.04]])[0]
    grip = grip_of(view, box, (float(px[0]), float(px[1])), 0.0, 0.02, FINGERS)
    assert abs(math.remainder(grip.yaw_rad - yaw, math.pi)) < math.radians(4)
    assert grip.width_m == pytest.approx(0.04, abs=0.003)
    assert grip.centre_m == pytest.approx((0.5, 0.05), abs=0.002)


def test_a_point_beside_the_middle_still_grips_with_both_fingers_at_once() -> None:
    block = Block(0.45, 0.0, 0.57, 0.05)
    grip = gripped(view_of(block), block, (0.5, 0.2))
    assert grip.centre_m == pytest.approx((0.51, 0.025), abs=0.002)


def test_a_neighbour_turns_the_gripper_and_two_refuse_it() -> None:
    cube, beside = Block(0.45, 0.0, 0.495, 0.045), Block(0.44, 0.06, 0.5, 0.12)
    free, crowded = gripped(view_of(cube), cube), gripped(view_of(cube, beside), cube)
    # Alone the fingers close along y, where the neighbour stands; then they close along x.
    assert abs(free.yaw_rad) < 0.1
    assert abs(abs(crowded.yaw_rad) - math.pi / 2) < 0.1
    walls = [Block(0.40, -0.06, 0.435, 0.11), Block(0.51, -0.06, 0.55, 0.11), beside, Block(0.44, -0.08, 0.5, -0.015)]
    with pytest.raises(GeometryError, match="other things stand where a finger would go"):
        gripped(view_of(cube, *walls), cube)


def test_what_is_too_wide_is_refused_with_its_width() -> None:
    wide = Block(0.4, 0.0, 0.5, 0.1)
    with pytest.raises(GeometryError, match=r"it is (9[89]|10[012]) mm wide across its narrowest side \(limit 80 mm\)"):
        gripped(view_of(wide), wide)


def test_depth_in_doubt_is_refused_never_guessed() -> None:
    block = Block(0.45, 0.0, 0.495, 0.045)
    view = view_of(block)
    box = found(CAMERA, "T1", block).box
    assert box is not None
    assert view.depth_m is not None
    holes = view.depth_m.copy()
    holes[int(box.y0) : int(box.y1) + 1, int(box.x0) : int(box.x1) + 1] = np.nan
    with pytest.raises(GeometryError, match="depth is in doubt: 100 % of the middle of its box has none"):
        gripped(replace(view, depth_m=holes), block)
    with pytest.raises(GeometryError, match="spread over"):
        gripped(view, block, (0.0, 0.5))
    with pytest.raises(GeometryError, match="there is no depth"):
        gripped(replace(view, depth_m=None), block)
    with pytest.raises(GeometryError, match="nothing for the fingers to close on"):
        gripped(view_of(), block)


def test_noise_of_a_sensor_leaves_the_grip_as_it_is() -> None:
    block = Block(0.45, 0.0, 0.495, 0.045)
    view = view_of(block)
    assert view.depth_m is not None
    noisy = view.depth_m + np.random.default_rng(1).normal(0, 0.002, view.depth_m.shape)
    plain, grip = gripped(view, block), gripped(replace(view, depth_m=noisy), block)
    assert grip.width_m == pytest.approx(plain.width_m, abs=0.004)
    assert grip.centre_m == pytest.approx(plain.centre_m, abs=0.003)


def test_moves_that_grip_carry_the_turn_and_say_where_it_comes_from() -> None:
    block = Block(0.45, 0.0, 0.495, 0.09)
    goal = Block(0.6, -0.15, 0.65, -0.1)
    limits = replace(LIMITS, fingers=FINGERS)
    grounded = {"T1": found(CAMERA, "T1", block), "T2": found(CAMERA, "T2", goal, {"place": (0.5, 0.5)})}
    steps = (
        MoveStep("G1", At("T1"), "above"),
        MoveStep("G1", At("T1"), "at"),
        CloseStep("G1"),
        RotateGripperStep("G1", 30.0),
        MoveStep("G1", At("T2"), "at"),
    )
    planned = ground_actions(steps, grounded, view_of(block, goal), limits)
    poses = [action.action.pose for action in planned if isinstance(action.action, MoveTo)]
    assert abs(abs(poses[0].yaw_rad) - math.pi / 2) < 0.1
    assert poses[1].yaw_rad == pytest.approx(poses[0].yaw_rad)
    assert math.remainder(poses[2].yaw_rad - poses[1].yaw_rad, 2 * math.pi) == pytest.approx(-math.radians(30))
    assert re.search(
        r"gripped across 4[456] mm, turned \d+ degrees clockwise, by \d+ points", planned[0].sources[0].how
    )
    # A world that says nothing of its fingers is sent the moves as before.
    plain = ground_actions(steps[:2], grounded, view_of(block, goal), LIMITS)
    assert isinstance(plain[0].action, MoveTo)
    assert plain[0].action.pose.yaw_rad == 0.0


def test_what_cannot_be_gripped_names_step_and_target() -> None:
    wide = Block(0.4, 0.0, 0.5, 0.1)
    with pytest.raises(GeometryError, match="step 1: T1 cannot be gripped: it is"):
        ground_actions(
            (MoveStep("G1", At("T1"), "above"),),
            {"T1": found(CAMERA, "T1", wide)},
            view_of(wide),
            replace(LIMITS, fingers=FINGERS),
        )


def test_a_gripper_that_does_not_turn_is_never_turned_and_refuses_what_it_would_have_to_turn_for() -> None:
    fixed = replace(FINGERS, turns=False)
    across, along = Block(0.42, 0.03, 0.58, 0.07), Block(0.48, -0.05, 0.52, 0.15)
    for block in (across, along):
        target = found(CAMERA, "T1", block, {"pick": (0.5, 0.5)})
        assert target.box is not None
        view, at = view_of(block), (target.box, target.points["pick"], 0.0, block.height / 2)
        if block is across:
            grip = grip_of(view, *at, fixed)
            assert grip.yaw_rad == 0.0
            assert grip.width_m == pytest.approx(0.04, abs=0.003)
        else:
            assert abs(grip_of(view, *at, FINGERS).yaw_rad) == pytest.approx(math.pi / 2, abs=0.06)
            with pytest.raises(
                GeometryError, match=r"\d{3} mm wide where the fingers close, and the gripper does not turn"
            ):
                grip_of(view, *at, fixed)
    neighbour = Block(0.42, 0.078, 0.58, 0.11)
    target = found(CAMERA, "T1", across, {"pick": (0.5, 0.5)})
    assert target.box is not None
    with pytest.raises(
        GeometryError, match="other things stand where a finger would go, and the gripper does not turn"
    ):
        grip_of(view_of(across, neighbour), target.box, target.points["pick"], 0.0, 0.025, fixed)


@pytest.mark.parametrize("plate", [0.004, 0.008, 0.015])
def test_a_lid_is_gripped_by_its_handle_and_over_its_plate(plate: float) -> None:
    lid, handle = Block(0.42, -0.08, 0.58, 0.08, plate), Block(0.49, -0.03, 0.51, 0.03, plate + 0.025)
    view = view_of(lid, handle)
    target, px = found(CAMERA, "T1", lid, {"pick": (0.5, 0.5)}), CAMERA.project([[0.5, 0.0, plate + 0.025]])[0]
    target = replace(target, points={"pick": (float(px[0]), float(px[1]))})
    grip = grip_of(view, target.box, target.points["pick"], 0.0, (plate + 0.025) / 2, FINGERS)  # type: ignore[arg-type]
    assert grip.width_m == pytest.approx(0.02, abs=0.004)
    assert grip.centre_m == pytest.approx((0.5, 0.0), abs=0.003)
    assert abs(abs(grip.yaw_rad) - math.pi / 2) < 0.1
    # The fingers stay over the plate: half way down the handle, not half way down the whole.
    step = MoveStep("G1", At("T1"), "at")
    (planned,) = ground_actions((step,), {"T1": target}, view, replace(LIMITS, fingers=FINGERS))
    assert isinstance(planned.action, MoveTo)
    assert planned.action.pose.position_m[2] - 0.009 > plate


def test_the_fingers_keep_off_what_the_plan_has_put_beside_a_thing_and_come_where_it_has_made_room() -> None:
    cube, slab = Block(0.45, 0.0, 0.495, 0.045), Block(0.44, -0.25, 0.5, -0.19, 0.04)
    view, limits = view_of(cube, slab), replace(LIMITS, fingers=FINGERS)
    grounded = {
        "T1": found(CAMERA, "T1", cube),
        "T2": found(CAMERA, "T2", slab),
        "A1": area("A1", tuple(float(v) for v in CAMERA.project([(0.4725, 0.095, 0.0)])[0])),  # type: ignore[arg-type]
    }
    moved = (MoveStep("G1", At("T2"), "at"), CloseStep("G1"), MoveStep("G1", At("A1"), "at"), OpenStep("G1"))

    def yaw(*steps: object) -> float:
        (*_, last) = ground_actions((*steps, MoveStep("G2", At("T1"), "at")), grounded, view, limits)  # type: ignore[arg-type]
        assert isinstance(last.action, MoveTo)
        return last.action.pose.yaw_rad

    assert abs(yaw()) < 0.1
    assert abs(abs(yaw(*moved)) - math.pi / 2) < 0.1
    # The other way round: walls that the plan has taken away do not count any more.
    grounded["T2"] = found(CAMERA, "T2", slab := Block(0.44, 0.06, 0.5, 0.12, 0.04))
    grounded["A1"] = area("A1", tuple(float(v) for v in CAMERA.project([(0.6, -0.3, 0.0)])[0]))  # type: ignore[arg-type]
    view = view_of(cube, slab)
    assert abs(abs(yaw()) - math.pi / 2) < 0.1
    assert abs(yaw(*moved)) < 0.1
