"""Carry a thing from container to container and back to its own."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.choices import (
    L123,
    base_shapes,
    base_textures,
    kit_shapes,
    kit_textures,
    one_of,
)

CONTAINERS = ("bowl", "frame", "square", "container", "pallet")
"""A pan's handle would reach into the next place."""
ROWS_M, COLUMNS_M = (0.375, 0.625), (-0.33, 0.0, 0.33)
JITTER_M = 0.004
WITHIN_M = 0.05


@task(
    "pick_in_order_then_restore",
    instruction="Put {dragged_obj} into {base_obj_1} then {base_obj_2}. Finally restore it into its original container.",
    horizon=6,
    partitions=L123,
)
def pick_in_order_then_restore(scene: Scene, rng: np.random.Generator) -> None:
    """Put a thing into one container, then into another, then back into its own; six containers differ by texture."""
    scene.order, scene.goals_last = "no skipping", True
    name = one_of(rng, base_shapes(scene, CONTAINERS))
    covers = scene.pick_textures(6, base_textures(scene))
    places = [(x, y) for x in ROWS_M for y in COLUMNS_M]
    containers = []
    for (x, y), cover in zip(places, covers, strict=True):
        dx, dy = (float(v) for v in scene.layout.uniform(-JITTER_M, JITTER_M, size=2))
        sideways = float(scene.layout.uniform(-0.03, 0.03))
        containers.append(scene.add(name, cover, at=(x + dx, y + dy + sideways), yaw_rad=0.0))
    own, first, second = (containers[int(k)] for k in rng.choice(6, size=3, replace=False))
    yaw = float(scene.layout.integers(4)) * math.pi / 2
    carried = scene.add(
        one_of(rng, kit_shapes(scene)),
        scene.pick_textures(1, kit_textures(scene))[0],
        at=(own.x_m, own.y_m),
        yaw_rad=yaw,
        lifted_m=0.03,
    )
    for goal in (first, second, own):
        scene.goal(carried, near=goal, within_m=WITHIN_M)
        scene.then()
    scene.show(dragged_obj=carried, base_obj_1=first, base_obj_2=second)
