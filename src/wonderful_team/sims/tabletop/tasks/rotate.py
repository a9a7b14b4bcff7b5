"""Turn the pictured thing by a stated angle, clockwise seen from above."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.choices import L123, kit_textures, one_of, turning_shapes

ANGLES_DEG = (30, 60, 90, 120, 150)


@task("rotate", instruction="Rotate the {dragged_obj} {angle} degrees.", horizon=5, partitions=L123)
def rotate(scene: Scene, rng: np.random.Generator) -> None:
    """Turn the thing shown in a picture by the stated angle, where it stands; one distractor."""
    cover, other_cover = scene.pick_textures(2, kit_textures(scene))
    angle_deg = ANGLES_DEG[int(rng.integers(len(ANGLES_DEG)))]
    carried = scene.add(one_of(rng, turning_shapes(scene)), cover)
    scene.add(one_of(rng, turning_shapes(scene)), other_cover, distractor=True)
    scene.show(dragged_obj=carried)
    scene.say(angle=str(angle_deg))
    scene.goal(carried, at=(carried.x_m, carried.y_m), turned_rad=-math.radians(angle_deg))
