"""The paper's implicit-goal task with price tags: rank fruits by what they cost after discounts, in four variations."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.prints import card_texture
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.fruit_placement import COLOUR_OF

WORDS = (
    "Based on the price tags and any discounts on the fruits, rank them from the most expensive to the cheapest and place "
    "them in the corresponding bowl."
)
HORIZON = 8
RANKS = ("1st", "2nd", "3rd", "4th")
DISCOUNTS = {"-50%": 0.5, "-20%": 0.8, "2 for 1": 0.5}
"""What may stand on a tag under the price, and what of the price is to be paid for one fruit."""
APART = 1.2
"""How many times as much each fruit costs at least as the next cheaper one, so that no reader has to split cents."""
FRUIT_X_M, TAG_X_M, BOWL_X_M, RANK_X_M = 0.309, 0.409, 0.577, 0.725
COLUMNS_M = {3: 0.3, 4: 0.245}
"""From the middle of one column to that of the next [m]."""
LOOSE_M = 0.012
"""How far a fruit with its tag stands from the middle of its column at most [m]."""
TRIES = 1000


def _prices(rng: np.random.Generator, count: int, discounts: int) -> list[tuple[float, str]]:
    """A price and a discount, "" for none, for each fruit.

    With discounts the order of what is printed differs from that of what is to be paid.
    """
    for _ in range(TRIES):
        printed = [float(cents) / 100 for cents in rng.choice(np.arange(100, 1000, 50), size=count, replace=False)]
        which = rng.choice(count, size=discounts, replace=False)
        drawn = {int(k): str(rng.choice(list(DISCOUNTS))) for k in which}
        paid = [price * DISCOUNTS.get(drawn.get(k, ""), 1.0) for k, price in enumerate(printed)]
        ordered = sorted(paid)
        apart = all(b >= APART * a for a, b in zip(ordered, ordered[1:], strict=False))
        if apart and (not discounts or np.argsort(paid).tolist() != np.argsort(printed).tolist()):
            return [(price, drawn.get(k, "")) for k, price in enumerate(printed)]
    raise AssertionError("no prices that differ enough")


def _set_table(
    scene: Scene, rng: np.random.Generator, count: int, *, discounts: int = 0, mixed_up: bool = False
) -> None:
    """A column for each fruit with its tag; bowls with their ranks below, from the left or mixed up."""
    scene.ends_when_reached = False
    fruits = [str(name) for name in rng.permutation(sorted(COLOUR_OF))[:count]]
    prices = _prices(rng, count, discounts)
    ranks = [int(k) for k in rng.permutation(count)] if mixed_up else list(range(count))
    colour = scene.pick_textures(1)[0]
    bowls = {}
    placed = []
    apart = min(COLUMNS_M[count], 2 * (scene.side_m - LOOSE_M) / (count - 1))
    for column, (fruit, (price, discount)) in enumerate(zip(fruits, prices, strict=True)):
        y = apart * (column - (count - 1) / 2)
        rank = RANKS[ranks[column]]
        bowls[ranks[column]] = scene.add("bowl", colour, at=(BOWL_X_M, y), yaw_rad=0.0, name=f"bowl {rank}")
        scene.add("label", card_texture(rank), at=(RANK_X_M, y), yaw_rad=0.0, name=f"label {rank}")
        aside = y + float(scene.layout.uniform(-LOOSE_M, LOOSE_M))
        lines = (f"${price:.2f}", discount) if discount else (f"${price:.2f}",)
        scene.add("price tag", card_texture(*lines), at=(TAG_X_M, aside), yaw_rad=0.0, name=f"price of the {fruit}")
        turn = 0.0 if fruit == "banana" else float(scene.layout.uniform(-math.pi, math.pi))
        placed.append(
            (
                price * DISCOUNTS.get(discount, 1.0),
                scene.add(fruit, f"{fruit} skin", at=(FRUIT_X_M, aside), yaw_rad=turn, name=fruit),
            )
        )
    for rank_number, (_, thing) in enumerate(sorted(placed, key=lambda item: -item[0])):
        scene.goal(thing, inside=bowls[rank_number])


@task("fruit_price_ranking/three", instruction=WORDS, horizon=HORIZON)
def three(scene: Scene, rng: np.random.Generator) -> None:
    """Rank three fruits by their price tags into three bowls."""
    _set_table(scene, rng, 3)


@task("fruit_price_ranking/four", instruction=WORDS, horizon=HORIZON)
def four(scene: Scene, rng: np.random.Generator) -> None:
    """Rank four fruits by their price tags; the bowls stand in any order."""
    _set_table(scene, rng, 4, mixed_up=True)


@task("fruit_price_ranking/discount", instruction=WORDS, horizon=HORIZON)
def discount(scene: Scene, rng: np.random.Generator) -> None:
    """Rank three fruits by price; a discount on one tag changes the order."""
    _set_table(scene, rng, 3, discounts=1)


@task("fruit_price_ranking/deals", instruction=WORDS, horizon=HORIZON)
def deals(scene: Scene, rng: np.random.Generator) -> None:
    """Rank four fruits by price; deals on two tags change the order, and the bowls stand in any order."""
    _set_table(scene, rng, 4, discounts=2, mixed_up=True)
