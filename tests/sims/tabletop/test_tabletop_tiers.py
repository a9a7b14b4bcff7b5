"""Harder scenes: clutter, light, camera and covers in tiers, each drawn by the simulator from the seed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.sims.tabletop import TabletopWorld, make_world
from wonderful_team.sims.tabletop.likeness import unlikeness
from wonderful_team.sims.tabletop.options import Tiers

SMALL = (256, 128)
PICKS = ["follow_order", "rearrange_then_restore", "manipulate_old_neighbor", "pick_in_order_then_restore", "twist"]
SWEEPS = ["sweep_without_exceeding", "sweep_without_touching"]


def _things(world: TabletopWorld) -> dict:
    return world.privileged.truth()["things"]


def _solve(world: TabletopWorld) -> bool:
    for _ in range(world.horizon):
        for action in world.privileged.oracle()[:1]:
            world.execute(action)
    return bool(world.privileged.score().success)


@pytest.mark.parametrize("kind", ["clutter", "lighting", "camera", "texture"])
def test_tier_0_changes_no_pixel_and_each_other_tier_does_and_the_seed_decides(kind: str) -> None:
    seen = {}
    for tier in (0, 1, 2, 3):
        hashes = []
        for _ in range(2):
            world = make_world("rearrange", 4, size_px=SMALL, **{kind: tier})
            hashes.append((world.observe().hash, world.instruction.slots["scene"].views["top"].hash))
            world.close()
        assert hashes[0] == hashes[1]
        seen[tier] = hashes[0]
    plain = make_world("rearrange", 4, size_px=SMALL)
    assert (plain.observe().hash, plain.instruction.slots["scene"].views["top"].hash) == seen[0]
    plain.close()
    assert len({view for view, _ in seen.values()}) == 4
    other = make_world("rearrange", 5, size_px=SMALL, **{kind: 2})
    assert other.observe().hash != seen[2][0]
    other.close()


def test_things_stand_at_the_same_places_at_every_tier() -> None:
    plain = make_world("same_shape", 3)
    before = [(t["shape"], t["position_m"]) for t in _things(plain).values()]
    plain.close()
    for name in ("lighting=3", "camera=3", "texture=1"):
        world = make_world(f"same_shape@{name}", 3)
        assert [(t["shape"], t["position_m"]) for t in _things(world).values()] == before
        world.close()
    for name in ("texture=3", "clutter=3"):
        world = make_world(f"same_shape@{name}", 3)
        now = [(t["shape"], t["position_m"]) for t in _things(world).values()][: len(before)]
        assert [shape for shape, _ in now] == [shape for shape, _ in before]
        assert np.allclose([at for _, at in now], [at for _, at in before], atol=1e-4)
        world.close()


@pytest.mark.parametrize("name", PICKS)
def test_clutter_is_no_part_of_the_rules_and_the_oracle_still_solves_it(name: str) -> None:
    plain, world = make_world(name, 2), make_world(name, 2, clutter=3)
    extra = list(set(_things(world)) - set(_things(plain)))
    before, after = plain.privileged.truth(), world.privileged.truth()
    assert len(extra) == 6
    assert after["distractors"] == before["distractors"]
    assert [goal["thing"] for goal in after["goals"]] == [goal["thing"] for goal in before["goals"]]
    worn = {t["texture"] for t in [*before["things"].values(), *before["props"].values()]}
    for thing in (after["things"][n] for n in extra):
        assert thing["texture"] not in worn
        assert all(math.dist(thing["position_m"][:2], g["at_m"]) > 0.08 for g in after["goals"] if g["at_m"])
    assert _solve(world)
    for one in (plain, world):
        one.close()


@pytest.mark.parametrize("name", SWEEPS)
def test_clutter_leaves_the_way_of_a_sweep_free(name: str) -> None:
    world = make_world(name, 1, clutter=3)
    assert sum(t["kind"] == "kit" for t in _things(world).values()) > 6
    assert _solve(world)
    world.close()


def test_each_tier_of_clutter_adds_two_more_and_frames_show_them() -> None:
    counts = []
    for tier in range(4):
        world = make_world("follow_motion", 3, clutter=tier)
        counts.append(len(_things(world)))
        world.close()
    assert counts == [2, 4, 6, 8]
    world = make_world("follow_motion", 3, clutter=3)
    first = world.instruction.slots["frame_0"].views["top"].rgb
    assert np.array_equal(first, world.observe().main.rgb)
    world.close()


@pytest.mark.parametrize(("tier", "allowed_px"), [(1, 1.0), (2, 1.0), (3, 9.0)])
def test_a_moved_camera_says_where_it_is_and_the_last_tier_is_a_little_wrong(tier: int, allowed_px: float) -> None:
    world = make_world("same_texture", 6, camera=tier)
    usual = make_world("same_texture", 6)
    view = world.observe().main
    apart = []
    for name, thing in _things(world).items():
        # Flat things only: what is tall shows its sides to a camera that looks aslant.
        rows, columns = np.nonzero(world.privileged.mask(name))
        seen = np.array([columns.mean() + 0.5, rows.mean() + 0.5])
        outline = world.privileged.things()[name].outline_m
        top = np.column_stack([outline, np.full(len(outline), thing["height_m"])])
        low = np.column_stack([outline, np.zeros(len(outline))])
        drawn = view.camera.project(np.vstack([top, low]))
        box = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1])
        apart.append(np.abs(box - [*drawn.min(axis=0), *drawn.max(axis=0)]).max())
        moved = usual.observe().main.camera.project([thing["position_m"]])[0]
        assert np.linalg.norm(seen - moved) > 3
    assert max(apart) < allowed_px + 1.0
    if tier == 3:
        assert max(apart) > 2.0, "its calibration is wrong by up to 8 mm, 4 px"
    corners = view.camera.project([(x, y, 0.0) for x in (0.25, 0.75) for y in (-0.5, 0.5)])
    inside = (corners > -4) & (corners < np.array(view.size_px) + 4)
    assert inside.all(), "the whole table is seen"
    for one in (world, usual):
        one.close()


def test_light_is_weaker_tier_after_tier_and_casts_shadows_from_the_second() -> None:
    bright, shadows = [], []
    for tier in range(4):
        world = make_world("visual_manipulation", 5, lighting=tier)
        table = world.observe().main.rgb.astype(float)
        bare = ~np.any(list(world.privileged.masks().values()), axis=0)
        bare[:14] = bare[-14:] = bare[:, :24] = bare[:, -24:] = False
        grey = table[bare].mean(axis=1)
        bright.append(np.median(grey))
        shadows.append((grey < 0.8 * np.median(grey)).mean())
        slot = world.instruction.slots["base_obj"].views["top"].rgb
        world.close()
        plain = make_world("visual_manipulation", 5)
        assert np.array_equal(slot, plain.instruction.slots["base_obj"].views["top"].rgb), "taken in ordinary light"
        plain.close()
    assert bright == sorted(bright, reverse=True)
    assert max(shadows[:2]) < 0.002, "but for smoothed edges"
    assert shadows[2] > 0.01
    assert shadows[3] > 0.01


@pytest.mark.parametrize("options", [{"lighting": 3}, {"texture": 2, "camera": 2}])
def test_both_renderers_draw_harder_scenes_alike(options: dict[str, int]) -> None:
    pictures = []
    for renderer in (None, "rays"):
        world = make_world("scene_understanding", 3, renderer=renderer, size_px=(320, 160), **options)
        pictures.append(world.observe().main.rgb.astype(int))
        world.close()
    assert np.abs(pictures[0] - pictures[1]).mean() < 5


def test_covers_look_alike_and_stay_different() -> None:
    far, near = [], []
    for seed in range(8):
        for found, tier in ((far, 0), (near, 3)):
            world = make_world("follow_order", seed, texture=tier, size_px=SMALL)
            covers = [t["texture"] for t in _things(world).values()]
            world.close()
            assert len(set(covers)) == 4
            found += [unlikeness(covers[0], other) for other in covers[1:]]
    assert np.mean(near) < 0.6 * np.mean(far)


def test_names_and_options_say_the_same_thing_once() -> None:
    named = make_world("rotate@L3@small@clutter=2@camera=1", 1)
    given = make_world("rotate", 1, partition="L3", size_px=SMALL, clutter=2, camera=1)
    assert (named.partition, named.tiers) == ("L3", Tiers(clutter=2, camera=1))
    assert named.observe().hash == given.observe().hash
    assert named.observe().main.size_px == SMALL
    for world in (named, given):
        world.close()


@pytest.mark.parametrize(
    ("name", "options", "error", "words"),
    [
        ("rotate", {"clutter": 4}, ConfigError, r"clutter: expected a tier from 0 .* to 3 .*, got 4"),
        ("rotate", {"lighting": True}, ConfigError, "lighting: expected a tier"),
        ("rotate@camera=x", {}, ConfigError, "'camera=x' is no tier"),
        ("rotate@fog=1", {}, ConfigError, "'fog=1' is no option.*clutter, lighting, camera, texture"),
        ("rotate@clutter=1", {"clutter": 2}, ConfigError, "the name says 1, the option 2"),
        ("rotate@L1@L2", {}, ConfigError, "the name says 'L2', the option 'L1'"),
        ("rotate@L9", {}, UnknownNameError, "partition of rotate 'L9'.*L1, L2, L3"),
    ],
)
def test_wrong_names_and_tiers_are_named(name: str, options: dict, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        make_world(name, 1, **options)
