"""The paper's implicit-goal task of companions: fruits and snacks go to the one of their colour, in four variations."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.prints import card_texture
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.fruit_placement import COLOUR_OF

WORDS = (
    "Fruits and snacks of similar color make perfect companions. Distribute the unmatched items from the top left corner "
    "to the superheroes to help each of them have companion pairs."
)
HORIZON = 8
HEROES = ("COMET", "NOVA", "TITAN")
FRUIT_OF = {colour: fruit for fruit, colour in COLOUR_OF.items()}
SNACK = "shorter block"
"""A bar in its wrapper."""
BIN_X_M, NAME_X_M, BIN_APART_M = 0.6, 0.727, 0.3
RESIDENT_M = -0.046
"""From the middle of a bin to what lies in it at the start, towards the left of the picture: the rest stays free [m]."""
CORNER_M = (0.335, -0.43)
"""Where the first of the unmatched items lies; the others follow along the table's far edge [m]."""
ITEM_APART_M, LOOSE_M = 0.105, 0.006
LYING_RAD = math.pi / 2
"""How a banana is turned to lie along the bins' depth."""
SHADED = ("red", "green", "blue", "purple")
"""Colours whose dark shade is still called by their name."""
PAIRED = ("red", "yellow", "green", "blue", "purple")


def _item(scene: Scene, colour: str, *, snack: str | None, at: tuple[float, float], name: str) -> Thing:
    """A fruit of a colour, or a snack with a wrapper."""
    if snack is not None:
        return scene.add(SNACK, snack, at=at, yaw_rad=0.0, name=name)
    fruit = FRUIT_OF[colour]
    return scene.add(fruit, f"{fruit} skin", at=at, yaw_rad=LYING_RAD, name=name)


def _set_table(
    scene: Scene, rng: np.random.Generator, colours: list[str], wrappers: dict[str, str], odd: str | None = None
) -> None:
    """Three bins with an item of a colour each; what goes with each lies in the corner, and perhaps one that goes with none.

    `wrappers` gives the texture of the snack that goes with each colour, `odd` that of a snack without a companion.
    """
    scene.ends_when_reached = False
    cover = ("wooden", "granite", "plastic")[int(scene.colours.integers(3))]
    bins, loose = [], []
    for number, (hero, colour) in enumerate(zip(rng.permutation(HEROES), colours, strict=True)):
        y = BIN_APART_M * (number - 1)
        bins.append(scene.add("container", cover, at=(BIN_X_M, y), yaw_rad=0.0, name=f"bin of {hero}"))
        scene.add("label", card_texture(str(hero)), at=(NAME_X_M, y), yaw_rad=0.0, name=f"name of {hero}")
        fruit_waits = bool(rng.random() < 0.5)
        resident = wrappers[colour] if fruit_waits else None
        inside = _item(scene, colour, snack=resident, at=(BIN_X_M, y + RESIDENT_M), name=f"{colour} item of {hero}")
        scene.goal(inside, inside=bins[-1])
        loose.append((colour, None if fruit_waits else wrappers[colour], bins[-1]))
    waiting: list[tuple[str, str | None, Thing | None]] = [*loose]
    if odd is not None:
        waiting.append((odd, odd, None))
    for place, k in enumerate(rng.permutation(len(waiting))):
        colour, snack, goes_to = waiting[int(k)]
        dx, dy = scene.layout.uniform(-LOOSE_M, LOOSE_M, 2)
        at = (CORNER_M[0] + float(dx), max(CORNER_M[1], LOOSE_M - scene.side_m) + ITEM_APART_M * place + float(dy))
        item = _item(scene, colour, snack=snack, at=at, name=f"unmatched {colour} item")
        if goes_to is None:
            scene.goal(item, off=bins)
        else:
            scene.goal(item, inside=goes_to)


def _colours(rng: np.random.Generator, among: tuple[str, ...], count: int = 3) -> list[str]:
    return [str(name) for name in rng.permutation(among)[:count]]


@task("superhero_companions/exact", instruction=WORDS, horizon=HORIZON)
def exact(scene: Scene, rng: np.random.Generator) -> None:
    """Bring three unmatched items to the items of just their colour."""
    colours = _colours(rng, tuple(FRUIT_OF))
    _set_table(scene, rng, colours, {colour: colour for colour in colours})


@task("superhero_companions/similar", instruction=WORDS, horizon=HORIZON)
def similar(scene: Scene, rng: np.random.Generator) -> None:
    """Bring three unmatched items to items of a similar colour; the shades differ."""
    colours = _colours(rng, SHADED)
    _set_table(scene, rng, colours, {colour: f"dark {colour}" for colour in colours})


@task("superhero_companions/two_coloured", instruction=WORDS, horizon=HORIZON)
def two_coloured(scene: Scene, rng: np.random.Generator) -> None:
    """Bring three unmatched items to their companions; the snacks have two colours, one of which has a companion."""
    drawn = _colours(rng, PAIRED, 4)
    colours, second = drawn[:3], drawn[3]
    _set_table(scene, rng, colours, {colour: _striped(colour, second) for colour in colours})


@task("superhero_companions/no_match", instruction=WORDS, horizon=HORIZON)
def no_match(scene: Scene, rng: np.random.Generator) -> None:
    """Bring three unmatched items to their companions; a fourth has none and stays out of the bins."""
    drawn = _colours(rng, PAIRED, 4)
    _set_table(scene, rng, drawn[:3], {colour: colour for colour in drawn[:3]}, odd=drawn[3])


def _striped(one: str, other: str) -> str:
    """The texture with stripes of two colours, which has them in an order of its own."""
    first, second = sorted((one, other), key=PAIRED.index)
    return f"{first} and {second} stripe"
