"""Put a pictured thing away, then the one that stood beside it."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import CrowdedError, Scene, Spot
from wonderful_team.sims.tabletop.tasks.choices import (
    L123,
    base_shapes,
    base_textures,
    kit_shapes,
    kit_textures,
    one_of,
)

STEP_M = {"north": (-0.155, 0.0), "south": (0.155, 0.0), "west": (0.0, -0.17), "east": (0.0, 0.17)}
"""From a thing to its neighbour in the top picture: north is the picture's top [m]."""
SKEW_RAD = math.radians(6)


@task(
    "manipulate_old_neighbor",
    instruction="First put {dragged_obj} into {base_obj} then put the object that was previously at its {direction} "
    "into the same {base_obj}.",
    horizon=6,
    partitions=L123,
)
def manipulate_old_neighbor(scene: Scene, rng: np.random.Generator) -> None:
    """Put a pictured thing into a container, then the neighbour that it had on a named side; three more stand by."""
    scene.order, scene.goals_last = "no skipping", True
    covers = scene.pick_textures(5, kit_textures(scene))
    base_name, base_cover = one_of(rng, base_shapes(scene)), scene.pick_textures(1, base_textures(scene))[0]
    direction = one_of(rng, tuple(STEP_M))
    side = float(scene.layout.choice([-1, 1]))
    middle = (0.5, side * float(scene.layout.uniform(0.14, 0.2)))
    carried = _stand(scene, one_of(rng, kit_shapes(scene)), covers[0], middle, distractor=False)
    for (name, step), cover in zip(STEP_M.items(), covers[1:], strict=True):
        spot = (middle[0] + step[0], middle[1] + step[1])
        thing = _stand(scene, one_of(rng, kit_shapes(scene)), cover, spot, distractor=name != direction)
        if name == direction:
            neighbour = thing
    base = scene.add(base_name, base_cover)
    scene.goal(carried, near=base)
    scene.then()
    scene.goal(neighbour, near=base)
    scene.show(dragged_obj=carried, base_obj=base)
    scene.say(direction=direction)


def _stand(scene: Scene, shape: str, cover: str, at: Spot, *, distractor: bool) -> Thing:
    """A thing at a place, roughly square to the table, so that neighbours do not touch."""
    yaw = float(scene.layout.integers(4)) * math.pi / 2 + float(scene.layout.uniform(-SKEW_RAD, SKEW_RAD))
    thing = scene.add(shape, cover, at=at, yaw_rad=yaw, distractor=distractor)
    if not scene.fits(thing, at):
        raise CrowdedError(f"{thing.name!r} does not fit between its neighbours")
    return thing
