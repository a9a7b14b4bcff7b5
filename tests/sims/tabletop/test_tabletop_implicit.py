"""The paper's implicit goals with cards: what is asked follows from what the picture shows, and scorers tell right from wrong."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from PIL import Image
from shapely import Point

from wonderful_team.core.actions import PickPlace
from wonderful_team.sims.tabletop import make_world
from wonderful_team.sims.tabletop.goals import footprint_at
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import find_task

RANKING = [f"fruit_price_ranking/{name}" for name in ("three", "four", "discount", "deals")]
COMPANIONS = [f"superhero_companions/{name}" for name in ("exact", "similar", "two_coloured", "no_match")]
PAID = {"-50%": 0.5, "-20%": 0.8, "2 for 1": 0.5}


def lines_of(texture: str) -> list[str]:
    return texture.removeprefix("card: ").split(" / ")


def tags(truth: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """What is printed and what is to be paid, by fruit."""
    found = {}
    for name, thing in truth["things"].items():
        if thing["shape"] == "price tag":
            price, *deals = lines_of(thing["texture"])
            printed = float(price.removeprefix("$"))
            found[name.removeprefix("price of the ")] = (printed, printed * PAID[deals[0]] if deals else printed)
    return found


@pytest.mark.parametrize("name", RANKING)
def test_each_fruit_goes_into_the_bowl_of_its_rank_by_what_is_to_be_paid(name: str) -> None:
    mixed = 0
    for seed in range(12):
        scene = find_task(name).scene(seed)
        things = {thing.name: thing for thing in scene.things}
        prices = tags({"things": {n: {"shape": t.shape, "texture": t.texture} for n, t in things.items()}})
        goes_to = {goal.thing: goal.inside[0] for goal in scene.goals}
        ordered = sorted(prices, key=lambda fruit: -prices[fruit][1])
        for fruit, rank in zip(ordered, ("1st", "2nd", "3rd", "4th"), strict=False):
            # The label that is nearest to the bowl says its rank.
            bowl = things[goes_to[fruit]]
            labels = [thing for thing in scene.things if thing.shape == "label"]
            nearest = min(labels, key=lambda label: abs(label.y_m - bowl.y_m) + abs(label.x_m - bowl.x_m))
            assert lines_of(nearest.texture) == [rank]
        mixed += ordered != sorted(prices, key=lambda fruit: -prices[fruit][0])
    assert mixed == (12 if "discount" in name or "deals" in name else 0)


@pytest.mark.parametrize("name", COMPANIONS)
def test_each_waiting_item_has_one_companion_of_its_colour_at_most(name: str) -> None:
    for seed in range(12):
        scene = find_task(name).scene(seed)
        inside: dict[str, list[str]] = {}
        odd = [goal.thing for goal in scene.goals if goal.off]
        for goal in scene.goals:
            for place in goal.inside:
                inside.setdefault(place, []).append(goal.thing)
        assert sorted(map(len, inside.values())) == [2, 2, 2]
        for pair in inside.values():
            colours = {re.sub("unmatched | item.*", "", thing) for thing in pair}
            assert len(colours) == 1
        assert len(odd) == (1 if "no_match" in name else 0)


@pytest.mark.parametrize("name", [*RANKING, *COMPANIONS])
def test_things_stand_apart_on_the_table(name: str) -> None:
    for seed in range(12):
        placed = {
            t.name: footprint_at(t, t.x_m, t.y_m, t.yaw_rad).convex_hull for t in find_task(name).scene(seed).things
        }
        kinds: dict[str, Thing] = {thing.name: thing for thing in find_task(name).scene(seed).things}
        for one, shape in placed.items():
            low_x, low_y, high_x, high_y = shape.bounds
            assert (low_x, low_y) >= (0.25, -0.5), one
            assert high_x <= 0.75, one
            assert high_y <= 0.5, one
            for other, cover in placed.items():
                within = kinds[other].shape == "container" and cover.contains(shape)
                assert one == other or within or kinds[one].shape == "container" or shape.distance(cover) > 0.002, other


@pytest.mark.parametrize("name", ["fruit_price_ranking/deals", "superhero_companions/exact"])
def test_cards_can_be_read_in_the_picture(name: str) -> None:
    """By an OCR engine, in the view enlarged as it is for models."""
    rapidocr = pytest.importorskip("rapidocr")
    engine = rapidocr.RapidOCR(params={"Global.use_cls": False, "Global.log_level": "error"})
    world = make_world(name, seed=3)
    view, camera = world.observe().main, world.observe().main.camera
    picture = Image.fromarray(view.rgb).resize((view.rgb.shape[1] * 3, view.rgb.shape[0] * 3), Image.Resampling.LANCZOS)
    said = engine(np.asarray(picture))
    read = {
        text.replace(" ", ""): corners.mean(axis=0) / 3 for text, corners in zip(said.txts, said.boxes, strict=True)
    }
    cards = [t for t in world.privileged.truth()["things"].values() if t["texture"].startswith("card: ")]
    assert cards
    for card in cards:
        for line in lines_of(card["texture"]):
            at = read[line.replace(" ", "")]
            (where,) = camera.project([card["position_m"]])
            assert Point(at).distance(Point(where)) < 20
    world.close()


def put(world: Any, thing: str, into: str, aside_m: tuple[float, float] = (0.0, 0.0)) -> None:
    things = world.privileged.truth()["things"]
    x, y, _ = things[into]["position_m"]
    place = np.array([x + aside_m[0], y + aside_m[1], 0.006])
    world.execute(PickPlace(np.array(things[thing]["grasp_m"]), place, 0.0))


def test_two_fruits_in_each_others_bowls_are_wrong() -> None:
    world = make_world("fruit_price_ranking/three", seed=5)
    first, second, third = [(goal["thing"], goal["inside"][0]) for goal in world.privileged.truth()["goals"]]
    put(world, first[0], second[1])
    put(world, third[0], third[1])
    assert not world.privileged.score().success
    put(world, second[0], first[1])
    score = world.privileged.score()
    assert not score.success
    assert first[0] in score.reason
    assert second[0] in score.reason
    assert third[0] not in score.reason
    world.close()


@pytest.mark.parametrize(
    ("spoil", "success"),
    [("nothing", True), ("another's bin", False), ("the odd one with a hero", False), ("a resident taken out", False)],
)
def test_companions_are_right_only_when_every_item_is_where_it_belongs(spoil: str, success: bool) -> None:
    world = make_world("superhero_companions/no_match", seed=2)
    goals = world.privileged.truth()["goals"]
    waiting = [(g["thing"], g["inside"][0]) for g in goals if g["inside"] and g["thing"].startswith("unmatched")]
    odd = next(g["thing"] for g in goals if g["off"])
    resident = next(g["thing"] for g in goals if g["inside"] and not g["thing"].startswith("unmatched"))
    for number, (thing, place) in enumerate(waiting):
        wrong = waiting[(number + 1) % 3][1] if spoil == "another's bin" and number == 0 else place
        put(world, thing, wrong, (0.0 if wrong == place else 0.045, 0.046))
    if spoil == "the odd one with a hero":
        put(world, odd, waiting[0][1], (0.0, -0.01))
    if spoil == "a resident taken out":
        put(world, resident, odd, (0.12, 0.0))
    assert world.privileged.score().success is success, world.privileged.score()
    world.close()


def test_simulated_models_call_fruits_and_cards_as_people_do() -> None:
    world = make_world("fruit_price_ranking/deals", seed=3)
    said = {thing.words for thing in world.privileged.things().values()}
    assert {"banana", "apple", "lime", "plum", "price tag that says $7.00 / -20%", "label that says 1st"} <= said
    world.close()
