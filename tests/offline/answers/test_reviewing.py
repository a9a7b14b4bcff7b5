"""ReviewPlan finds what is wrong with anyone's plan and lets right ones pass."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.offline.answers.tables import KINDS, ask, draft, slot, table, task
from wonderful_team.contracts import ReviewPlan, ShownTask, WalkedReview
from wonderful_team.core.values import Subgoal, Target

SCENE = table(
    ("square", "red", 80, 80, 26),
    ("square", "blue", 300, 160, 52),
    ("star", "green", 500, 80, 36),
    ("disc", "yellow", 520, 240, 30),
    ("triangle", "purple", 120, 250, 36),
)
TEXT = "put the green star onto the blue square, then put the yellow ball next to the red square"
PLAN = draft(TEXT, SCENE)
GOALS, TARGETS = PLAN.to_subgoals(), PLAN.to_targets()


def review(
    shown: ShownTask,
    goals: tuple[Subgoal, ...],
    targets: tuple[Target, ...] = TARGETS,
    under: str | None = None,
    checked: tuple[str, ...] = (),
    kinds: tuple[str, ...] = KINDS,
) -> WalkedReview:
    answer = ask(ReviewPlan(shown, kinds, goals, targets, under, checked))
    assert isinstance(answer, WalkedReview)
    return answer


TASK = task(TEXT, SCENE)


def test_its_own_plan_passes() -> None:
    assert review(TASK, GOALS).approved


def test_the_same_plan_in_other_words_passes() -> None:
    goals = (
        replace(GOALS[0], text="Move the emerald star on top of the blue square."),
        replace(GOALS[1], text="Place the yellow disc beside the crimson square"),
    )
    targets = tuple(
        replace(target, words=words)
        for target, words in zip(
            TARGETS, ("emerald star", "the blue block", "yellow disc", "crimson square"), strict=True
        )
    )
    assert review(TASK, goals, targets).approved


def test_missing_step() -> None:
    doubt = review(TASK, GOALS[:1]).doubt
    assert doubt is not None
    assert doubt.kind == "missing_subgoal"
    assert "yellow ball" in doubt.question


def test_empty_plan() -> None:
    doubt = review(TASK, ()).doubt
    assert doubt is not None
    assert doubt.about == "plan"


def test_swapped_order() -> None:
    doubt = review(TASK, (replace(GOALS[1], after=()), GOALS[0])).doubt
    assert doubt is not None
    assert "come before" in doubt.question


def test_needless_step() -> None:
    extra = Subgoal("G3", "put the purple triangle left of the green star", targets=("T1",))
    doubt = review(TASK, (*GOALS, extra)).doubt
    assert doubt is not None
    assert (doubt.about, doubt.kind) == ("G3", "needless_step")


def test_wrong_thing_in_the_words() -> None:
    doubt = review(TASK, (replace(GOALS[0], text="put the purple triangle onto the blue square"), GOALS[1])).doubt
    assert doubt is not None
    assert (doubt.about, doubt.kind) == ("G1", "wrong_target")


def test_wrong_target_behind_right_words() -> None:
    doubt = review(TASK, GOALS, (replace(TARGETS[0], words="purple triangle"), *TARGETS[1:])).doubt
    assert doubt is not None
    assert (doubt.about, doubt.kind) == ("G1", "wrong_target")


def test_thing_and_place_swapped() -> None:
    doubt = review(TASK, (replace(GOALS[0], text="put the blue square onto the green star"), GOALS[1])).doubt
    assert doubt is not None
    assert doubt.kind == "wrong_target"


def test_wrong_angle() -> None:
    shown = task("rotate the green star by 90 degrees", SCENE)
    right = (Subgoal("G1", "Turn the green star 90 degrees clockwise", targets=("T1",)),)
    wrong = (Subgoal("G1", "Turn the green star 60 degrees clockwise", targets=("T1",)),)
    assert review(shown, right).approved
    assert not review(shown, wrong).approved


def test_another_pictured_thing_is_noticed() -> None:
    slots = (slot("a", "star", "green"), slot("b", "square", "blue"))
    shown = task("Put the {a} into the {b}.", SCENE, *slots)
    plan = draft("Put the {a} into the {b}.", SCENE, *slots)
    named = (Subgoal("G1", "put the green star into the blue square", targets=("T1", "T2")),)
    other = (Subgoal("G1", "put the yellow ball into the blue square", targets=("T1", "T2")),)
    assert review(shown, named, plan.to_targets()).approved
    assert not review(shown, other, plan.to_targets()).approved


def test_one_subgoal_is_checked_alone() -> None:
    wrong = replace(GOALS[1], text="put the purple triangle next to the red square")
    assert review(TASK, (GOALS[0], wrong), under="G1").approved
    assert not review(TASK, (GOALS[0], wrong), under="G2").approved


def test_nothing_is_asked_twice() -> None:
    doubt = review(TASK, GOALS[:1]).doubt
    assert doubt is not None
    assert review(TASK, GOALS[:1], checked=(f"asked about {doubt.about}: {doubt.question} Answer: no",)).approved


def test_what_the_robot_cannot_do() -> None:
    doubt = review(task("rotate the star by 90 degrees", SCENE), draft("rotate the star by 90 degrees", SCENE).to_subgoals(),
                   kinds=("push",)).doubt  # fmt: skip
    assert doubt is not None
    assert doubt.kind == "physical_constraint"


@pytest.mark.parametrize("text", ["Perform the manoeuvre", "Do what was asked"])
def test_a_subgoal_that_cannot_be_read_is_said_so_when_it_matters(text: str) -> None:
    unread = replace(GOALS[1], text=text, targets=())
    doubt = review(TASK, (GOALS[0], unread)).doubt
    assert doubt is not None
    assert doubt.about == "G2"
    covered = replace(GOALS[1], text=text)
    assert review(TASK, (GOALS[0], covered)).approved


def test_pictures_that_a_wrong_subgoal_names_are_words_of_the_doubt_like_others() -> None:
    """Braces in what it says are no places for it to fill."""
    slots = (slot("a", "star", "green"), slot("b", "square", "blue"), slot("c", "disc", "yellow"))
    words = "Put the {a} into the {b}."
    shown, plan = task(words, SCENE, *slots), draft(words, SCENE, *slots)
    swapped = (Subgoal("G1", "Put the {a} next to the {c}", targets=("T1", "T2")),)
    doubt = review(shown, swapped, plan.to_targets()).doubt
    assert doubt is not None
    assert "{c}" in doubt.question
