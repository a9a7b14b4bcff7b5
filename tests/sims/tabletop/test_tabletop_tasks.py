"""Every task: its words and pictures, its seeds, and an oracle that solves it."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop import make_world, task_names

BUILT_IN = [name for name in task_names() if not name.startswith(("test/", "mine/"))]


def test_the_list_names_every_task_with_a_line_of_help() -> None:
    expected = {"visual_manipulation", "scene_understanding", "rotate"}
    expected |= {f"fruit_placement/{variation}" for variation in ("all_match", "no_area", "misplaced", "both")}
    assert expected <= set(BUILT_IN)
    assert all(len(task_names()[name]) > 20 for name in BUILT_IN)


@pytest.mark.parametrize("name", BUILT_IN)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_oracle_solves_it_within_the_horizon(name: str, seed: int) -> None:
    world = make_world(name, seed)
    assert world.privileged.score().success is False
    actions = world.privileged.oracle()
    assert 1 <= len(actions) <= world.horizon
    for action in actions:
        assert world.execute(action).measured["held"]
    score = world.privileged.score()
    assert (score.success, score.stage) == (True, None)
    world.close()


def test_slots_show_both_views_and_words_are_filled_in() -> None:
    world = make_world("tabletop/visual_manipulation", 3)
    assert world.instruction.text == "Put the {dragged_obj_1} into the {base_obj}."
    for slot in world.instruction.slots.values():
        assert slot.kind == "object"
        assert list(slot.views) == ["top", "front"]
        for view in slot.views.values():
            assert (view.rgb[0, 0] == 255).all()
            assert 0.001 < (view.rgb != 255).any(axis=2).mean() < 0.2
            assert view.depth_m is None
            assert view.camera is None
    world.close()
    shown = make_world("scene_understanding", 1)
    slot = shown.instruction.slots["scene"]
    assert slot.kind == "scene"
    assert np.array_equal(slot.views["top"].rgb, shown.observe().main.rgb)
    assert "texture}" not in shown.instruction.text
    shown.close()


def test_a_slot_shows_the_right_thing() -> None:
    world = make_world("rotate", 4)
    name = world.privileged.truth()["slots"]["dragged_obj"]
    on_table = world.observe().main.rgb[world.privileged.mask(name)].mean(axis=0)
    shown = world.instruction.slots["dragged_obj"].views["top"].rgb
    assert np.abs(shown[(shown < 250).any(axis=2)].mean(axis=0) - on_table).max() < 12
    world.close()


def test_the_same_seed_gives_the_same_pixels_and_another_seed_does_not() -> None:
    hashes = []
    for seed in (5, 5, 6):
        world = make_world("visual_manipulation", seed)
        slots = [view.hash for slot in world.instruction.slots.values() for view in slot.views.values()]
        hashes.append((world.observe().hash, *slots))
        world.close()
    assert hashes[0] == hashes[1]
    assert hashes[0] != hashes[2]


@pytest.mark.parametrize("name", ["visual_manipulation", "fruit_placement/all_match"])
def test_recolour_repaints_the_same_scene(name: str) -> None:
    plain, other = make_world(name, 2), make_world(name, 2, recolour=11)
    here, there = plain.privileged.truth()["things"], other.privileged.truth()["things"]
    assert [t["position_m"] for t in here.values()] == [t["position_m"] for t in there.values()]
    assert [t["shape"] for t in here.values()] == [t["shape"] for t in there.values()]
    assert [t["texture"] for t in here.values()] != [t["texture"] for t in there.values()]
    for action in other.privileged.oracle():
        other.execute(action)
    assert other.privileged.score().success
    plain.close()
    other.close()


def test_things_start_apart_and_on_the_table() -> None:
    for seed in range(6):
        world = make_world("fruit_placement/both", seed)
        things = world.privileged.truth()["things"]
        papers = [thing for thing in things.values() if thing["kind"] == "area"]
        assert len(papers) == 3
        for thing in things.values():
            x, y, z = thing["position_m"]
            assert 0.25 < x < 0.75
            assert -0.5 < y < 0.5
            assert -0.001 < z < 0.01
        world.close()


def test_an_unknown_task_lists_the_known_ones() -> None:
    with pytest.raises(
        UnknownNameError, match=r"unknown task 'rotat'. Did you mean 'rotate'\? Known: .*scene_understanding"
    ):
        make_world("rotat")
