"""Notebooks: sentences in one line, current, without coordinates; nobody reads its own approval."""

from __future__ import annotations

import re
from typing import Any

import pytest

from tests.planning.helpers import APPROVED, asked, doubt, draft, plan_with, scripted, subgoal
from tests.planning.stub_model import stub_script
from wonderful_team.contracts import QUESTIONS
from wonderful_team.core.values import Note, Request, Words
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig
from wonderful_team.planning.memory import Notebooks
from wonderful_team.planning.notes import LONGEST, note_of, one_line

COORDINATES = re.compile(r"[(\[]\s*-?\d+(\.\d+)?\s*,\s*-?\d+|\d+ ?px|\b[xy]\d? ?[=:]")
WORDY = {"reasoning": "", "decision": "keep", "answer": "It lies at (120, 45),\nfree on all sides.", "plan": None}
ACCEPT = {"reasoning": "", "decision": "accept", "problem": ""}


def notes(model: ScriptedModel) -> list[str]:
    """Every line of every notebook that was sent."""
    return [note.text for request in model.requests for note in request.notes if note.source == "notebook"]


def rejecting() -> Any:
    turns = iter([{"reasoning": "", "decision": "reject", "problem": "that lies at (300, 20)"}])
    return lambda request: next(turns, ACCEPT) if request.question.target.id == "T1" else ACCEPT


@pytest.mark.parametrize("mode", ["lean", "paper"])
def test_notes_are_sentences_in_one_line_without_json_or_coordinates(mode):
    model = scripted(
        ReviewPlan=[doubt(question="does T1 at x=120 fit?"), APPROVED],
        RevisePlan=WORDY,
        ReviewSteps=[doubt("1", "is 40 px enough?"), APPROVED],
        JudgeBox=rejecting(),
    )
    assert plan_with(model, TeamConfig(mode=mode, thorough=True)).status == "planned"
    kept = notes(model)
    assert kept
    for line in kept:
        assert "\n" not in line
        assert "{" not in line
        assert '"' not in line
        assert not COORDINATES.search(line), line
        assert len(line) <= LONGEST + 2


@pytest.mark.parametrize("mode", ["lean", "paper"])
def test_a_plain_plan_leaves_no_notes_but_its_steps(mode):
    model = scripted()
    plan_with(model, TeamConfig(mode=mode, thorough=True))
    assert [line for line in notes(model) if not line.startswith("The steps so far")] == []


def test_verification_never_reads_its_own_approval():
    three = draft(subgoal("G1"), subgoal("G2"), subgoal("G3"), mode="full")
    model = scripted(DraftPlan=three, WriteSteps=_steps)
    plan_with(model, TeamConfig(mode="lean", thorough=True))
    asks = asked(model, "ReviewPlan") + asked(model, "ReviewSteps")
    assert len(asks) == 4
    assert [note for request in asks for note in request.notes] == []


def _steps(request: Request) -> dict[str, Any]:
    one = stub_script()["WriteSteps"](request)["steps"][0]
    return {"reasoning": "", "steps": [{**one, "subgoal": item.id} for item in request.question.subgoals]}


def test_what_was_tried_for_a_target_is_forgotten_once_it_is_found():
    """A note of no mark being on the target is read while it is looked for, and no longer when its point is chosen."""
    choices = iter([{"reasoning": "", "number": None}])
    model = scripted(
        ChooseMark=lambda request: (
            next(choices, {"reasoning": "", "number": 1})
            if request.question.target.id == "T1"
            else {"reasoning": "", "number": 1}
        )
    )
    plan_with(model, TeamConfig(mode="paper"))
    mine = [r for r in asked(model, "LocatePoints") if r.question.target.id == "T1"]
    assert any("None of the points" in note.text for note in mine[-1].notes)
    points = [r for r in asked(model, "ChoosePoint") if r.question.target.id == "T1"]
    assert points
    assert not any("None of the points" in note.text for r in points for note in r.notes)
    books = Notebooks()
    books.begin("manager", "T1")(Note("ChooseMark", "None of the points was on it.", "notebook"))
    books.forget("T1")
    assert books.read("manager", "T1") == ()


def test_a_new_picture_begins_new_notebooks_but_attempts_stay_known_to_who_judges_them():
    books = Notebooks()
    for role in ("supervisor", "manager", "replanner"):
        books.begin(role, "")(Note("x", f"noted by the {role}", "notebook"))
    books.begin_attempt()
    assert books.read("supervisor", "") == books.read("manager", "") == ()
    assert [note.text for note in books.read("replanner", "")] == ["noted by the replanner"]


def test_steps_written_anew_take_the_place_of_those_before():
    books = Notebooks()
    for key, text in (
        ("WriteSteps", "The steps so far: 1. pick T1"),
        ("RevisePlan", "On the doubt 'is it T1?' you changed the plan"),
        ("RevisePlan", "On the doubt 'is it T2?' you kept the plan"),
        ("WriteSteps", "The steps so far: 1. pick T2"),
    ):
        books.begin("supervisor", "")(Note(key, text, "notebook"))
    shown = [note.text for note in books.read("supervisor", "")]
    assert shown[-1] == "The steps so far: 1. pick T2"
    assert sum("The steps so far" in text for text in shown) == 1
    assert sum("On the doubt" in text for text in shown) == 2


def test_no_kind_of_question_leaves_more_than_a_line():
    long = {"words": "a " * 400 + "\n\n(12, 14)"}
    assert len(one_line(long["words"])) <= LONGEST + 2
    assert one_line("between (12, 14) and [3.5, 4, 5, 6], 12 px\nfurther, x = 3") == "between and, further,"
    assert one_line("turned by 90 degrees, 3 blocks") == "turned by 90 degrees, 3 blocks"
    silent = {
        "ReviewPlan",
        "ReviewSteps",
        "JudgeBox",
        "JudgeBoxes",
        "DraftPlan",
        "GiveBox",
        "LocatePoints",
        "ChoosePoint",
    }
    kinds = {question.__name__: question for question in QUESTIONS}
    assert all(note_of(object.__new__(kinds[name]), None) == "" for name in silent)


def test_a_note_is_shown_as_a_sentence_without_the_names_of_questions_or_books():
    plan = {**draft(subgoal("G1")), "unsure": "the angle is estimated"}
    model = scripted(DraftPlan=plan)
    assert plan_with(model, TeamConfig()).status == "planned"
    shown = [part.text for request in asked(model, "ReviewPlan") for part in request.parts if isinstance(part, Words)]
    assert "Notes kept from earlier in this task:\n- The Supervisor is not sure: the angle is estimated" in shown
