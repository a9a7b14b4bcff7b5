"""Programs by the grammar alone, pictures put into words, and marks nearest to what is seen."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

import wonderful_team as wt
from tests.offline.answers.test_rivals_questions import desk
from wonderful_team.contracts import (
    ChooseMotion,
    DescribePictures,
    FoundBox,
    JudgeFromBoxes,
    ListSubtasks,
    ProgramFunction,
    ProgramRound,
    ShownSlot,
    ShownTask,
    SlotWords,
    WriteProgram,
)
from wonderful_team.core.pictures import Candidates, Grid
from wonderful_team.core.values import Request
from wonderful_team.errors import NotFoundError, NotUnderstoodError


def ask(question: Any) -> Any:
    request = Request("q", "plan", "any", question, (), question.output())
    made: Any = wt.make_model("offline").answer(request)
    return (asyncio.run(made) if asyncio.iscoroutine(made) else made).value


def program(text: str, **more: Any) -> WriteProgram:
    functions = (
        ProgramFunction("execute_trajectory(points)", "moves"),
        ProgramFunction("detect_object(name)", "looks"),
    )
    return WriteProgram(text, more.pop("functions", functions), ("pick_place",), "top view", (640, 480), **more)


def looked(question: WriteProgram) -> str:
    from dataclasses import replace

    code: str = ask(replace(question, rounds=(ProgramRound("look", "1 found: red circle [{}]"),))).code
    return code


def test_clauses_become_motions_and_names_in_braces_their_words() -> None:
    told = (SlotWords("thing", "red circle"), SlotWords("goal", "blue square"))
    question = program("Put the {thing} into the {goal}, then rotate the {goal} by 30 degrees.", slot_words=told)
    assert "['red circle', 'blue square']" in ask(question).code
    code = looked(question)
    assert code.count("close_gripper()") == 2
    assert "15, 30)" in code
    with pytest.raises(NotUnderstoodError, match="nobody says what {goal} shows"):
        ask(program("Put the {thing} into the {goal}.", slot_words=told[:1]))


def test_back_is_where_it_stood_and_a_moved_thing_is_picked_where_it_lies() -> None:
    code = looked(program("Put the red circle onto the blue square, then put it back to its original place."))
    lines = [line for line in code.splitlines() if line.startswith("execute_trajectory")]
    assert "*t1, 15" in lines[0]
    assert "*t2, 0" in lines[1]
    assert "*t2, 15" in lines[2]
    assert "*t1, 0" in lines[3]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("put the red circle to the left of the blue square", "not for this: put, left"),
        ("put all blocks into the bowl", "cannot count"),
        ("push the red circle into the bowl", "not for this: push"),
        ("put the thing with the same texture as {goal} into the bowl", "cannot compare|nobody says|I do not know"),
    ],
)
def test_what_needs_eyes_is_refused_by_name(text: str, said: str) -> None:
    with pytest.raises(NotUnderstoodError, match=said):
        ask(program(text))


def test_a_thing_that_is_not_found_ends_it() -> None:
    question = program("put the red circle onto the blue square", rounds=(ProgramRound("x", "0 found: red circle []"),))
    with pytest.raises(NotFoundError, match="the detector finds no red circle"):
        ask(question)


def test_a_picture_of_one_thing_is_put_into_words_that_lead_to_it() -> None:
    slot = ShownSlot("thing", "object", (desk(),))
    scene = ShownSlot("scene", "scene", (desk(),))
    said = {one.picture: one.words for one in ask(DescribePictures((slot, scene))).pictures}
    assert " at x " in said["scene"]
    assert " at x " not in said["thing"]


@pytest.mark.parametrize(
    ("after", "angle", "summary"),
    [
        ((452, 182), 30, ""),
        ((160, 300), 30, "red circle lies"),
        ((452, 182), 80, "off by"),
        (None, 30, "not found any more"),
    ],
)
def test_boxes_before_and_after_tell_what_was_done(after: Any, angle: int, summary: str) -> None:
    before = (FoundBox("red circle", 160, 300, 100, 100, 0), FoundBox("blue square", 460, 180, 120, 120, 0))
    moved = () if after is None else (FoundBox("red circle", *after, 100, 100, 0),)
    question = JudgeFromBoxes(
        "Put the red circle onto the blue square, then rotate the blue square by 30 degrees.", (), "top view", (640, 480),
        before, (*moved, FoundBox("blue square", 460, 180, 120, 120, angle)),
    )  # fmt: skip
    verdict = ask(question)
    assert verdict.completed == (not summary)
    assert summary in verdict.summary


def test_subtasks_and_marks_for_what_is_carried_and_for_what_is_turned() -> None:
    task = ShownTask("put the red circle onto the blue square and rotate the blue square by 45 degrees", (desk(),))
    first, second = ask(ListSubtasks(task, ("pick_place",))).subtasks
    assert "red" in first.object_grasped
    assert "blue" in first.object_unattached
    assert ("blue" in second.object_grasped, second.object_unattached) == (True, "")
    marks = (Candidates(((20.0, 20.0), (165.0, 305.0)), "P"), Candidates(((460.0, 182.0), (600.0, 20.0)), "Q"))
    shown = desk().marked(Grid(5, 5), *marks)
    asked = ChooseMotion(first.instruction, first.object_grasped, first.object_unattached, "", shown, ("pick_place",))
    said = ask(asked)
    assert (said.grasp_keypoint, said.target_keypoint, said.target_angle) == ("P2", "Q1", 0)
    turned = ChooseMotion(second.instruction, second.object_grasped, "", "", shown, ("pick_place",))
    assert (ask(turned).target_keypoint, ask(turned).target_angle) == ("", 45)
