"""Questions that only rivals ask: answered from truth where the pictures show it, blind where they do not, with the profile's errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.simulated.image_corruption import CHANGES, ImageCorruption
from tests.simulated.tables import Set
from wonderful_team.contracts import (
    ListedObject,
    ListObjects,
    PlanDirectly,
    PlanFromList,
    SelectMarks,
    SlotWords,
)
from wonderful_team.core.pictures import Candidates
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.simulated import PROFILES, SimulatedModel


def blind(table: Set) -> ImageCorruption:
    return ImageCorruption(table.model, CHANGES["flipped"])


def erring(table: Set, **errors: Any) -> SimulatedModel:
    profile = replace(PROFILES["perfect"], name="erring", **errors)
    return SimulatedModel(table.world.privileged, table.world.instruction, profile)


def marks(table: Set) -> SelectMarks:
    """Marks in a row across the thing that is carried; the fourth is in its middle, the fifth at its edge."""
    target = table.targets()[0]
    (name,) = [one for one, thing in table.truth.things().items() if thing.words == target.words]
    box = table.shown_box(name)
    x, y = box.centre
    points = tuple((x + step * box.width / 4, y) for step in (-8, -6, -4, 0, 1, 4))
    return SelectMarks(target, "pick", table.scene.views[0].marked(Candidates(points)), 2, table.scene.slots)


def listed(table: Set, shift: int = 0, **more: Any) -> PlanFromList:
    """The plan asked for from words alone."""
    said = table.ask(ListObjects(table.scene.views[0], table.scene.slots))
    objects = tuple(ListedObject(item.name, round(item.point.x) + shift, round(item.point.y)) for item in said.objects)
    words = tuple(SlotWords(item.picture, item.words) for item in said.pictures)
    given: dict[str, Any] = {"objects": objects, "slot_words": words, "thoughts": True, "example": "none", **more}
    return PlanFromList(
        table.world.instruction.text, given.pop("objects"), given.pop("slot_words"), "top view",
        table.scene.views[0].size_px, ("pick_place",), **given,
    )  # fmt: skip


def test_a_whole_plan_needs_pictures_that_are_true(table: Set) -> None:
    question = PlanDirectly(table.scene.task, ("pick_place",))
    plan = table.ask(question)
    assert [target.box is not None for target in plan.targets] == [True, True]
    with pytest.raises(NotUnderstoodError, match="pictures are meant"):
        table.ask(question, blind(table))


def test_marks_on_the_thing_come_first_then_the_nearest(table: Set) -> None:
    question = marks(table)
    assert set(table.ask(question).numbers) <= {4, 5}
    assert len(table.ask(question).numbers) == 2
    assert table.ask(question, blind(table)).numbers == []
    wrong = {tuple(table.ask(question, erring(table, wrong_choice=1.0), f"q{k}").numbers) for k in range(8)}
    assert len(wrong) > 1


def test_a_list_holds_what_shows_and_is_off_by_the_profiles_spread(table: Set) -> None:
    question = ListObjects(table.scene.views[0], table.scene.slots)
    said = table.ask(question)
    assert {item.name for item in said.objects} == {thing.words for thing in table.truth.things().values()}
    assert [item.picture for item in said.pictures] == [slot.name for slot in table.scene.slots]
    assert table.ask(question, blind(table)).objects == []
    off = table.ask(question, erring(table, spread=(0.02, 0.02)))
    moved = [
        np.hypot(one.point.x - other.point.x, one.point.y - other.point.y)
        for one, other in zip(said.objects, off.objects, strict=True)
    ]
    assert 2 < np.mean(moved) < 100


def test_a_plan_from_words_takes_the_lists_coordinates(table: Set) -> None:
    right, off = table.ask(listed(table)), table.ask(listed(table, shift=40))
    for one, other in zip(right.targets, off.targets, strict=True):
        assert other.points[0].x - one.points[0].x == 40
    assert right.thoughts
    assert not hasattr(table.ask(listed(table, thoughts=False)), "thoughts")


def test_a_plan_from_words_takes_another_line_as_often_as_the_profile_says(table: Set) -> None:
    question = listed(table)

    def taken(**errors: Any) -> list[tuple[float, float]]:
        return [(one.points[0].x, one.points[0].y) for one in table.ask(question, erring(table, **errors)).targets]

    right, lines = taken(), {(float(item.x), float(item.y)) for item in question.objects}
    wrong = taken(wrong_thing=1.0)
    assert set(wrong) <= lines
    assert all(one != other for one, other in zip(wrong, right, strict=True))
    pairs = [pair for seed in range(60) for pair in zip(taken(wrong_thing=0.3, seed=seed), right, strict=True)]
    # 120 draws: four standard deviations.
    assert sum(one != other for one, other in pairs) / len(pairs) == pytest.approx(0.3, abs=0.17)


def test_a_plan_from_words_fails_where_the_words_do_not_say_what_it_needs(table: Set) -> None:
    with pytest.raises(NotUnderstoodError, match="the list names no 'pink letter R'; it names nothing"):
        table.ask(listed(table, objects=()))
    with pytest.raises(NotUnderstoodError, match="which is not known"):
        table.ask(replace(listed(table), picture="another view"))
    wrong = (SlotWords("dragged_obj_1", "nothing that was ever there"), SlotWords("base_obj", "red paisley pan"))
    with pytest.raises(NotUnderstoodError, match="nobody says what dragged_obj_1 really shows"):
        table.ask(listed(table, slot_words=wrong))


def test_pictures_shown_beside_a_list_have_to_be_true(table: Set) -> None:
    question = listed(table, views=table.scene.views, slots=table.scene.slots)
    assert table.ask(question).steps
    with pytest.raises(NotUnderstoodError, match="nothing that was ever there"):
        table.ask(question, blind(table))
