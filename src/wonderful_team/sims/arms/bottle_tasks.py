"""How the tables of the tasks with bottles are set."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.arms.capping import GAP_M, Capped
from wonderful_team.sims.arms.scene import ArmScene
from wonderful_team.sims.arms.shaking import Shaking
from wonderful_team.sims.tabletop.placing import Room
from wonderful_team.sims.tabletop.scene import Scene

COLOURS = ("red", "green", "blue", "yellow", "purple", "orange")
CAPS = ("pink", "cyan")
ROOM_M: Room = (0.33, -0.26, 0.62, 0.26)
"""Where bottles stand: with room to lift them and for what comes off them beside them [m]."""


def shake(scene: Scene, rng: np.random.Generator) -> None:
    """Shake the bottle of the named colour in the air and put it back; another bottle stands beside it."""
    colours = [str(name) for name in scene.colours.permutation(COLOURS)[:2]]
    wanted, _ = (scene.add("bottle", one, name=f"{one} bottle", within=ROOM_M) for one in colours)
    scene.say(colour=colours[0])
    assert isinstance(scene, ArmScene)
    scene.work = Shaking(wanted, scene.things)


def cap(scene: Scene, rng: np.random.Generator) -> None:
    """Screw the cap off the bottle of the named colour and put it down; another closed bottle stands beside it."""
    colours = [str(name) for name in scene.colours.permutation(COLOURS)[:2]]
    covers = [str(name) for name in scene.colours.permutation(CAPS)]
    bottles = [scene.add("screw-top bottle", one, name=f"{one} bottle", within=ROOM_M) for one in colours]
    caps = {}
    for bottle, cover in zip(bottles, covers, strict=True):
        lifted = bottle.body.height_m + GAP_M
        at = (bottle.x_m, bottle.y_m)
        caps[bottle.name] = scene.add(
            "cap", cover, name=f"cap of the {bottle.name}", at=at, yaw_rad=bottle.yaw_rad, lifted_m=lifted
        )
    scene.say(colour=colours[0])
    assert isinstance(scene, ArmScene)
    scene.work = Capped(bottles[0], caps, scene.things)
