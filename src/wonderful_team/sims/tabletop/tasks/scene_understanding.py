"""Put the thing of one texture, shown on the table, into the thing of another texture."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.shapes import BASES, KIT
from wonderful_team.sims.tabletop.tasks.choices import BASE_TEXTURES, KIT_TEXTURES, add_distractor, one_of


@task(
    "scene_understanding",
    instruction="Put the {dragged_texture} object in {scene} into the {base_texture} object.",
    horizon=5,
)
def scene_understanding(scene: Scene, rng: np.random.Generator) -> None:
    """Put the thing of a named texture, seen in a picture of the table, into the thing of another texture."""
    carried_cover, base_cover = scene.pick_textures(1, KIT_TEXTURES)[0], scene.pick_textures(1, BASE_TEXTURES)[0]
    base = scene.add(one_of(rng, BASES), base_cover)
    carried = scene.add(one_of(rng, KIT), carried_cover)
    add_distractor(scene, rng, carried, base, (carried_cover, base_cover))
    scene.say(dragged_texture=carried_cover, base_texture=base_cover)
    scene.show_table("scene")
    scene.goal(carried, near=base)
