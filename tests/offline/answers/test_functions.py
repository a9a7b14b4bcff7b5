"""The functions that offline writes: run in the sandbox, reviewed as drawn, and the steps that follow them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.offline.answers.tables import ask, picture, table, task
from wonderful_team.contracts import (
    DraftPlan,
    FunctionCode,
    PathReview,
    PlanDraft,
    ReviewPath,
    StepList,
    WriteFunction,
    WriteSteps,
)
from wonderful_team.core.actions import ARM, PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PathMark, PathPoint, rises_of
from wonderful_team.core.values import Subgoal, View
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.offline.language.vocabulary import FIGURES
from wonderful_team.sandbox import run_path

PAPER = table(("square", "green", 200, 160, 80), ("disc", "red", 480, 160, 80))
BOXES = {"green square": Box(120, 80, 281, 241), "red bowl": Box(400, 80, 561, 241)}
PEN = ("Tool: a pen that the gripper holds from the start.",)
SPONGE = ("Tool: a sponge of 6 x 4 cm that the gripper holds from the start.",)


def goal(text: str) -> Subgoal:
    return Subgoal("G1", text, (), ("T1",), "a path")


def written(text: str, name: str, most_up_m: float = 0.2) -> tuple[PathPoint, ...]:
    """The path of the function that is written for a subgoal on one of the things."""
    boxes = {"T1": BOXES[name]}
    answer = ask(WriteFunction(goal(text), picture(PAPER), boxes, most_up_m=most_up_m))
    assert isinstance(answer, FunctionCode)
    return run_path(answer.code, boxes)


def review(text: str, name: str, path: tuple[PathPoint, ...]) -> PathReview:
    marks = (BoxMark(BOXES[name], "target", "T1"), PathMark(tuple(point[:2] for point in path), "G1"))
    answer = ask(ReviewPath(goal(text), picture(PAPER).marked(*marks), rises_of(path)))
    assert isinstance(answer, PathReview)
    return answer


@pytest.mark.parametrize("figure", FIGURES)
def test_every_figure_is_written_lies_on_the_thing_and_is_accepted(figure: str) -> None:
    text = f"draw a {figure} on the green square"
    path = written(text, "green square")
    assert all(BOXES["green square"].contains(point[:2]) for point in path)
    assert review(text, "green square", path).accepted


@pytest.mark.parametrize(
    ("asked", "drawn", "said"),
    [
        ("star", "pentagon", ""),
        ("star", "hexagon", "6 corners; a star with 5"),
        ("triangle", "square", "4 corners; a triangle with 3"),
        ("square", "line", "not closed"),
    ],
)
def test_another_figure_is_refused(asked: str, drawn: str, said: str) -> None:
    path = written(f"draw a {drawn} on the green square", "green square")
    found = review(f"draw a {asked} on the green square", "green square", path)
    assert found.accepted != bool(said)
    assert said in found.problem


def test_a_path_beside_its_thing_and_half_a_wiped_one_are_refused() -> None:
    star = written("draw a star on the green square", "green square")
    aside = tuple((x + 100, y) for x, y in star)
    assert "beside" in review("draw a star on the green square", "green square", aside).problem
    lanes = written("wipe the red bowl", "red bowl")
    assert review("wipe the red bowl", "red bowl", lanes).accepted
    assert "leaves a good part" in review("wipe the red bowl", "red bowl", lanes[:5]).problem


def test_a_star_has_the_tips_that_are_asked_for() -> None:
    assert len(written("draw a 7 pointed star on the green square", "green square")) == 15


def test_lanes_stay_on_a_round_thing_and_fill_one_with_corners() -> None:
    x, y = BOXES["red bowl"].centre
    assert max((px - x) ** 2 + (py - y) ** 2 for px, py in written("wipe the red bowl", "red bowl")) < 80**2
    x, y = BOXES["green square"].centre
    corners = written("wipe the green square", "green square")
    assert max(abs(px - x) for px, _ in corners) > 55
    assert max((px - x) ** 2 + (py - y) ** 2 for px, py in corners) > 70**2


def test_shaking_rises_as_far_as_there_is_room_and_is_refused_without() -> None:
    path = written("shake the red bowl 5 times", "red bowl", most_up_m=0.06)
    assert max(rises_of(path)) == pytest.approx(0.06)
    assert len(path) == 11
    assert review("shake the red bowl 5 times", "red bowl", path).accepted
    assert "too seldom" in review("shake the red bowl 5 times", "red bowl", path[:5]).problem
    with pytest.raises(UnsupportedQuestion, match=r"0.020 m of lifting"):
        written("shake the red bowl", "red bowl", most_up_m=0.02)


def plan(text: str, facts: tuple[str, ...], view: View = PAPER, kinds: tuple[str, ...] = ARM.step_kinds) -> PlanDraft:
    answer = ask(DraftPlan(replace(task(text, view), facts=facts), kinds, True))
    assert isinstance(answer, PlanDraft)
    return answer


def test_a_figure_is_followed_on_the_surface_and_the_arm_goes_home() -> None:
    drawn = plan("draw a star on the green square with the pen", PEN)
    (subgoal,), (target,) = drawn.to_subgoals(), drawn.to_targets()
    assert subgoal.function
    assert (target.words, target.use) == ("green square", ("place",))
    question = WriteSteps(
        replace(task("draw a star on the green square", PAPER), facts=PEN),
        ARM.step_kinds,
        (subgoal,),
        (target,),
        ("G1",),
    )
    steps = ask(question)
    assert isinstance(steps, StepList)
    assert [(step.kind, getattr(step, "contact", None)) for step in steps.to_steps()] == [
        ("follow", "surface"),
        ("home", None),
    ]


def test_what_is_shaken_is_held_tightly_moved_in_the_air_and_put_back() -> None:
    shaken = plan("shake the red bowl", ())
    question = WriteSteps(
        task("shake the red bowl", PAPER), ARM.step_kinds, shaken.to_subgoals(), shaken.to_targets(), ("G1",)
    )
    steps = ask(question)
    assert isinstance(steps, StepList)
    kinds = [step.kind for step in steps.to_steps()]
    assert kinds.index("close") < kinds.index("follow") < len(kinds) - 1 - kinds[::-1].index("open")
    assert next(step.contact for step in steps.to_steps() if step.kind == "follow") == "air"  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "facts", "said"),
    [
        ("draw a star on the green square", (), "the gripper is not said to hold a tool"),
        ("draw a star on the green square", SPONGE, "the gripper holds a sponge"),
        ("wipe the red bowl", PEN, "the gripper holds a pen"),
        ("wipe the red bowl with the pencil", SPONGE, "a pencil wipes nothing"),
        ("open the red bowl", (), "nothing that closes the red bowl"),
    ],
)
def test_what_is_missing_for_it_is_asked_about(text: str, facts: tuple[str, ...], said: str) -> None:
    asked = plan(text, facts).clarification
    assert asked is not None
    assert said[1:] in asked.question


def test_a_robot_that_follows_no_paths_is_told_so_before_anything_is_looked_for() -> None:
    with pytest.raises(UnsupportedQuestion, match="following a path"):
        plan("draw a star on the green square", PEN, kinds=PICK_PLACE.step_kinds)
