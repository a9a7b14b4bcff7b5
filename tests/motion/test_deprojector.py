"""Pixels become metres and come back."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.motion.block_scenes import SIZE, Block, affine_top, cameras, planar, scene
from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.values import View
from wonderful_team.images.relief import Relief
from wonderful_team.motion.deprojector import Deprojector

CAMERAS = cameras()
BLOCK = Block(0.4, -0.1, 0.5, 0.1, 0.06)
VIEWS = {name: scene(camera, BLOCK) for name, camera in CAMERAS.items()}


@settings(deadline=None, max_examples=60)
@given(st.sampled_from(sorted(CAMERAS)), st.floats(0, SIZE[0]), st.floats(0, SIZE[1]))
def test_px_to_metres_and_back(name: str, x: float, y: float) -> None:
    lift = Deprojector(VIEWS[name])
    for spot in (lift.surface((x, y), "p"), lift.at_height((x, y), 0.03, "p")):
        assert lift.to_px(spot.position_m) == pytest.approx((x, y), abs=1e-6)


@pytest.mark.parametrize("name", CAMERAS)
def test_surface_is_the_top_of_what_is_seen(name: str) -> None:
    camera, lift = CAMERAS[name], Deprojector(VIEWS[name])
    x, y = camera.project([BLOCK.top()])[0]
    assert lift.surface((x, y), "p").position_m == pytest.approx(BLOCK.top(), abs=0.003)
    x, y = camera.project([(0.6, 0.05, 0.0)])[0]
    assert lift.surface((x, y), "p").position_m == pytest.approx((0.6, 0.05, 0.0), abs=0.003)


def with_depth(view: View, depth: Any) -> View:
    return View(view.id, view.camera_name, 0.0, view.rgb, depth, view.camera)


def test_missing_and_wild_depths_do_not_decide() -> None:
    view = VIEWS["affine"]
    px = tuple(affine_top().project([BLOCK.top()])[0])
    depth = np.array(view.depth_m)
    row, column = int(px[1]), int(px[0])
    depth[row, column] = np.nan
    depth[row + 1, column] = 0.1
    assert Deprojector(with_depth(view, depth)).surface(px, "p").position_m[2] == pytest.approx(0.06, abs=1e-6)
    depth[row - 2 : row + 3, column - 2 : column + 3] = np.nan
    assert Deprojector(with_depth(view, depth)).surface(px, "p").position_m[2] == pytest.approx(0.06, abs=1e-6)
    spot = Deprojector(with_depth(view, np.full_like(depth, np.nan))).surface(px, "p")
    assert spot.position_m[2] == 0.0
    assert "table plane (no depth there)" in spot.how


def test_depth_at_the_very_edge_of_the_view() -> None:
    lift = Deprojector(VIEWS["affine"])
    for corner in ((0.0, 0.0), (256.0, 128.0), (256.0, 0.0)):
        assert lift.surface(corner, "p").position_m[2] == pytest.approx(0.0, abs=1e-6)


def test_planar_camera_knows_the_table_only() -> None:
    lift = Deprojector(scene(planar()))
    spot = lift.surface((128, 64), "p")
    assert spot.position_m == pytest.approx((0.5, 0.0, 0.0), abs=1e-6)
    assert lift.support_z_m(Box(10, 10, 20, 20)) == 0.0


def test_without_a_camera_there_are_pixels_only() -> None:
    spot = Deprojector(scene(None)).surface((5, 6), "p")
    assert (spot.px, spot.position_m) == ((5, 6), None)
    assert "no camera" in spot.how


@pytest.mark.parametrize("name", CAMERAS)
def test_support_is_measured_round_a_box_despite_a_neighbour(name: str) -> None:
    camera = CAMERAS[name]
    plate, cup = Block(0.4, -0.15, 0.6, 0.05, 0.02), Block(0.47, -0.08, 0.53, -0.02, 0.08)
    neighbour = Block(0.47, -0.01, 0.53, 0.04, 0.12)
    lift = Deprojector(scene(camera, plate, cup, neighbour))
    box = Box.bounding([tuple(p) for p in camera.project([cup.top(a, b) for a in (0, 1) for b in (0, 1)])])
    # Tilted cameras see a little of what lies behind the cup.
    assert lift.support_z_m(box) == pytest.approx(0.02, abs=0.002)


@pytest.mark.parametrize("name", ["affine", "pinhole"])
def test_a_thing_in_a_bowl_stands_on_the_floor_of_the_bowl_and_not_on_its_rim(name: str) -> None:
    """A letter whose box touches the rim all round: what is higher than the thing itself does not support it."""
    camera = CAMERAS[name]
    rim = [Block(0.35, -0.15, 0.41, 0.15, 0.08), Block(0.59, -0.15, 0.65, 0.15, 0.08)]
    rim += [Block(0.35, -0.15, 0.65, -0.09, 0.08), Block(0.35, 0.09, 0.65, 0.15, 0.08)]
    floor = Block(0.4, -0.1, 0.6, 0.1, 0.005)
    thing = [Block(0.42, -0.08, 0.58, -0.04, 0.04), Block(0.42, 0.04, 0.58, 0.08, 0.04)]
    lift = Deprojector(scene(camera, floor, *rim, *thing))
    corners = [(x, y, 0.04) for x in (0.42, 0.58) for y in (-0.08, 0.08)]
    box = Box.bounding([(float(u), float(v)) for u, v in camera.project(corners)])
    close = box.grown(3, 3, 3, 3)
    assert lift.support_z_m(close) > 0.04
    assert lift.support_z_m(close, 0.04) == pytest.approx(0.005, abs=0.002)


def test_noise_just_below_the_table_is_the_table_and_the_floor_beside_it_is_not() -> None:
    view = scene(affine_top())
    low = with_depth(view, np.asarray(view.depth_m) + 0.004)
    spot = Deprojector(low).surface((100, 60), "p")
    assert spot.position_m[2] == 0.0
    assert spot.how.endswith("on the table")
    floor = Deprojector(with_depth(view, np.asarray(view.depth_m) + 0.3))
    assert floor.surface((100, 60), "p").position_m[2] == pytest.approx(-0.3, abs=1e-6)


def test_the_floor_beside_the_table_supports_nothing() -> None:
    block = Block(0.45, 0.42, 0.55, 0.499, 0.05)
    view = scene(affine_top(), block)
    depth = np.array(view.depth_m)
    depth[:, 248:] = 1.05
    box = Box.bounding([tuple(p) for p in affine_top().project([block.top(a, b) for a in (0, 1) for b in (0, 1)])])
    assert Deprojector(with_depth(view, depth)).support_z_m(box) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("turned_deg", [0.0, 8.0, -12.0])
def test_what_lies_askew_on_a_larger_thing_stands_on_that_and_not_on_the_table(turned_deg: float) -> None:
    camera = AffineCamera(np.array([[0, 800.0, 0, 320], [800.0, 0, 0, -200], [0, 0, -1.0, 1.0]]))
    depth = np.full((400, 640), 1.0, np.float32)
    for half_px, height_m in ((75.0, 0.055), (54.0, 0.063)):
        corners = cv2.boxPoints(((300.0, 200.0), (2 * half_px, 2 * half_px), turned_deg))
        cv2.fillPoly(depth, [np.round(corners).astype(np.int32)], 1.0 - height_m)
    view = View("top", "top", 0.0, np.zeros((400, 640, 3), np.uint8), depth_m=depth, camera=camera)
    lid = Box.bounding([tuple(map(float, corner)) for corner in corners])
    assert Deprojector(view).support_z_m(lid, 0.065) == pytest.approx(0.055, abs=1e-3)
    relief = Relief.of(view)
    assert relief is not None
    assert relief.all_round(lid) == pytest.approx(0.055, abs=1e-3)
