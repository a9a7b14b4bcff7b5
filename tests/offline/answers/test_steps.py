"""WriteSteps and ReviewSteps."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.offline.answers.tables import KINDS, ask, draft, table, task
from wonderful_team.contracts import PlanReview, ReviewSteps, StepList, WriteSteps
from wonderful_team.core.actions import ARM, At, Beside, OriginOf, PickPlaceStep, PushStep, RotateGripperStep, Step
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PathMark, Picture
from wonderful_team.core.values import Subgoal, Target
from wonderful_team.errors import UnsupportedQuestion

SCENE = table(
    ("square", "red", 80, 80, 26),
    ("square", "blue", 300, 160, 52),
    ("star", "green", 500, 80, 36),
    ("disc", "yellow", 520, 240, 30),
)


def steps_for(text: str, kinds: tuple[str, ...] = KINDS) -> tuple[Step, ...]:
    plan = draft(text, SCENE)
    answer = ask(WriteSteps(task(text, SCENE), kinds, plan.to_subgoals(), plan.to_targets()))
    assert isinstance(answer, StepList)
    return answer.to_steps()


def test_put_on() -> None:
    (step,) = steps_for("put the green star onto the blue square")
    assert step == PickPlaceStep("G1", "T1", At("T2"), 0.0)


def test_rotate_keeps_the_place() -> None:
    (step,) = steps_for("rotate the green star by 60 degrees counterclockwise")
    assert step == PickPlaceStep("G1", "T1", OriginOf("T1"), -60.0)


@pytest.mark.parametrize(
    ("words", "side"),
    [("to the left of", "left"), ("right of", "right"), ("behind", "above"), ("in front of", "below")],
)
def test_sides(words: str, side: str) -> None:
    (step,) = steps_for(f"put the green star {words} the blue square")
    assert step == PickPlaceStep("G1", "T1", Beside("T2", side), 0.0)  # type: ignore[arg-type]


def test_next_to_takes_a_free_side() -> None:
    (step,) = steps_for("put the green star next to the red square")
    assert isinstance(step, PickPlaceStep)
    assert isinstance(step.place, Beside)
    assert step.place.side in ("right", "below")


def test_back_to_its_origin() -> None:
    steps = steps_for("put the green star onto the blue square, then put it back")
    assert steps == (PickPlaceStep("G1", "T1", At("T2"), 0.0), PickPlaceStep("G2", "T1", OriginOf("T1"), 0.0))


def test_order_respects_after() -> None:
    plan = draft("put the green star onto the blue square and put the yellow ball onto the red square", SCENE)
    first, second = plan.to_subgoals()
    goals = (replace(first, after=("G2",)), second)
    answer = ask(WriteSteps(task("x", SCENE), KINDS, goals, plan.to_targets()))
    assert isinstance(answer, StepList)
    assert [step.subgoal for step in answer.to_steps()] == ["G2", "G1"]


def test_push() -> None:
    (step,) = steps_for("push the yellow ball to the blue square", ("push",))
    assert step == PushStep("G1", At("T1"), At("T2"))


def test_arm() -> None:
    steps = steps_for("put the green star onto the blue square", ARM.step_kinds)
    assert [step.kind for step in steps] == [
        "open", "move", "move", "move", "close", "move", "move", "move", "open", "move", "home",
    ]  # fmt: skip
    turned = steps_for("rotate the green star by 90 degrees", ARM.step_kinds)
    assert [step.rotate_deg for step in turned if step.kind == "rotate_gripper"] == [90.0]


def test_words_that_cannot_be_read_fall_back_on_the_uses() -> None:
    targets = (Target("A", "area", "free area", use=("place",)), Target("B", "object", "green star", use=("pick",)))
    goal = Subgoal("G1", "Execute manoeuvre seven", targets=("A", "B"))
    answer = ask(WriteSteps(task("x", SCENE), KINDS, (goal,), targets))
    assert isinstance(answer, StepList)
    assert answer.to_steps() == (PickPlaceStep("G1", "B", At("A"), 0.0),)


def test_kinds_it_cannot_write_are_refused() -> None:
    with pytest.raises(UnsupportedQuestion, match="navigate"):
        steps_for("put the green star onto the blue square", ("navigate",))


TARGET_BOX = Box(465, 44, 535, 110)
"""Round the green star [view px]."""
TEXT = "put the green star onto the blue square, then put the yellow ball left of the red square"
PLAN = draft(TEXT, SCENE)
GOALS, TARGETS = PLAN.to_subgoals(), PLAN.to_targets()
RIGHT = (PickPlaceStep("G1", "T1", At("T2")), PickPlaceStep("G2", "T3", Beside("T4", "left")))


def reviewed(steps: tuple[Step, ...], overview: Picture | None = None, checked: tuple[str, ...] = ()) -> PlanReview:
    shown = task(TEXT, SCENE)
    answer = ask(ReviewSteps(shown, GOALS, TARGETS, steps, overview or shown.main, checked))
    assert isinstance(answer, PlanReview)
    return answer


def test_right_steps_pass() -> None:
    assert reviewed(RIGHT).approved


@pytest.mark.parametrize(
    ("steps", "about"),
    [
        ((replace(RIGHT[0], pick="T3"), RIGHT[1]), "1"),
        ((replace(RIGHT[0], place=At("T4")), RIGHT[1]), "1"),
        ((RIGHT[0], replace(RIGHT[1], place=Beside("T4", "right"))), "2"),
        ((RIGHT[0], replace(RIGHT[1], place=At("T4"))), "2"),
        ((replace(RIGHT[0], rotate_deg=90.0), RIGHT[1]), "1"),
        ((replace(RIGHT[0], place=OriginOf("T2")), RIGHT[1]), "1"),
        ((RIGHT[1], RIGHT[0]), "1"),
        ((RIGHT[0], RIGHT[0], RIGHT[1]), "2"),
        ((RIGHT[0],), "1"),
    ],
    ids=["thing", "place", "side", "on not beside", "turn", "origin", "order", "twice", "missing"],
)
def test_wrong_steps_are_doubted_by_number(steps: tuple[Step, ...], about: str) -> None:
    doubt = reviewed(steps).doubt
    assert doubt is not None
    assert doubt.about == about


@pytest.mark.parametrize("held", [False, True])
def test_an_open_gripper_may_turn_and_what_it_holds_may_not(held: bool) -> None:
    text = "put the green star onto the blue square"
    plan, shown = draft(text, SCENE), task(text, SCENE)
    first, *rest = steps_for(text, ARM.step_kinds)
    number = [step.kind for step in rest].index("close") + held
    steps = (first, *rest[:number], RotateGripperStep("G1", 90.0), *rest[number:])
    review = ask(ReviewSteps(shown, plan.to_subgoals(), plan.to_targets(), steps, shown.main))
    assert review.approved is not held, review


def test_a_drawn_arrow_must_begin_at_its_box() -> None:
    main = task(TEXT, SCENE).main
    to = main.frame.point_to_picture
    box = BoxMark(main.frame.box_to_picture(TARGET_BOX), label="T1")
    right = main.marked(box, PathMark((to((500.0, 80.0)), to((300.0, 160.0))), "1"))
    wrong = main.marked(box, PathMark((to((80.0, 80.0)), to((300.0, 160.0))), "1"))
    assert reviewed(RIGHT, right).approved
    assert not reviewed(RIGHT, wrong).approved


def test_what_a_step_has_moved_begins_elsewhere_than_its_box() -> None:
    text = "put the green star onto the blue square, then put it back where it was"
    plan, shown = draft(text, SCENE), task(text, SCENE)
    goals, targets = plan.to_subgoals(), plan.to_targets()
    steps = ask(WriteSteps(shown, KINDS, goals, targets)).to_steps()
    assert [step.pick for step in steps] == ["T1", "T1"]
    to = shown.main.frame.point_to_picture
    ways = [(to((500.0, 80.0)), to((300.0, 160.0))), (to((300.0, 160.0)), to((500.0, 80.0)))]
    drawn = shown.main.marked(
        BoxMark(shown.main.frame.box_to_picture(TARGET_BOX), label="T1"),
        *(PathMark(way, str(number)) for number, way in enumerate(ways, start=1)),
    )
    assert ask(ReviewSteps(shown, goals, targets, steps, drawn)).approved


def test_a_box_on_another_thing_is_seen() -> None:
    main = task(TEXT, SCENE).main
    elsewhere = main.marked(BoxMark(main.frame.box_to_picture(TARGET_BOX.shifted(-420, 0)), label="T1"))
    doubt = reviewed(RIGHT, elsewhere).doubt
    assert doubt is not None
    assert "T1" in doubt.question


def test_a_doubt_is_not_repeated() -> None:
    wrong = (replace(RIGHT[0], rotate_deg=90.0), RIGHT[1])
    doubt = reviewed(wrong).doubt
    assert doubt is not None
    assert reviewed(wrong, checked=(f"asked about 1: {doubt.question} Answer: so be it",)).approved
