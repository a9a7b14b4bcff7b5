"""Turn all things of a texture by an angle that three pairs of pictures show."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.showing import Stand
from wonderful_team.sims.tabletop.tasks.choices import L123, kit_textures, one_of, turning_shapes
from wonderful_team.sims.tabletop.tasks.rotate import ANGLES_DEG

EXAMPLES = 3
WITHIN_M = 0.05
WORDS = (
    '"Twist" is defined as rotating object a specific angle. For examples: '
    + " ".join(f"From {{before_twist_{k}}} to {{after_twist_{k}}}." for k in range(1, EXAMPLES + 1))
    + " Now twist all {texture} objects."
)


@task("twist", instruction=WORDS, horizon=7, partitions=L123)
def twist(scene: Scene, rng: np.random.Generator) -> None:
    """Turn every thing of a named texture by the angle that three pairs of pictures show, where it stands."""
    scene.goals_last = True
    turned_rad = -math.radians(ANGLES_DEG[int(rng.integers(len(ANGLES_DEG)))])
    cover, *others = scene.pick_textures(3 + EXAMPLES, kit_textures(scene))
    count = int(rng.integers(1, 3))
    for k in range(3):
        shape = one_of(rng, turning_shapes(scene))
        thing = scene.add(shape, cover if k < count else others[k - 1], distractor=k >= count)
        if k < count:
            scene.goal(thing, at=(thing.x_m, thing.y_m), within_m=WITHIN_M, turned_rad=turned_rad)
    for k in range(1, EXAMPLES + 1):
        example = scene.prop(one_of(rng, turning_shapes(scene)), others[k + 1])
        at = (float(scene.layout.uniform(0.4, 0.6)), float(scene.layout.uniform(-0.35, 0.35)))
        yaw = float(scene.layout.uniform(-math.pi, math.pi))
        for kind, angle in (("before", yaw), ("after", yaw + turned_rad)):
            stand = {example: Stand(example.name, at, angle)}
            if kind == "before":
                scene.show_table(f"before_twist_{k}", moved=stand, only=[example], kind="before", index=k)
            else:
                scene.show_table(f"after_twist_{k}", moved=stand, only=[example], kind="after", index=k)
    scene.say(texture=cover)
