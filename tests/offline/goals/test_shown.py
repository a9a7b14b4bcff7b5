"""Goals, sequences and new words that the instruction's pictures show."""

from __future__ import annotations

import pytest

from tests.offline.answers.tables import KINDS, ask, picture, slot, table
from wonderful_team.contracts import DraftPlan, PlanDraft, ReadScene, SceneReading, ShownSlot, ShownTask
from wonderful_team.core.values import View
from wonderful_team.errors import NotUnderstoodError

NOW = (("square", "red", 100, 80, 24), ("star", "blue", 300, 80, 30), ("triangle", "green", 500, 80, 30))


def _slot(name: str, kind: str, view: View, index: int | None = None) -> ShownSlot:
    return ShownSlot(name, kind, (picture(view),), index)  # type: ignore[arg-type]


def _task(text: str, *slots: ShownSlot, now: View | None = None) -> ShownTask:
    return ShownTask(text, (picture(now or table(*NOW)),), slots)


def _draft(task: ShownTask) -> PlanDraft:
    answer = ask(DraftPlan(task, KINDS, True, ()))
    assert isinstance(answer, PlanDraft)
    return answer


GOAL = table(("square", "red", 100, 240, 24), ("star", "blue", 300, 80, 30), ("triangle", "green", 520, 240, 30))


@pytest.mark.parametrize(
    "text",
    ["Rearrange to this {scene}.", "Make the table look like {scene}.", "Put everything where {scene} shows it."],
)
def test_a_goal_picture_moves_what_differs_to_where_it_shows_it(text: str) -> None:
    task = _task(text, _slot("scene", "scene", GOAL))
    plan = _draft(task)
    moved = [target for target in plan.targets if "pick" in target.use]
    assert [target.words for target in moved] == ["red object", "green object"]
    places = tuple(target.to_target() for target in plan.targets if target.kind == "area")
    reading = ask(ReadScene(places, (), task.main, (), task.slots))
    assert isinstance(reading, SceneReading)
    points = [entry.points[0].point.as_tuple for entry in reading.targets]
    for point, wanted in zip(points, ((100, 240), (520, 240)), strict=True):
        assert point == pytest.approx(wanted, abs=8)


def test_what_lies_on_a_place_is_brought_away_first_and_restore_brings_back() -> None:
    now = table(*NOW, ("disc", "yellow", 100, 240, 22))
    task = _task("Rearrange objects to this setup {scene} and then restore.", _slot("scene", "scene", GOAL), now=now)
    texts = [subgoal.text for subgoal in _draft(task).subgoals]
    assert texts[0] == "put the yellow object into the free area"
    assert [text for text in texts if "back to its original place" in text] == [
        "put the green object back to its original place",
        "put the red object back to its original place",
    ]


def test_frames_are_followed_step_by_step() -> None:
    frames = [
        table(("square", "red", 100, 80, 24), *NOW[1:]),
        table(("square", "red", 200, 240, 24), *NOW[1:]),
        table(("square", "red", 400, 240, 24), *NOW[1:]),
    ]
    slots = [_slot(f"f{k}", "frame", view, k) for k, view in enumerate(frames)]
    plan = _draft(_task("Follow this motion for {it}: {f0} {f1} {f2}.", *slots, slot("it", "square", "red")))
    assert [subgoal.after for subgoal in plan.subgoals] == [[], ["G1"]]
    assert [target.like for target in plan.targets if target.kind == "area"] == [["f0", "f1"], ["f1", "f2"]]


def test_nouns_are_defined_by_pictures_that_show_their_shape() -> None:
    grey = slot("a", "star", "grey")
    text = "This is a blicket {a}. This is a zup {b}. Put a blicket onto a zup."
    plan = _draft(_task(text, grey, slot("b", "triangle", "grey")))
    assert [target.like for target in plan.targets] == [["a"], ["b"]]
    reading = ask(
        ReadScene(
            tuple(t.to_target() for t in plan.targets),
            (),
            picture(table(*NOW)),
            (),
            (grey, slot("b", "triangle", "grey")),
        )
    )
    assert isinstance(reading, SceneReading)
    boxes = [entry.box.as_box.centre for entry in reading.targets if entry.box is not None]
    assert [round(x, -2) for x, _ in boxes] == [300, 500]


def test_an_adjective_is_defined_by_pairs() -> None:
    pairs = [
        slot("a1", "star", "yellow"),
        slot("b1", "star", "blue"),
        slot("a2", "disc", "yellow"),
        slot("b2", "disc", "purple"),
    ]
    text = "{a1} is daxer than {b1}. {a2} is daxer than {b2}. Put the less daxer square onto the star."
    now = table(("square", "yellow", 100, 80, 24), ("square", "purple", 300, 80, 24), ("star", "green", 500, 80, 30))
    (subgoal,) = _draft(_task(text, *pairs, now=now)).subgoals
    assert subgoal.text == "put the darkest square onto the star"


def test_a_new_word_that_nothing_defines_is_refused() -> None:
    with pytest.raises(NotUnderstoodError, match="blicket"):
        _draft(_task("Put the blicket onto the {a}.", slot("a", "star", "blue")))
