"""Which things descriptions and example pictures lead to, and that absent ones lead to none."""

from __future__ import annotations

import numpy as np
import pytest

from tests.offline.vision.drawn import (
    BLUE,
    GREEN,
    NAVY,
    ORANGE,
    PURPLE,
    RED,
    WHITE,
    YELLOW,
    Drawing,
    alone,
    box_shape,
    dotted,
    plain,
    regular,
    round_shape,
    striped,
)  # fmt: skip
from wonderful_team.agents.scene import SceneShown
from wonderful_team.offline.answers.drafting import draft
from wonderful_team.offline.description import Description, Related, Relation, Superlative
from wonderful_team.offline.eyes import eyes_of_task
from wonderful_team.offline.vision import NotSeen, resolve, see, study_example
from wonderful_team.sims.tabletop import make_world

ROW = (
    Drawing()
    .add(box_shape((90, 80), 40, 40), plain(RED))
    .add(box_shape((230, 220), 70, 70), plain(RED))
    .add(round_shape((380, 90), 30), plain(BLUE))
    .add(box_shape((540, 200), 56, 56), plain(RED))
    .picture()
)


def middle(picture: object, description: Description) -> list[tuple[int, int]]:
    matches = resolve(see(picture), description, {})  # type: ignore[arg-type]
    return [(round(match.point[0], -1), round(match.point[1], -1)) for match in matches]


@pytest.mark.parametrize(
    ("superlative", "ordinal", "where"),
    [("largest", 1, (230, 220)), ("smallest", 1, (90, 80)), ("leftmost", 2, (230, 220)), ("rightmost", 1, (540, 200)),
     ("topmost", 1, (90, 80)), ("bottommost", 1, (230, 220)), ("middle", 1, (230, 220))],
)  # fmt: skip
def test_superlatives(superlative: Superlative, ordinal: int, where: tuple[int, int]) -> None:
    words = Description("block", "", colours=("red",), superlative=superlative, ordinal=ordinal)
    (found,) = middle(ROW, words)
    assert np.allclose(found, where, atol=10)


@pytest.mark.parametrize(
    ("relation", "wanted"),
    [("left_of", (230, 220)), ("right_of", (540, 200)), ("below", (230, 220)), ("nearest", (540, 200))],
)
def test_relations_to_another_thing(relation: Relation, wanted: tuple[int, int]) -> None:
    ball = Description("ball", "the blue ball", colours=("blue",))
    found = middle(ROW, Description("block", "", colours=("red",), related=(Related(relation, (ball,)),)))
    assert any(np.allclose(point, wanted, atol=10) for point in found[:2])
    missing = Description("ball", "the green ball", colours=("green",))
    assert middle(ROW, Description("block", "", colours=("red",), related=(Related(relation, (missing,)),))) == []


def test_what_is_far_away_is_not_next_to_a_thing() -> None:
    ball = Description("ball", "the blue ball", colours=("blue",))
    assert middle(ROW, Description("block", "", colours=("red",), related=(Related("near", (ball,)),))) == []


def test_everything_that_fits_comes_back_and_nothing_else() -> None:
    assert len(middle(ROW, Description("block", "red blocks", colours=("red",), quantity="all"))) == 3
    assert middle(ROW, Description("block", "green block", colours=("green",))) == []
    assert middle(ROW, Description("object", "striped", pattern="striped")) == []
    assert middle(ROW, Description("object", "star", shape="star")) == []
    assert middle(ROW, Description("block", "", colours=("red",), superlative="leftmost", ordinal=4)) == []


LOOKS = {
    "red star": (lambda c, t: regular(c, 36, 5, t, inner=0.45), plain(RED)),
    "red hexagon": (lambda c, t: regular(c, 32, 6, t), plain(RED)),
    "navy block": (lambda c, t: box_shape(c, 50, 50, t), plain(NAVY)),
    "blue block": (lambda c, t: box_shape(c, 50, 50, t), plain(BLUE)),
    "dotted disc": (lambda c, t: round_shape(c, 32), dotted(YELLOW, RED, 12)),
    "striped disc": (lambda c, t: round_shape(c, 32), striped(YELLOW, RED, 12)),
}


@pytest.mark.parametrize("wanted", LOOKS)
def test_an_example_picture_finds_its_thing_turned_and_only_that(wanted: str) -> None:
    outline, paint = LOOKS[wanted]
    examples = {"this": study_example(alone(outline((160, 120), 0.0), paint))}
    table = Drawing(seed=5)
    places = {name: (70 + 100 * k, 90 + 60 * (k % 3)) for k, name in enumerate(LOOKS) if k < 6}
    for name, (other, cover) in LOOKS.items():
        table.add(other(places[name], 37.0), cover)
    best = resolve(see(table.picture()), Description("object", "", like="this"), examples)[0]
    assert np.allclose(best.point, places[wanted], atol=12)
    rest = Drawing(seed=6)
    for name, (other, cover) in LOOKS.items():
        if name.split()[0] != wanted.split()[0]:
            rest.add(other(places[name], 37.0), cover)
    found = resolve(see(rest.picture()), Description("object", "", like="this"), examples)
    assert all(match.score < 0.5 for match in found)


def test_white_stripes_that_vanish_into_the_background_do_not_break_the_example() -> None:
    example = study_example(alone(box_shape((160, 120), 80, 80), striped(GREEN, WHITE, 16)))
    assert example.look.shapes
    assert example.look.shape in ("square", "diamond", "rectangle")
    assert example.area_view_px == pytest.approx(6400, rel=0.2)
    table = Drawing().add(box_shape((200, 150), 80, 80, 30), striped(GREEN, WHITE, 16))
    table.add(round_shape((450, 150), 45), plain(GREEN))
    assert resolve(see(table.picture()), Description("object", "", like="x"), {"x": example})[0].point[0] < 260


def test_an_example_of_a_texture_finds_another_shape_with_it() -> None:
    example = study_example(alone(box_shape((160, 120), 90, 90), dotted(PURPLE, YELLOW)))
    table = (
        Drawing()
        .add(regular((150, 150), 45, 3), dotted(PURPLE, YELLOW))
        .add(box_shape((420, 150), 80, 80), plain(YELLOW))
    )
    words = Description("object", "", like="x", like_only="texture")
    found = resolve(see(table.picture()), words, {"x": example})
    assert [round(match.point[0], -1) for match in found] == [150]


def test_a_plain_tray_whose_bottom_lies_in_shade_has_the_colour_of_its_rim() -> None:
    shade = (int(0.8 * RED[0]), int(0.8 * RED[1]), int(0.8 * RED[2]))
    table = (
        Drawing().add(box_shape((150, 150), 120, 120), plain(RED)).add(box_shape((150, 150), 106, 106), plain(shade))
    )
    table.add(round_shape((330, 150), 35), plain(RED)).add(round_shape((450, 150), 35), plain(PURPLE))
    tray = Description("object", "", shape="square")
    for relation in ("same_colour", "same_pattern"):
        same = Description("object", "", quantity="all", related=(Related(relation, (tray,)),))
        assert {round(match.point[0], -1) for match in resolve(see(table.picture()), same, {})} - {150} == {330}


def test_a_missing_example_is_named() -> None:
    with pytest.raises(NotSeen, match="no example picture 'gone'"):
        resolve(see(ROW), Description("object", "", like="gone"), {})
    with pytest.raises(NotSeen, match="nothing that stands out"):
        study_example(Drawing(200, 100, WHITE, noise=0, slope=0).picture("blank"))


def test_fruit_by_name_and_kind() -> None:
    table = (
        Drawing()
        .add(round_shape((100, 100), 26), plain(RED))
        .add(round_shape((250, 100), 25), plain(ORANGE))
        .add(round_shape((400, 100), 24, 18), plain(PURPLE))
        .add(box_shape((540, 100), 50, 50, 20), plain(GREEN))
        .picture()
    )
    scene = see(table)
    for name, x in (("apple", 100), ("orange", 250), ("plum", 400)):
        assert resolve(scene, Description("fruit", name, name=name), {})[0].point[0] == pytest.approx(x, abs=5)
    assert resolve(scene, Description("fruit", "banana", name="banana"), {}) == []
    assert len(resolve(scene, Description("fruit", "each fruit", quantity="each"), {})) == 3


def test_free_places_are_free_and_where_they_were_asked_for() -> None:
    scene = see(ROW)
    ball = Description("ball", "the blue ball", colours=("blue",))
    spots = resolve(scene, Description("area", "", related=(Related("left_of", (ball,)),)), {})
    assert spots[0].thing is None
    assert spots[0].point[0] < 340
    assert abs(spots[0].point[1] - 90) < 60
    for spot in resolve(scene, Description("area", "an empty area"), {}):
        assert all(spot.box.intersection(thing.box) is None or spot.box.iou(thing.box) < 0.05 for thing in scene.things)


def test_the_holes_of_a_plain_picture_are_part_of_the_shape_that_a_new_noun_means() -> None:
    world = make_world("novel_noun", seed=300000)
    try:
        task = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits).task
    finally:
        world.close()
    plan, _ = draft(task, with_targets=True)
    assert [target.words for target in plan.targets] == ["green object", "orange object"]


def test_things_of_the_same_colour_and_another_texture_are_not_meant_by_an_example() -> None:
    examples = {"this": study_example(alone(box_shape((160, 120), 20, 20), dotted(GREEN, YELLOW, 22)))}
    table = Drawing()
    alike, others = ((100, 80, 10), (230, 200, 35), (360, 90, 60)), ((160, 250, 20), (300, 250, 45), (500, 160, 70))
    for places, paint in ((alike, dotted(GREEN, YELLOW, 22)), (others, plain(GREEN))):
        for x, y, turn_deg in places:
            table.add(box_shape((x, y), 20, 20, turn_deg), paint)
    found = resolve(see(table.picture()), Description("object", "", like="this", quantity="all"), examples)
    assert sorted(round(match.point[0], -1) for match in found) == [100, 230, 360]


@pytest.mark.parametrize(("task", "seed"), [("sweep_without_touching", 1), ("sweep_without_exceeding", 107)])
def test_stripes_and_dots_of_the_same_two_colours_are_told_apart(task: str, seed: int) -> None:
    world = make_world(task, seed=seed)
    try:
        shown = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits).task
    finally:
        world.close()
    eyes = eyes_of_task(shown)
    (found,) = eyes.find(Description("object", "", like="swept_obj", quantity="all"))
    assert found.thing is not None
    assert found.thing.look.pattern == "striped"
