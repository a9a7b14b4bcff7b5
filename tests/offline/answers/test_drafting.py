"""DraftPlan, RevisePlan and ExtractTargets on drawn tables."""

from __future__ import annotations

import pytest

from tests.offline.answers.tables import KINDS, ask, draft, slot, table, task
from wonderful_team.contracts import DraftPlan, ExtractTargets, PlanDraft, PlanRevision, RevisePlan, TargetList
from wonderful_team.core.values import Critique, Subgoal
from wonderful_team.errors import NotUnderstoodError

SCENE = table(
    ("square", "red", 80, 80, 26),
    ("square", "blue", 300, 160, 52),
    ("star", "green", 500, 80, 36),
    ("disc", "yellow", 520, 240, 30),
)
TWO_RED = table(("square", "red", 80, 80, 26), ("square", "red", 150, 240, 26), ("square", "blue", 400, 160, 60))


def test_put_names_the_thing_then_its_place() -> None:
    plan = draft("Put the green star into the blue square.", SCENE)
    assert [goal.text for goal in plan.subgoals] == ["put the green star into the blue square"]
    assert [(t.words, t.use) for t in plan.targets] == [("green star", ["pick"]), ("blue square", ["place"])]
    assert plan.mode == "one_step"


def test_pictured_targets_carry_their_pictures() -> None:
    plan = draft("Put the {a} into the {b}.", SCENE, slot("a", "star", "green"), slot("b", "square", "blue"))
    assert [t.like for t in plan.targets] == [["a"], ["b"]]


def test_a_picture_that_was_not_given_is_refused() -> None:
    with pytest.raises(NotUnderstoodError, match=r"\{b\}.*pictures: a"):
        draft("Put the {a} into the {b}.", SCENE, slot("a", "star", "green"))


def test_all_is_instantiated_in_the_picture() -> None:
    plan = draft("put all red squares onto the blue square", TWO_RED)
    assert len(plan.subgoals) == 2
    assert len({t.words for t in plan.targets if "pick" in t.use}) == 2


def test_two_that_fit_equally_are_a_question() -> None:
    plan = draft("put the red square onto the blue square", TWO_RED)
    assert plan.clarification is not None
    assert len(plan.clarification.choices) == 2
    assert "top left" in plan.clarification.choices[0]
    assert draft("put the leftmost red square onto the blue square", TWO_RED).clarification is None


def test_each_to_its_colour_leaves_out_what_is_there_and_what_has_no_place() -> None:
    view = table(
        ("square", "red", 130, 230, 70), ("square", "yellow", 480, 230, 70), ("disc", "yellow", 480, 230, 26),
        ("disc", "red", 300, 80, 26), ("disc", "purple", 560, 70, 26),
    )  # fmt: skip
    plan = draft("Put each ball onto the square of its colour, if there is one.", view)
    assert [goal.text for goal in plan.subgoals] == ["put the red ball into the red square"]
    assert "no purple square" in plan.reasoning


def test_nothing_to_do_is_an_empty_plan() -> None:
    view = table(("square", "blue", 300, 160, 70), ("disc", "yellow", 300, 160, 26))
    plan = draft("put the yellow ball onto the blue square", view)
    assert plan.subgoals == []
    assert plan.clarification is None
    assert "already on blue square" in plan.reasoning


def test_what_is_absent_is_asked_about_by_name() -> None:
    plan = draft("put the purple star onto the blue square", SCENE)
    assert plan.subgoals == []
    assert plan.clarification is not None
    assert "No purple star is in the picture" in plan.clarification.question
    assert "the green object (top right)" in plan.clarification.choices


def test_then_orders_subgoals() -> None:
    plan = draft("put the green star onto the blue square, then put the yellow ball onto the red square", SCENE)
    assert [goal.after for goal in plan.subgoals] == [[], ["G1"]]


def test_stacking_puts_the_lower_one_first() -> None:
    plan = draft("Stack the green star on the red square on the blue square", SCENE)
    assert [goal.text for goal in plan.subgoals] == [
        "put the red square onto the blue square",
        "put the green star onto the red square",
    ]
    assert plan.subgoals[1].after == ["G1"]


def test_advice_never_drops_a_stated_word() -> None:
    text = "put the dark striped green star onto the blue square"
    plan = draft(text, SCENE, advice=("T1 (dark green striped star) was not found in the picture.",))
    assert plan.clarification is not None
    assert "No dark green striped star is in the picture" in plan.clarification.question


def test_without_targets_the_lists_stay_empty() -> None:
    plan = ask(DraftPlan(task("put the green star onto the blue square", SCENE), KINDS, False))
    assert isinstance(plan, PlanDraft)
    assert plan.targets == []
    assert plan.subgoals[0].targets == []


def test_targets_are_extracted_from_anyones_subgoals() -> None:
    goals = (
        Subgoal("G1", "Move the emerald star inside the blue square."),
        Subgoal("G2", "Place the yellow disc left of the blue square"),
    )
    answer = ask(ExtractTargets(task("put them in", SCENE), goals))
    assert isinstance(answer, TargetList)
    assert [t.words for t in answer.targets] == ["green star", "blue square", "yellow circle"]
    assert [need.targets for need in answer.needs] == [["T1", "T2"], ["T3", "T2"]]


def test_a_right_doubt_changes_the_plan_and_a_wrong_one_does_not() -> None:
    shown = task("put the green star onto the blue square", SCENE)
    plan = draft("put the green star onto the blue square", SCENE)
    doubt = Critique("G1", "wrong_target", "Is it the right thing?")
    kept = ask(RevisePlan(shown, KINDS, plan.to_subgoals(), plan.to_targets(), doubt, True))
    assert isinstance(kept, PlanRevision)
    assert kept.decision == "keep"
    wrong = (Subgoal("G1", "put the red square onto the blue square", targets=("T1", "T2")),)
    changed = ask(RevisePlan(shown, KINDS, wrong, plan.to_targets(), doubt, True))
    assert isinstance(changed, PlanRevision)
    assert changed.plan is not None
    assert changed.plan.subgoals[0].text == "put the green star onto the blue square"


def test_what_shows_through_a_hole_is_not_brought_away() -> None:
    held = table(("square", "blue", 300, 160, 70), ("ring", "red", 300, 160, 36), ("disc", "green", 520, 160, 50))
    texts = [subgoal.text for subgoal in draft("put the red circle into the green circle", held).subgoals]
    assert len(texts) == 1
    assert "red" in texts[0]
