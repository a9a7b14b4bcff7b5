"""For every kind of target: a crop of noise, of nothing, or of another place is never accepted as the box it carries."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.offline.answers.tables import SIZE, ask, picture, slot, table
from wonderful_team.contracts import BoxVerdict, JudgeBox, ShownSlot
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark
from wonderful_team.core.values import Target, View
from wonderful_team.images import crop

THINGS = (("square", "red", 80, 80, 26), ("star", "green", 500, 80, 36), ("disc", "yellow", 520, 240, 30))
SCENE = table(*THINGS)
GOAL = table(("star", "green", 300, 200, 36))
STAR = Box(465, 44, 535, 110)
FREE = Box(270, 170, 330, 230)
SLOTS: tuple[ShownSlot, ...] = (
    slot("a", "star", "green"),
    ShownSlot("goal", "scene", (picture(GOAL),)),
    slot("frame", "bar", "purple"),
)

KINDS = [
    ("object in words", Target("T1", "object", "green star"), STAR),
    ("object like a picture", Target("T1", "object", "the object shown in {a}", like=("a",), source="slot"), STAR),
    ("object like a picture alone", Target("T1", "object", "the doodah", like=("a",), source="slot"), STAR),
    ("coloured area", Target("T1", "area", "yellow area"), Box(490, 210, 550, 270)),
    ("free area", Target("T1", "area", "free area"), FREE),
    ("free area by a relation", Target("T1", "area", "free area", where="left of the green star"), FREE),
    ("place shown in a picture", Target("T1", "area", "place of the green star", like=("goal",), source="slot"),
     Box(265, 165, 335, 235)),
    ("stop on a way", Target("T1", "area", "free area for the red square", where="before the object shown in {frame}",
                             like=("frame",), source="slot"), FREE),
    ("end of a way", Target("T1", "area", "free area for the red square", where="inside the object shown in {frame}",
                            like=("frame",), source="slot"), FREE),
]  # fmt: skip
IDS = [name for name, _, _ in KINDS]


def verdict(target: Target, view: View, box: Box) -> str:
    shown = crop(view, box, "crop")
    examples = tuple(item for item in SLOTS if item.name in target.like)
    answer = ask(JudgeBox(target, shown.marked(BoxMark(shown.frame.box_to_picture(box))), examples))
    assert isinstance(answer, BoxVerdict)
    return answer.decision


def view_of(rgb: Array) -> View:
    return View("top", "top", 0.0, np.ascontiguousarray(rgb))


@pytest.mark.parametrize(("name", "target", "box"), KINDS, ids=IDS)
def test_the_right_box_is_accepted(name: str, target: Target, box: Box) -> None:
    assert verdict(target, SCENE, box) == "accept"


@pytest.mark.parametrize(("name", "target", "box"), KINDS, ids=IDS)
@settings(deadline=None, max_examples=6)
@given(seed=st.integers(0, 10_000), coarse=st.sampled_from([1, 2, 4]))
def test_noise_is_never_accepted(name: str, target: Target, box: Box, seed: int, coarse: int) -> None:
    random = np.random.default_rng(seed)
    grid = random.integers(0, 256, (SIZE[1] // coarse, SIZE[0] // coarse, 3)).astype(np.uint8)
    rgb = grid.repeat(coarse, axis=0).repeat(coarse, axis=1)
    assert verdict(target, view_of(rgb), box) != "accept"


@pytest.mark.parametrize("value", [0, 255])
@pytest.mark.parametrize(("name", "target", "box"), KINDS, ids=IDS)
def test_a_lost_picture_is_never_accepted(name: str, target: Target, box: Box, value: int) -> None:
    assert verdict(target, view_of(np.full((SIZE[1], SIZE[0], 3), value, np.uint8)), box) != "accept"


@pytest.mark.parametrize(("name", "target", "box"), KINDS, ids=IDS)
def test_a_box_elsewhere_is_never_accepted(name: str, target: Target, box: Box) -> None:
    """On another thing, whatever the target is."""
    elsewhere = Box(54, 54, 107, 107)
    assert verdict(target, SCENE, elsewhere) != "accept"


@pytest.mark.parametrize(("name", "target", "box"), KINDS[:4], ids=IDS[:4])
def test_a_flipped_picture_is_not_accepted_where_the_thing_lay(name: str, target: Target, box: Box) -> None:
    assert verdict(target, view_of(SCENE.rgb[:, ::-1]), box) != "accept"


def test_what_covers_a_free_area_changes_the_verdict_but_not_that_of_a_shown_place() -> None:
    covered = table(*THINGS, ("disc", "blue", 300, 200, 28))
    assert verdict(KINDS[4][1], covered, FREE) != "accept"
    assert verdict(KINDS[7][1], covered, FREE) != "accept"
    # A place that a goal picture shows is that place, whatever lies there now: the plan clears it first.
    assert verdict(KINDS[6][1], covered, Box(265, 165, 335, 235)) == "accept"


def test_a_shown_place_on_another_table_is_not_accepted() -> None:
    other = view_of(np.full((SIZE[1], SIZE[0], 3), (40, 60, 90), np.uint8))
    assert verdict(KINDS[6][1], other, Box(265, 165, 335, 235)) != "accept"
