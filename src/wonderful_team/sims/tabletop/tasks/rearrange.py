"""Bring things to where a picture of the table shows them, and in one task back again."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene, Spot
from wonderful_team.sims.tabletop.showing import Stand
from wonderful_team.sims.tabletop.tasks.choices import L123, kit_shapes, kit_textures, one_of

APART_M = 0.15
"""How far apart centres are, at the start and in the picture [m]: with more than 0.1 m no place counts for another."""


@task("rearrange", instruction="Rearrange to this {scene}.", horizon=7, partitions=L123)
def rearrange(scene: Scene, rng: np.random.Generator) -> None:
    """Bring one to three things to where a picture of the table shows them; something else may be in the way."""
    _to_the_picture(scene, rng)


@task(
    "rearrange_then_restore",
    instruction="Rearrange objects to this setup {scene} and then restore.",
    horizon=10,
    partitions=L123,
)
def rearrange_then_restore(scene: Scene, rng: np.random.Generator) -> None:
    """Bring one to three things to where a picture shows them, then every one back to where it stood."""
    moved = _to_the_picture(scene, rng)
    scene.then()
    for thing in moved:
        scene.goal(thing, at=(thing.x_m, thing.y_m))


def _to_the_picture(scene: Scene, rng: np.random.Generator) -> list[Thing]:
    """Things, a picture of where they go, and the goals; with one thing there is one that must not be there."""
    scene.apart_m = APART_M
    scene.distractors_matter, scene.goals_last = "at the end", True
    count = int(rng.integers(1, 4))
    covers = scene.pick_textures(count + 1, kit_textures(scene))
    things = [scene.add(one_of(rng, kit_shapes(scene)), cover) for cover in covers[:count]]
    stands: dict[Thing, Stand] = {}
    spots: list[Spot] = []
    for thing in things:
        yaw = float(scene.layout.uniform(-math.pi, math.pi))
        # Away from where the things stand now, so that nothing is at its place from the start, or at another's.
        spot = scene.free_place(replace(thing, yaw_rad=yaw), away=[*spots, (thing.x_m, thing.y_m)])
        stands[thing] = Stand(thing.name, spot, yaw)
        spots.append(spot)
    if count == 1:
        shape, thing = one_of(rng, kit_shapes(scene)), things[0]
        if rng.random() < 0.5:
            scene.add(shape, covers[1], at=spots[0], yaw_rad=stands[thing].yaw_rad, distractor=True)
        else:
            draft = replace(thing, name="", shape=shape, yaw_rad=float(scene.layout.uniform(-math.pi, math.pi)))
            spot = scene.free_place(draft, away=spots)
            scene.add(shape, covers[1], at=spot, yaw_rad=draft.yaw_rad, distractor=True)
    for thing in things:
        scene.goal(thing, at=stands[thing].at_m)
    scene.show_table("scene", moved=stands, only=things)
    return things
