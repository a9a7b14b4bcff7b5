"""The paper's implicit-goal task: sort fruits onto papers of their colour, in four variations."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.textures import PAPER_SHADES

COLOUR_OF = {
    "apple": "red",
    "lime": "green",
    "orange": "orange",
    "banana": "yellow",
    "plum": "purple",
    "blueberry": "blue",
}
WORDS = "Place each fruit in the area that matches its color, if such an area exists."
AREAS = 3
HORIZON = 6


def _areas(scene: Scene, fruits: list[str]) -> dict[str, Thing]:
    """One paper per fruit's colour."""
    shades = sorted(PAPER_SHADES)
    shade = shades[int(scene.colours.integers(len(shades)))]
    colours = {fruit: COLOUR_OF[fruit] for fruit in fruits}
    return {f: scene.add("paper", f"{c} {shade}", yaw_rad=0.0, name=f"{c} area") for f, c in colours.items()}


def _shuffled(rng: np.random.Generator) -> list[str]:
    return [str(name) for name in rng.permutation(sorted(COLOUR_OF))]


def _goals(scene: Scene, placed: dict[str, Thing], areas: dict[str, Thing]) -> None:
    scene.ends_when_reached = False
    for fruit, thing in placed.items():
        if fruit in areas:
            scene.goal(thing, inside=areas[fruit])
        else:
            scene.goal(thing, off=list(areas.values()))


def _fruit(scene: Scene, fruit: str, on: Thing | None = None) -> Thing:
    return scene.add(fruit, f"{fruit} skin", on=on, name=fruit)


@task("fruit_placement/all_match", instruction=WORDS, horizon=HORIZON)
def all_match(scene: Scene, rng: np.random.Generator) -> None:
    """Sort three fruits onto papers of their colour."""
    chosen = _shuffled(rng)[:AREAS]
    areas = _areas(scene, chosen)
    _goals(scene, {fruit: _fruit(scene, fruit) for fruit in chosen}, areas)


@task("fruit_placement/no_area", instruction=WORDS, horizon=HORIZON)
def no_area(scene: Scene, rng: np.random.Generator) -> None:
    """Sort three fruits; a fourth has no paper of its colour and must stay off them."""
    chosen = _shuffled(rng)[: AREAS + 1]
    areas = _areas(scene, chosen[:AREAS])
    _goals(scene, {fruit: _fruit(scene, fruit) for fruit in chosen}, areas)


@task("fruit_placement/misplaced", instruction=WORDS, horizon=HORIZON)
def misplaced(scene: Scene, rng: np.random.Generator) -> None:
    """Sort three fruits; one lies on the paper of another colour at the start."""
    chosen = _shuffled(rng)[:AREAS]
    areas = _areas(scene, chosen)
    placed = {chosen[0]: _fruit(scene, chosen[0], on=areas[chosen[1]])}
    placed |= {fruit: _fruit(scene, fruit) for fruit in chosen[1:]}
    _goals(scene, placed, areas)


@task("fruit_placement/both", instruction=WORDS, horizon=HORIZON)
def both(scene: Scene, rng: np.random.Generator) -> None:
    """One fruit is misplaced, one has no paper, one is right already and one is still to be placed."""
    chosen = _shuffled(rng)[: AREAS + 1]
    areas = _areas(scene, chosen[:AREAS])
    placed = {
        chosen[0]: _fruit(scene, chosen[0], on=areas[chosen[1]]),
        chosen[2]: _fruit(scene, chosen[2], on=areas[chosen[2]]),
        chosen[1]: _fruit(scene, chosen[1]),
        chosen[3]: _fruit(scene, chosen[3]),
    }
    _goals(scene, placed, areas)
