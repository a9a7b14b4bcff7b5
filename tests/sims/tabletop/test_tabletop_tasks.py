"""Every task: its words and pictures, its seeds, and an oracle that solves it."""

from __future__ import annotations

import re

import numpy as np
import pytest

from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop import make_world, partitions, task_names
from wonderful_team.sims.tabletop.bottles import BOTTLES
from wonderful_team.sims.tabletop.registering import filled, find_task
from wonderful_team.sims.tabletop.shapes import shape_names
from wonderful_team.sims.tabletop.textures import texture, texture_names

BUILT_IN = [name for name in task_names() if not name.startswith(("test/", "mine/"))]


HORIZONS = {
    **dict.fromkeys(("visual_manipulation", "scene_understanding", "rotate"), 5),
    **dict.fromkeys(("novel_adj", "novel_noun", "novel_adj_and_noun"), 5),
    **dict.fromkeys(("rearrange", "twist"), 7),
    **dict.fromkeys(("follow_motion", "follow_order", "same_texture", "same_shape"), 6),
    **dict.fromkeys(("manipulate_old_neighbor", "pick_in_order_then_restore"), 6),
    **{"rearrange_then_restore": 10, "sweep_without_exceeding": 10, "sweep_without_touching": 16},
}
"""VIMA-Bench's own step limits and the two more that its evaluation grants."""
COUNTS = {"L1": 13, "L2": 13, "L3": 12, "L4": 4}
ONLY_L4 = {"sweep_without_touching", "novel_adj_and_noun", "follow_motion", "same_texture"}


def test_horizons_are_those_of_vima_bench() -> None:
    assert len(HORIZONS) == 17
    for name, horizon in HORIZONS.items():
        world = make_world(name)
        assert world.horizon == horizon, name
        world.close()


def test_the_generalisation_levels_hold_as_many_tasks_as_in_vima_bench() -> None:
    at = {level: {name for name in HORIZONS if level in partitions(name)} for level in COUNTS}
    assert {level: len(names) for level, names in at.items()} == COUNTS
    assert at["L4"] == ONLY_L4
    assert at["L1"] - at["L3"] == {"sweep_without_exceeding"}
    assert not at["L1"] & ONLY_L4
    with pytest.raises(UnknownNameError, match=r"partition of same_texture 'L1'.*Known: L4"):
        make_world("same_texture", partition="L1")


def test_levels_split_shapes_and_textures() -> None:
    seen: dict[str, set[tuple[str, str, str]]] = {"L1": set(), "L2": set(), "L3": set()}
    for level, looks in seen.items():
        for seed in range(12):
            world = make_world(f"visual_manipulation@{level}", seed)
            assert world.partition == level
            things = world.privileged.truth()["things"].values()
            looks |= {(t["kind"], t["shape"], t["texture"]) for t in things}
            world.close()
    shapes = {level: {shape for _, shape, _ in looks} for level, looks in seen.items()}
    assert shapes["L3"] <= {"letter R", "diamond", "hexagon", "round", "star", "pallet", "pan"}
    assert not shapes["L3"] & (shapes["L1"] | shapes["L2"])
    worn = {level: {(kind, cover) for kind, _, cover in looks} for level, looks in seen.items()}
    assert not worn["L1"] & worn["L2"], "L2 swaps which textures are carried and which hold"


CARRIED = """block, L-shaped block, letter A, letter E, letter G, letter M, letter R, letter T, letter V, cross, diamond,
triangle, flower, heart, hexagon, pentagon, ring, round, star, shorter block"""
HOLDING = "pan, bowl, frame, square, container, pallet"
SWEPT = "three-sided rectangle, small block, line"
PLAIN = "blue, red, green, orange, yellow, purple, pink, cyan, olive"
IMAGES = "brick, tiles, wooden, granite, plastic, polka dot, checkerboard, tiger, magma, rainbow"


def _listed(*lists: str) -> list[str]:
    return [name for names in lists for name in names.replace("\n", " ").split(", ")]


def test_there_are_the_29_shapes_of_vima_bench_by_name() -> None:
    fruits = set(shape_names("fruit")) | {"paper", "price tag", "label", "cube", "plate", "box", "lid", *BOTTLES}
    assert sorted(set(shape_names()) - fruits) == sorted(_listed(CARRIED, HOLDING, SWEPT))
    assert len(_listed(CARRIED, HOLDING, SWEPT)) == 29


def test_there_are_the_82_textures_of_vima_bench_by_name() -> None:
    names = set(texture_names(dark=True))
    first = ("red", "yellow", "green", "blue", "purple")
    assert set(_listed(PLAIN, IMAGES)) <= names
    assert {f"dark {name}" for name in _listed(PLAIN) if name != "olive"} <= names
    for shade in ("", "dark "):
        for kind in ("stripe", "polka dot"):
            assert sum(name.startswith(shade) and f" and {c} {kind}" in name for name in names for c in first) >= 10
        assert {f"{shade}{colour} swirl" for colour in first} <= names
    assert {f"{colour} paisley" for colour in first} <= names
    assert (len(texture_names()), len(names)) == (49, 82)
    tiles = [texture(name) for name in names]
    assert len({tile.tobytes() for tile in tiles}) == 82, "no two look the same"
    assert all(tile.shape == (128, 128, 3) for tile in tiles)


WORDS = {
    "visual_manipulation": r"Put the {dragged_obj_1} into the {base_obj}\.",
    "scene_understanding": r"Put the [a-z ]+ object in {scene} into the [a-z ]+ object\.",
    "rotate": r"Rotate the {dragged_obj} (30|60|90|120|150) degrees\.",
    "rearrange": r"Rearrange to this {scene}\.",
    "rearrange_then_restore": r"Rearrange objects to this setup {scene} and then restore\.",
    "novel_adj": r"({demo_blicker_obj_(\d)} is (daxer|blicker|modier|kobar) than {demo_less_blicker_obj_\2}\. ){3}"
    r"Put the (less )?\3 {dragged_obj} into the {base_obj}\.",
    "novel_noun": r"(This is a (dax|blicket|wug|zup) {(dragged_obj_1|base_obj)}\. ){2}Put a \w+ into a \w+\.",
    "novel_adj_and_noun": r"(This is a (dax|blicket|wug|zup) {(dragged_obj|base_obj)}\. ){2}"
    r"({demo_blicker_obj_(\d)} is (\w+) than {demo_less_blicker_obj_\5}\. ){3}Put the (less )?\6 \w+ into the \w+\.",
    "twist": r'"Twist" is defined as rotating object a specific angle\. For examples: '
    r"(From {before_twist_(\d)} to {after_twist_\2}\. ){3}Now twist all [a-z ]+ objects\.",
    "follow_motion": r"Follow this motion for {dragged_obj}: {frame_0} {frame_1} {frame_2}\.",
    "follow_order": r"Stack objects in this order {frame_0} {frame_1} {frame_2}\.",
    "sweep_without_exceeding": r"Sweep (any|one|two|three|all) {swept_obj} into {bounds} without exceeding {constraint}\.",
    "sweep_without_touching": r"Sweep (any|one|two|three|all) {swept_obj} into {bounds} without touching {constraint}\.",
    "same_texture": r"Put all objects with the same texture as {base_obj} into it\.",
    "same_shape": r"Put all objects with the same profile as {base_obj} into it\.",
    "manipulate_old_neighbor": r"First put {dragged_obj} into {base_obj} then put the object that was previously at its "
    r"(north|south|west|east) into the same {base_obj}\.",
    "pick_in_order_then_restore": r"Put {dragged_obj} into {base_obj_1} then {base_obj_2}\. Finally restore it into its "
    r"original container\.",
}
COUNTS_OF_THINGS = {
    **dict.fromkeys(("visual_manipulation", "scene_understanding", "novel_adj", "novel_noun", "twist"), {3}),
    **dict.fromkeys(("rotate", "follow_motion"), {2}),
    **dict.fromkeys(("follow_order", "same_texture", "same_shape"), {4}),
    **dict.fromkeys(("rearrange", "rearrange_then_restore"), {2, 3}),
    **dict.fromkeys(("sweep_without_exceeding", "sweep_without_touching"), {4, 6, 8}),
    **{"novel_adj_and_noun": {5}, "manipulate_old_neighbor": {6}, "pick_in_order_then_restore": {7}},
}


@pytest.mark.parametrize("name", sorted(WORDS))
def test_words_slots_and_numbers_of_things_are_those_of_vima_bench(name: str) -> None:
    kinds = {"frame": "frame", "before": "before", "after_": "after", "scene": "scene"}
    for seed in range(6):
        scene = find_task(name).scene(seed)
        text = filled(find_task(name).instruction, scene.words)
        assert re.fullmatch(WORDS[name], text), text
        assert len(scene.things) in COUNTS_OF_THINGS[name]
        for slot, shown in scene.pictures.items():
            wanted = next((kind for start, kind in kinds.items() if slot.startswith(start)), "object")
            assert shown.kind == wanted, slot
            assert (shown.index is None) == (wanted in ("object", "scene"))


def test_new_words_are_defined_by_grey_shapes_and_adjectives_by_coloured_pairs() -> None:
    for name in ("novel_adj", "novel_noun", "novel_adj_and_noun"):
        scene = find_task(name).scene(2)
        looks = {prop.name: prop.texture for prop in scene.props}
        for slot, shown in scene.pictures.items():
            assert (looks[shown.thing] == "grey") == (not slot.startswith("demo")), slot


def test_six_like_containers_that_are_no_pans() -> None:
    for seed in range(20):
        things = find_task("pick_in_order_then_restore").scene(seed).things
        holders = [thing for thing in things if thing.body.kind == "base"]
        assert len(holders) == len({holder.texture for holder in holders}) == 6
        assert len({holder.shape for holder in holders} - {"pan"}) == 1


def test_same_profile_means_square_or_round() -> None:
    square, round_ = {"frame", "square", "container", "pallet"}, {"bowl", "pan"}
    for seed in range(20):
        scene = find_task("same_shape").scene(seed)
        base = next(thing.shape for thing in scene.things if thing.body.kind == "base")
        wanted = {thing.shape for thing in scene.things if thing.name in {goal.thing for goal in scene.goals}}
        assert wanted <= ({"shorter block"} if base in square else {"ring", "round"})
        assert base in square | round_


def test_frames_and_pairs_say_what_they_are() -> None:
    world = make_world("twist", 1)
    slots = world.instruction.slots
    assert [(s.kind, s.index) for s in slots.values()] == [(k, n) for n in (1, 2, 3) for k in ("before", "after")]
    assert not np.array_equal(slots["before_twist_1"].views["top"].rgb, slots["after_twist_1"].views["top"].rgb)
    world.close()
    motion = make_world("follow_motion", 1)
    frames = [slot for slot in motion.instruction.slots.values() if slot.kind == "frame"]
    assert [frame.index for frame in frames] == [0, 1, 2]
    assert np.array_equal(frames[0].views["top"].rgb, motion.observe().main.rgb)
    for action in motion.privileged.oracle():
        motion.execute(action)
    shown, now = frames[-1].views["front"].rgb.astype(int), motion.observe().views["front"].rgb
    assert np.abs(shown - now).mean() < 1.0, "the last frame shows what a right motion ends in"
    motion.close()


def test_taller_shows_only_from_the_front() -> None:
    for seed in range(30):
        world = make_world("novel_adj", seed)
        props = world.privileged.truth()["props"].values()
        if any(prop["stretch"] != 1.0 for prop in props):
            break
        world.close()
    one, two = (world.instruction.slots[f"demo_{w}blicker_obj_1"].views for w in ("", "less_"))
    apart = {camera: np.abs(one[camera].rgb.astype(int) - two[camera].rgb).mean() for camera in one}
    assert apart["front"] > 0.2
    assert apart["top"] < 0.1 * apart["front"]
    world.close()


def test_the_list_names_every_task_with_a_line_of_help() -> None:
    expected = set(HORIZONS)
    expected |= {f"fruit_placement/{variation}" for variation in ("all_match", "no_area", "misplaced", "both")}
    expected |= {f"superhero_companions/{variation}" for variation in ("exact", "similar", "two_coloured", "no_match")}
    expected |= {f"fruit_price_ranking/{variation}" for variation in ("three", "four", "discount", "deals")}
    assert expected <= set(BUILT_IN)
    assert all(len(task_names()[name]) > 20 for name in BUILT_IN)


@pytest.mark.parametrize("name", BUILT_IN)
@pytest.mark.parametrize("seed", [0, 1])
def test_the_oracle_solves_it_within_the_horizon(name: str, seed: int) -> None:
    world = make_world(name, seed)
    assert world.privileged.score().success is False
    actions = world.privileged.oracle()
    assert actions
    if world.vocabulary.kinds == ("pick_place",):
        for action in actions:
            assert world.execute(action).measured["held"]
    else:
        for _ in range(world.horizon):
            for action in world.privileged.oracle()[:1]:
                world.execute(action)
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
