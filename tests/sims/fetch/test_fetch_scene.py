"""The scenes: what stands where, what is asked, and the model that the simulator is given."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from wonderful_team.sims.fetch import finding
from wonderful_team.sims.fetch.cameras import lenses
from wonderful_team.sims.fetch.scene import FINGERS_M, STAND_M, body_name, model_xml, room_for_lid, set_table
from wonderful_team.sims.fetch.things import BOX, BOX_INSIDE_M, KINDS, LID_M
from wonderful_team.sims.fetch.world import FINGERS

SEEDS = range(1000, 1012)


def test_a_seed_is_a_scene() -> None:
    assert set_table(7, 1) == set_table(7, 1) != set_table(8, 1)


@pytest.mark.parametrize("count", [1, 2])
def test_four_things_of_different_heights_stand_apart_and_the_words_never_name_the_lid(count: int) -> None:
    for seed in SEEDS:
        scene = set_table(seed, count)
        objects = {name: one for name, one in scene.things.items() if name in KINDS}
        assert len(objects) == 4
        assert len({one.kind.height_m for one in objects.values()}) == 4
        assert len(scene.wanted) == count
        assert "lid" not in scene.words.lower()
        for name, one in objects.items():
            assert STAND_M[0][0] <= one.x_m <= STAND_M[1][0]
            fingers = one.footprint((0.0, FINGERS_M[1] - one.kind.half_m[1] - 0.02))
            others = [other.footprint() for key, other in scene.things.items() if key != name]
            assert not any(fingers.intersects(other) for other in others), (seed, name)
        rightmost = max(objects, key=lambda name: objects[name].y_m)
        if "rightmost" in scene.words:
            assert rightmost in scene.wanted
        else:
            assert scene.things[scene.wanted[0]].kind.words in scene.words


def test_the_lid_finds_free_table_beside_its_box() -> None:
    for seed in SEEDS:
        scene = set_table(seed, 1)
        lid = scene.things["lid"]
        others = {name: one.footprint() for name, one in scene.things.items() if name != "lid"}
        free = room_for_lid(others, (lid.x_m, lid.y_m))
        assert free is not None
        there = type(lid)("lid", lid.kind, *free, 0.0).footprint()
        assert not any(there.intersects(other) for other in others.values())


def test_everything_fits_between_the_fingers_and_into_the_box() -> None:
    for kind in KINDS.values():
        assert 2 * kind.half_m[1] + 0.02 < FINGERS.opening_m
        assert 2 * max(kind.half_m) < min(BOX_INSIDE_M)
    assert LID_M[0] > 2 * BOX.half_m[0] - 0.001
    assert 2 * BOX.half_m[1] > FINGERS.opening_m


def test_the_model_includes_the_packages_own_files_and_keeps_the_names_that_its_code_asks_for() -> None:
    scene = set_table(1000, 2)
    tree = ElementTree.fromstring(model_xml(scene, lenses(), "/somewhere/assets"))
    assert [one.get("file") for one in tree.iter("include")] == [
        "/somewhere/assets/fetch/shared.xml",
        "/somewhere/assets/fetch/robot.xml",
    ]
    bodies = {one.get("name") for one in tree.iter("body")}
    assert {"object0", "object1", "object2", "object3", "box", "lid"} <= bodies
    assert {body_name(scene, name) for name in scene.things} <= bodies
    assert "object0:joint" in {one.get("name") for one in tree.iter("joint")}
    assert {"object0", "target0"} <= {one.get("name") for one in tree.iter("site")}
    assert {one.get("name") for one in tree.iter("position")} == {
        "robot0:l_gripper_finger_joint",
        "robot0:r_gripper_finger_joint",
    }
    assert {one.get("name") for one in tree.iter("camera")} == {"top", "front"}


def test_nothing_of_the_package_lies_in_ours() -> None:
    ours = Path(finding.__file__).parent
    assert {path.suffix for path in ours.rglob("*") if path.is_file() and "__pycache__" not in path.parts} == {".py"}
