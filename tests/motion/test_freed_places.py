"""Heights where a picture shows a thing that will have left, or a thing stands inside of another."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, aslant_in_a_bowl, found, looking_down, scene
from wonderful_team.core.actions import At, OriginOf, PickPlace, PickPlaceStep
from wonderful_team.motion import ground_actions

CAMERAS = {"affine": affine_top(), "pinhole": looking_down()}
FLOOR_M, RIM_M = 0.002, 0.03
RIM = [
    Block(0.40, 0.05, 0.46, 0.20, RIM_M),
    Block(0.54, 0.05, 0.60, 0.20, RIM_M),
    Block(0.40, 0.05, 0.60, 0.09, RIM_M),
    Block(0.40, 0.16, 0.60, 0.20, RIM_M),
]


@pytest.mark.parametrize("name", CAMERAS)
def test_a_thing_lower_than_the_rim_round_it_is_put_down_on_the_table_and_brought_back(name: str) -> None:
    """The floor shows between its bars. Were the rim taken for its support, it would have to go below the table, which the gate refuses."""
    camera = CAMERAS[name]
    thing = Block(0.465, 0.095, 0.535, 0.155, 0.012)
    bars = [replace(thing, x1=0.485), replace(thing, x0=0.515)]
    view = scene(camera, Block(0.40, 0.05, 0.60, 0.20, FLOOR_M), *RIM, *bars)
    u, v = camera.project([(0.5, -0.3, 0.0)])[0]
    grounded = {"T1": found(camera, "T1", thing, {"pick": (0.15, 0.5)}), "A1": area("A1", (float(u), float(v)))}
    steps = (PickPlaceStep("G1", "T1", At("A1")), PickPlaceStep("G2", "T1", OriginOf("T1")))
    there, back = (planned.action for planned in ground_actions(steps, grounded, view, LIMITS))
    assert isinstance(there, PickPlace)
    assert isinstance(back, PickPlace)
    assert there.place_m[2] == pytest.approx(0.0, abs=1e-6)
    assert back.pick_m[2] == pytest.approx(0.012 - FLOOR_M, abs=0.003)
    assert back.place_m[2] == pytest.approx(FLOOR_M, abs=0.003)
    assert min(float(point[2]) for action in (there, back) for point in (action.pick_m, action.place_m)) >= 0.0


@pytest.mark.parametrize("boxed", [True, False])
@pytest.mark.parametrize("name", CAMERAS)
def test_a_place_that_was_left_has_the_height_of_what_was_under_it(name: str, boxed: bool) -> None:
    """Known from boxes, and from one surface in the depth where a method gave points alone."""
    camera = CAMERAS[name]
    one, other = Block(0.40, -0.30, 0.46, -0.24, 0.05), Block(0.50, 0.10, 0.56, 0.16, 0.04)
    view = scene(camera, one, other)
    (u, v), (a, b) = camera.project([other.top(), (0.35, 0.3, 0.0)])
    grounded = {
        "T1": found(camera, "T1", one),
        "T2": found(camera, "T2", other),
        "A1": area("A1", (float(u), float(v))),
        "A2": area("A2", (float(a), float(b))),
    }
    if not boxed:
        grounded = {key: replace(item, box=None) for key, item in grounded.items()}
    steps = (PickPlaceStep("G1", "T2", At("A2")), PickPlaceStep("G2", "T1", At("A1")))
    last = ground_actions(steps, grounded, view, LIMITS)[1]
    assert isinstance(last.action, PickPlace)
    assert last.action.place_m[2] == pytest.approx(0.0, abs=0.002)
    assert "T2 has left it" in last.sources[1].how


def test_without_boxes_what_stands_apart_from_what_leaves_keeps_its_height() -> None:
    """Two blocks of one height beside each other: the table between them is no part of their tops."""
    camera = CAMERAS["pinhole"]
    blocks = [Block(0.40, y, 0.46, y + 0.06, 0.05) for y in (-0.30, -0.10, 0.10)]
    u, v = camera.project([(0.35, 0.3, 0.0)])[0]
    targets = {
        **{f"T{k}": found(camera, f"T{k}", block) for k, block in enumerate(blocks, start=1)},
        "A1": area("A1", (float(u), float(v))),
    }
    grounded = {key: replace(item, box=None) for key, item in targets.items()}
    steps = (PickPlaceStep("G1", "T2", At("A1")), PickPlaceStep("G2", "T3", At("T1")))
    last = ground_actions(steps, grounded, scene(camera, *blocks), LIMITS)[1]
    assert isinstance(last.action, PickPlace)
    assert last.action.place_m[2] == pytest.approx(0.05, abs=0.003)


@pytest.mark.parametrize("boxed", [True, False])
@pytest.mark.parametrize("name", CAMERAS)
def test_a_thing_that_lies_aslant_in_its_bowl_comes_back_onto_the_floor(name: str, boxed: bool) -> None:
    """Where its bowl is pointed at the picture shows the thing itself, higher than where it is held: no height to let go of it at."""
    view, grounded = aslant_in_a_bowl(CAMERAS[name])
    if not boxed:
        grounded = {key: replace(item, box=None) for key, item in grounded.items()}
    steps = (PickPlaceStep("G1", "T1", At("A1")), PickPlaceStep("G2", "T1", At("T2")))
    back = ground_actions(steps, grounded, view, LIMITS)[1]
    assert isinstance(back.action, PickPlace)
    assert back.action.place_m[2] == pytest.approx(0.002 if boxed else 0.0, abs=0.003)
    assert "T1 has left it" in back.sources[1].how


@pytest.mark.parametrize("name", CAMERAS)
def test_a_higher_neighbour_in_the_box_of_what_leaves_keeps_its_height(name: str) -> None:
    """A box reaches over what stands beside a thing: that does not leave with it, and a thing is put onto it, not through it."""
    camera = CAMERAS[name]
    low, high = Block(0.40, -0.30, 0.46, -0.24, 0.04), Block(0.40, -0.24, 0.46, -0.18, 0.055)
    other = Block(0.50, 0.10, 0.56, 0.16, 0.04)
    u, v = camera.project([(0.35, 0.3, 0.0)])[0]
    both = found(camera, "T1", replace(low, y1=high.y1), {"pick": (0.5, 0.2)})
    grounded = {
        "T1": both,
        "T2": found(camera, "T2", high),
        "T3": found(camera, "T3", other),
        "A1": area("A1", (float(u), float(v))),
    }
    steps = (PickPlaceStep("G1", "T1", At("A1")), PickPlaceStep("G2", "T3", At("T2")))
    last = ground_actions(steps, grounded, scene(camera, low, high, other), LIMITS)[1]
    assert isinstance(last.action, PickPlace)
    assert last.action.place_m[2] == pytest.approx(0.055, abs=0.002)
