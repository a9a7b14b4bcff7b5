"""Put the thing of one texture, shown on the table, into the thing of another texture."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.choices import (
    L123,
    add_distractor,
    base_shapes,
    base_textures,
    kit_shapes,
    kit_textures,
    one_of,
)


@task(
    "scene_understanding",
    instruction="Put the {dragged_texture} object in {scene} into the {base_texture} object.",
    horizon=5,
    partitions=L123,
)
def scene_understanding(scene: Scene, rng: np.random.Generator) -> None:
    """Put the thing of a named texture, seen in a picture of the table, into the thing of another texture."""
    carried_cover = scene.pick_textures(1, kit_textures(scene))[0]
    base_cover = scene.pick_textures(1, base_textures(scene))[0]
    base = scene.add(one_of(rng, base_shapes(scene)), base_cover)
    carried = scene.add(one_of(rng, kit_shapes(scene)), carried_cover)
    add_distractor(scene, rng, carried, base, (carried_cover, base_cover))
    scene.say(dragged_texture=carried_cover, base_texture=base_cover)
    scene.show_table("scene")
    scene.goal(carried, near=base)
