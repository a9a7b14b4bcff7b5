"""Put the pictured thing into the pictured container."""

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


@task("visual_manipulation", instruction="Put the {dragged_obj_1} into the {base_obj}.", horizon=5, partitions=L123)
def visual_manipulation(scene: Scene, rng: np.random.Generator) -> None:
    """Put the thing shown in one picture into the container shown in another; one distractor."""
    carried_cover = scene.pick_textures(1, kit_textures(scene))[0]
    base_cover = scene.pick_textures(1, base_textures(scene))[0]
    base = scene.add(one_of(rng, base_shapes(scene)), base_cover)
    carried = scene.add(one_of(rng, kit_shapes(scene)), carried_cover)
    add_distractor(scene, rng, carried, base, (carried_cover, base_cover))
    scene.show(dragged_obj_1=carried, base_obj=base)
    scene.goal(carried, near=base)
