"""Questions of the rivals that look with a detector: programs from truth for what the detector finds, marks nearest to the truth."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any

import pytest

from tests.simulated.image_corruption import CHANGES, ImageCorruption
from tests.simulated.tables import Set
from wonderful_team.contracts import (
    ChooseMotion,
    DescribePictures,
    FoundBox,
    JudgeFromBoxes,
    ListSubtasks,
    ProgramFunction,
    ProgramRound,
    SlotWords,
    WriteProgram,
)
from wonderful_team.core.pictures import Candidates, Grid
from wonderful_team.errors import NotFoundError, NotUnderstoodError, UnsupportedQuestion
from wonderful_team.simulated import PROFILES, SimulatedModel


def erring(table: Set, **errors: Any) -> SimulatedModel:
    profile = replace(PROFILES["perfect"], name="erring", **errors)
    return SimulatedModel(table.world.privileged, table.world.instruction, profile)


def blind(table: Set) -> ImageCorruption:
    return ImageCorruption(table.model, CHANGES["flipped"])


def program(table: Set, *names: str, **more: Any) -> WriteProgram:
    functions = tuple(ProgramFunction(f"{name}(x)", "does it") for name in names)
    view = table.scene.views[0]
    given = {"picture": view.name, "size_px": view.size_px, **more}
    return WriteProgram(table.world.instruction.text, functions, ("pick_place",), **given)


WORDS = (SlotWords("dragged_obj_1", "pink letter R"), SlotWords("base_obj", "red paisley pan"))


def test_pictures_of_the_instruction_are_put_into_words_and_blindness_shows(table: Set) -> None:
    question = DescribePictures(table.scene.slots)
    said = {one.picture: one.words for one in table.ask(question).pictures}
    assert said == {"dragged_obj_1": "pink letter R", "base_obj": "red paisley pan"}
    assert {one.words for one in table.ask(question, blind(table)).pictures} == {"nothing that was ever there"}


def test_a_trajectory_is_written_after_a_look_and_takes_of_several_the_nearest_to_the_truth(table: Set) -> None:
    question = program(table, "detect_object", "execute_trajectory", slot_words=WORDS)
    first = table.ask(question)
    assert "detect_object(name)" in first.code
    assert "execute_trajectory" not in first.code
    looked = replace(question, rounds=(ProgramRound(first.code, "1 found: pink letter R [{'x': 1}]"),))
    then = table.ask(looked).code
    x, y = table.scene.views[0].frame.point_to_picture(table.thing_box("pink letter R").centre)
    hint = then.partition("nearest(detect_object('pink letter R'), ")[2].partition(")")[0]
    assert math.dist(tuple(float(part) for part in hint.split(", ")), (x, y)) < 30
    assert "task_completed()" in then


def test_a_program_names_another_thing_as_the_profile_says_and_the_same_in_every_round(table: Set) -> None:
    question = program(table, "detect_object", "execute_trajectory", slot_words=WORDS)
    model = erring(table, wrong_thing=1.0)
    first = table.ask(question, model).code
    looked_for = re.findall(r"'([^']+)'", first.partition("[")[2].partition("]")[0])
    assert [one != right for one, right in zip(looked_for, ("pink letter R", "red paisley pan"), strict=True)] == [
        True
    ] * 2
    then = table.ask(replace(question, rounds=(ProgramRound(first, "1 found: it [{'x': 1}]"),)), model).code
    assert re.findall(r"nearest\(detect_object\('([^']+)'\)", then) == looked_for


def test_what_the_detector_does_not_find_is_not_moved_and_a_failed_program_is_not_written_again(table: Set) -> None:
    question = program(table, "detect_object", "execute_trajectory", slot_words=WORDS)
    for said, match in (
        ("1 found: red paisley pan [{}]\n0 found: pink letter R []", "the detector finds no pink letter R"),
        ("error: ValueError: no\nin line 1", "the last program failed: ValueError: no"),
    ):
        with pytest.raises(NotFoundError, match=match):
            table.ask(replace(question, rounds=(ProgramRound("x", said),)))


def test_a_program_that_retrieves_looks_by_the_instructions_pictures(table: Set) -> None:
    code = table.ask(program(table, "segment", "retrieve", "pick_place")).code
    assert "retrieve(segments, '{dragged_obj_1}')[0]" in code
    assert "retrieve(segments, '{base_obj}')[0]" in code
    assert "nearest" not in code


def test_other_words_and_other_views_are_refused(table: Set) -> None:
    with pytest.raises(UnsupportedQuestion, match="it knows what is right for"):
        table.ask(replace(program(table, "segment"), instruction="dance"))
    with pytest.raises(NotUnderstoodError, match="which is not known"):
        table.ask(program(table, "segment", picture="another view"))


def test_completed_is_what_truth_says_and_overlooked_by_the_profiles_rate(table: Set) -> None:
    x, y = table.shown_box("pink letter R").centre
    box = FoundBox("pink letter R", round(x), round(y), 3, 4, 5)
    view = table.scene.views[0]
    question = JudgeFromBoxes(table.world.instruction.text, WORDS, view.name, view.size_px, (box,), (box,))
    verdict = table.ask(question)
    assert (verdict.completed, verdict.summary) == (False, "not where it should be: pink letter R")
    assert table.ask(question, erring(table, overlooks=1.0)).completed
    elsewhere = table.ask(replace(question, after=(replace(box, x=1, y=2),)))
    assert (elsewhere.completed, elsewhere.summary) == (False, "not found where it could be: pink letter R")


def test_a_program_is_not_written_from_words_that_say_what_no_picture_shows(table: Set) -> None:
    question = program(table, "detect_object", "execute_trajectory", slot_words=WORDS)
    blinded = tuple(
        SlotWords(one.picture, one.words)
        for one in table.ask(DescribePictures(table.scene.slots), blind(table)).pictures
    )
    other = (SlotWords("dragged_obj_1", "green star"), WORDS[1])
    for words in (blinded, other):
        with pytest.raises(NotUnderstoodError, match="nobody says what .*dragged_obj_1 really shows"):
            table.ask(replace(question, slot_words=words))
    assert table.ask(replace(question, slot_words=(SlotWords("dragged_obj_1", "an R in pink"), WORDS[1]))).code


def motion(table: Set) -> ChooseMotion:
    """The sixth point lies on the thing, and the second on the pan."""
    subtask = table.ask(ListSubtasks(table.scene.task, ("pick_place",))).subtasks[0]
    held, other = (table.shown_box(name).centre for name in ("pink letter R", "red paisley pan"))
    view = table.scene.views[0].marked(
        Grid(5, 5), Candidates((*((5.0 + k, 5.0) for k in range(5)), held), "P"), Candidates(((9.0, 9.0), other), "Q")
    )
    return ChooseMotion(
        subtask.instruction, subtask.object_grasped, subtask.object_unattached, "", view, ("pick_place",)
    )


def test_subtasks_name_things_and_marks_are_the_nearest_to_the_truth(table: Set) -> None:
    question = motion(table)
    assert (question.object_grasped, question.object_unattached) == ("pink letter R", "red paisley pan")
    marks = table.ask(question)
    assert (marks.grasp_keypoint, marks.target_keypoint, marks.post_contact_tile) == ("P6", "Q2", "")
    with pytest.raises(NotUnderstoodError, match="nothing that was ever there"):
        table.ask(question, blind(table))
    with pytest.raises(NotUnderstoodError, match="is no subtask of this model's plan"):
        table.ask(replace(question, instruction="dance"))


def test_wrong_choices_name_other_marks_that_there_are(table: Set) -> None:
    question, model = motion(table), erring(table, wrong_choice=1.0)
    said = [table.ask(question, model, f"q{k}") for k in range(6)]
    assert all(one.grasp_keypoint in {"P1", "P2", "P3", "P4", "P5"} for one in said)
    assert {one.target_keypoint for one in said} == {"Q1"}
    assert len({one.grasp_keypoint for one in said}) > 1
