"""Gather what has the texture, or the outline, of a pictured container."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.choices import L4, L123, base_shapes, kit_shapes, kit_textures, one_of

WITHIN_M, WITHIN_BOWL_M = 0.125, 0.0875
SQUARE_LIKE: tuple[str, ...] = ("shorter block",)
CIRCLE_LIKE: tuple[str, ...] = ("ring", "round")
CIRCLE_BASES = ("bowl", "pan")


@task(
    "same_texture",
    instruction="Put all objects with the same texture as {base_obj} into it.",
    horizon=6,
    partitions=L4,
)
def same_texture(scene: Scene, rng: np.random.Generator) -> None:
    """Put the two things that have a pictured container's texture into it; one has another texture."""
    scene.apart_m, scene.goals_last = WITHIN_M + 0.015, True
    cover, other = scene.pick_textures(2, kit_textures(scene))
    base = scene.add(one_of(rng, base_shapes(scene)), cover)
    shapes = (*kit_shapes(scene), *SQUARE_LIKE)
    for _ in range(2):
        _goes_into(scene, scene.add(one_of(rng, shapes), cover), base)
    scene.add(one_of(rng, shapes), other, distractor=True)
    scene.show(base_obj=base)


@task(
    "same_shape", instruction="Put all objects with the same profile as {base_obj} into it.", horizon=6, partitions=L123
)
def same_shape(scene: Scene, rng: np.random.Generator) -> None:
    """Put the two things that are square, or round, like a pictured container into it; one has the other outline."""
    scene.apart_m, scene.goals_last = WITHIN_M + 0.015, True
    base_name = one_of(rng, base_shapes(scene))
    like, unlike = SQUARE_LIKE, CIRCLE_LIKE
    if base_name in CIRCLE_BASES:
        like, unlike = unlike, like
    covers = scene.pick_textures(4, kit_textures(scene))
    base = scene.add(base_name, covers[0])
    for cover in covers[1:3]:
        _goes_into(scene, scene.add(one_of(rng, kit_shapes(scene, like)), cover), base)
    scene.add(one_of(rng, kit_shapes(scene, unlike)), covers[3], distractor=True)
    scene.show(base_obj=base)


def _goes_into(scene: Scene, thing: Thing, base: Thing) -> None:
    scene.goal(thing, near=base, within_m=WITHIN_BOWL_M if base.shape == "bowl" else WITHIN_M)
