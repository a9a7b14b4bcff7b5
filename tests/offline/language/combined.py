"""Two tasks in one instruction, on the tabletop, and other words for each."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team import task
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.scene import CrowdedError, Scene, Spot
from wonderful_team.sims.tabletop.showing import Stand
from wonderful_team.sims.tabletop.tasks.choices import base_textures, kit_shapes, kit_textures, one_of, turning_shapes
from wonderful_team.sims.tabletop.tasks.rotate import ANGLES_DEG

APART_M = 0.13
WITHIN_M = 0.125
STAYS_M = 0.1
NOUNS = ("dax", "blicket", "wug", "zup")
OTHER_WORDS: dict[str, tuple[str, ...]] = {
    "mine/turn_then_put": (
        "Turn {turned} clockwise by ANGLE degrees. After that, {carried} goes into {base}.",
        "Put {carried} into {base} after you have rotated {turned} by ANGLE degrees.",
        "Give {turned} a ANGLE degree clockwise turn and then drop {carried} inside {base}.",
    ),
    "mine/put_then_back": (
        "Move {carried} into {base} and afterwards back to where it was.",
        "Place {carried} inside {base}. Then return it to its original place.",
        "{carried} goes into {base} first; then put it back.",
    ),
    "mine/rearrange_then_turn": (
        "Make the table look like {scene}. After that turn {turned} clockwise by ANGLE degrees.",
        "First arrange the objects as in {scene}, then give {turned} a ANGLE degree turn.",
        "Bring everything into the layout {scene} and rotate {turned} by ANGLE degrees.",
    ),
    "mine/gather_and_turn": (
        "Everything with the pattern of {base} goes into it. Also turn {turned} by ANGLE degrees.",
        "Rotate {turned} ANGLE degrees, then put all objects that have the same texture as {base} into {base}.",
        "Fill {base} with the objects of the same texture and rotate {turned} clockwise by ANGLE degrees.",
    ),
    "mine/noun_then_turn": (
        "Call this {carried} a FIRST and this {base} a SECOND. Move the FIRST into the SECOND. Then turn {turned} ANGLE degrees.",
        "A FIRST looks like {carried}. A SECOND looks like {base}. First rotate {turned} by ANGLE degrees, then put the FIRST in the SECOND.",
    ),
    "mine/put_two": (
        "First {one} goes into {first_base}, then {two} goes into {second_base}.",
        "Place {one} inside {first_base}. Also place {two} inside {second_base}.",
        "Put {two} into {second_base} and {one} into {first_base}.",
    ),
    "mine/twist_then_put": (
        "A twist changes {before_twist_1} to {after_twist_1} and {before_twist_2} to {after_twist_2}. Twist every TEXTURE object. After that, put {carried} into {base}.",
        "From {before_twist_1} to {after_twist_1} and from {before_twist_2} to {after_twist_2}: that is a twist. Twist all TEXTURE objects, then move {carried} into {base}.",
    ),
    "mine/neighbour_then_turn": (
        "Put {carried} into {base}, then whatever stood DIRECTION of it before, and finally turn {turned} clockwise by ANGLE degrees.",
        "Drop {carried} in {base}, then its old DIRECTION neighbour too. At last rotate {turned} by ANGLE degrees.",
    ),
}  # fmt: skip


@task(
    "mine/turn_then_put",
    instruction="First rotate {turned} {angle} degrees, then put {carried} into {base}.",
    horizon=6,
)
def turn_then_put(scene: Scene, rng: np.random.Generator) -> None:
    """Turn one thing where it stands, then put another into a container."""
    carried, base = _carried_and_base(scene, rng)
    turned, angle = _turned(scene, rng)
    scene.then()
    scene.goal(carried, near=base)
    _still_turned(scene, turned, angle)
    scene.show(carried=carried, base=base, turned=turned)


@task("mine/put_then_back", instruction="Put {carried} into {base}, then restore it.", horizon=6)
def put_then_back(scene: Scene, rng: np.random.Generator) -> None:
    """Put a thing into a container and then back to where it stood."""
    carried, base = _carried_and_base(scene, rng)
    scene.add(one_of(rng, kit_shapes(scene)), _cover(scene), distractor=True)
    scene.goal(carried, near=base)
    scene.then()
    scene.goal(carried, at=(carried.x_m, carried.y_m))
    scene.show(carried=carried, base=base)


@task(
    "mine/rearrange_then_turn",
    instruction="Rearrange to {scene} and then rotate {turned} {angle} degrees.",
    horizon=8,
)
def rearrange_then_turn(scene: Scene, rng: np.random.Generator) -> None:
    """Bring two things to where a picture shows them, then turn a third one that stays."""
    scene.apart_m = 0.15
    covers = scene.pick_textures(3, kit_textures(scene))
    things = [scene.add(one_of(rng, kit_shapes(scene)), cover) for cover in covers[:2]]
    turned = scene.add(one_of(rng, turning_shapes(scene)), covers[2])
    stands: dict[Thing, Stand] = {}
    spots: list[Spot] = []
    for thing in things:
        spot = scene.free_place(thing, away=[*spots, *((t.x_m, t.y_m) for t in (*things, turned))])
        stands[thing] = Stand(thing.name, spot, thing.yaw_rad)
        spots.append(spot)
    for thing in things:
        scene.goal(thing, at=stands[thing].at_m)
    scene.goal(turned, at=(turned.x_m, turned.y_m))
    scene.then()
    for thing in things:
        scene.goal(thing, at=stands[thing].at_m)
    _still_turned(scene, turned, _angle(scene, rng))
    scene.show_table("scene", moved=stands)
    scene.show(turned=turned)


@task("mine/gather_and_turn", instruction="Put all objects with the same texture as {base} into it, and turn {turned} {angle} degrees.", horizon=7)  # fmt: skip
def gather_and_turn(scene: Scene, rng: np.random.Generator) -> None:
    """Put the two things of a container's texture into it and turn a third one, in any order."""
    scene.apart_m = 0.14
    cover, other = scene.pick_textures(2, kit_textures(scene))
    base = scene.add(one_of(rng, ("frame", "square", "container", "pallet")), cover)
    for _ in range(2):
        scene.goal(scene.add(one_of(rng, kit_shapes(scene)), cover), near=base, within_m=WITHIN_M)
    turned = scene.add(one_of(rng, turning_shapes(scene)), other)
    _still_turned(scene, turned, _angle(scene, rng))
    scene.show(base=base, turned=turned)


@task("mine/noun_then_turn", instruction="This is a {first_noun} {carried}. This is a {second_noun} {base}. Put a {first_noun} into a {second_noun}, "
      "then turn {turned} {angle} degrees.", horizon=6)  # fmt: skip
def noun_then_turn(scene: Scene, rng: np.random.Generator) -> None:
    """Put a thing into another, both known by new nouns; then turn a third one."""
    carried, base = _carried_and_base(scene, rng)
    turned = scene.add(one_of(rng, [n for n in turning_shapes(scene) if n != carried.shape]), _cover(scene))
    scene.goal(carried, near=base)
    _still_turned(scene, turned, _angle(scene, rng))
    first, second = (NOUNS[int(k)] for k in rng.choice(len(NOUNS), size=2, replace=False))
    scene.say(first_noun=first, second_noun=second)
    scene.show(carried=carried, base=base, turned=turned)


@task("mine/put_two", instruction="Put {one} into {first_base} and {two} into {second_base}.", horizon=6)
def put_two(scene: Scene, rng: np.random.Generator) -> None:
    """Two things into two containers."""
    one, first = _carried_and_base(scene, rng)
    two, second = _carried_and_base(scene, rng, taken=(one, first))
    scene.goal(one, near=first)
    scene.goal(two, near=second)
    scene.show(one=one, two=two, first_base=first, second_base=second)


@task("mine/twist_then_put", instruction='"Twist" is defined as rotating object a specific angle. For examples: From {before_twist_1} to {after_twist_1}. '
      "From {before_twist_2} to {after_twist_2}. Now twist all {texture} objects. Then put {carried} into {base}.", horizon=7)  # fmt: skip
def twist_then_put(scene: Scene, rng: np.random.Generator) -> None:
    """Turn the thing of a texture by an angle that two pairs of pictures show, then put another into a container."""
    carried, base = _carried_and_base(scene, rng)
    turn = -math.radians(_angle_of(rng))
    cover, *others = [
        name for name in scene.pick_textures(5, kit_textures(scene)) if name not in (carried.texture, base.texture)
    ]
    turned = scene.add(one_of(rng, turning_shapes(scene)), cover)
    scene.goal(turned, at=(turned.x_m, turned.y_m), within_m=STAYS_M, turned_rad=turn)
    scene.then()
    scene.goal(turned, at=(turned.x_m, turned.y_m), within_m=STAYS_M, turned_rad=turn)
    scene.goal(carried, near=base)
    for k in (1, 2):
        example = scene.prop(one_of(rng, turning_shapes(scene)), others[k - 1])
        at = (float(scene.layout.uniform(0.4, 0.6)), float(scene.layout.uniform(-0.35, 0.35)))
        yaw = float(scene.layout.uniform(-math.pi, math.pi))
        before, after = (Stand(example.name, at, angle) for angle in (yaw, yaw + turn))
        scene.show_table(f"before_twist_{k}", moved={example: before}, only=[example], kind="before", index=k)
        scene.show_table(f"after_twist_{k}", moved={example: after}, only=[example], kind="after", index=k)
    scene.say(texture=cover)
    scene.show(carried=carried, base=base)


@task("mine/neighbour_then_turn", instruction="First put {carried} into {base}, then put the object that was previously at its {direction} into the same {base}. "
      "Finally rotate {turned} {angle} degrees.", horizon=8)  # fmt: skip
def neighbour_then_turn(scene: Scene, rng: np.random.Generator) -> None:
    """Put a thing and its old neighbour into a container, then turn another thing."""
    covers = scene.pick_textures(3, kit_textures(scene))
    side = one_of(rng, ("west", "east"))
    middle = (0.5, float(scene.layout.uniform(-0.05, 0.05)))
    carried = scene.add(one_of(rng, kit_shapes(scene)), covers[0], at=middle)
    beside = (middle[0], middle[1] + (0.17 if side == "east" else -0.17))
    neighbour = scene.add(one_of(rng, kit_shapes(scene)), covers[1], at=beside)
    if not scene.fits(neighbour, beside):
        raise CrowdedError("the neighbour does not fit")
    scene.apart_m = APART_M
    base = scene.add(one_of(rng, ("frame", "square", "container", "pallet")), _cover(scene, base_textures(scene)))
    turned = scene.add(one_of(rng, turning_shapes(scene)), covers[2])
    scene.goal(carried, near=base)
    scene.then()
    scene.goal(carried, near=base)
    scene.goal(neighbour, near=base)
    scene.then()
    scene.goal(neighbour, near=base)
    _still_turned(scene, turned, _angle(scene, rng))
    scene.say(direction=side)
    scene.show(carried=carried, base=base, turned=turned)


def _carried_and_base(scene: Scene, rng: np.random.Generator, taken: tuple[Thing, ...] = ()) -> tuple[Thing, Thing]:
    """A thing and a container of looks and shapes that nothing else has."""
    scene.apart_m = APART_M
    shapes = {thing.shape for thing in taken}
    base_shape = one_of(
        rng, [name for name in ("bowl", "frame", "square", "container", "pallet") if name not in shapes]
    )
    base = scene.add(base_shape, _cover(scene, base_textures(scene)))
    shape = one_of(rng, [name for name in kit_shapes(scene) if name not in shapes])
    return scene.add(shape, _cover(scene)), base


def _cover(scene: Scene, among: tuple[str, ...] | None = None) -> str:
    """A texture that nothing on the table wears."""
    worn = {thing.texture for thing in scene.things}
    free = [name for name in (among or kit_textures(scene)) if name not in worn]
    return scene.pick_textures(1, free)[0]


def _angle_of(rng: np.random.Generator) -> int:
    return ANGLES_DEG[int(rng.integers(len(ANGLES_DEG)))]


def _angle(scene: Scene, rng: np.random.Generator) -> int:
    angle = _angle_of(rng)
    scene.say(angle=str(angle))
    return angle


def _turned(scene: Scene, rng: np.random.Generator) -> tuple[Thing, int]:
    turned = scene.add(one_of(rng, turning_shapes(scene)), _cover(scene))
    angle = _angle(scene, rng)
    _still_turned(scene, turned, angle)
    return turned, angle


def _still_turned(scene: Scene, thing: Thing, angle_deg: int) -> None:
    scene.goal(thing, at=(thing.x_m, thing.y_m), within_m=STAYS_M, turned_rad=-math.radians(angle_deg))
