"""The lean way asks where there is doubt: what a plain scene is not asked, what calls for more, and what is said of it."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

from tests.planning.helpers import APPROVED, Tape, asked, doubt, draft, plan_with, scripted, subgoal
from tests.planning.stub_model import stub_script
from wonderful_team.core.actions import ARM, PICK_PLACE, Vocabulary
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Request
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import Bounds, TeamConfig
from wonderful_team.planning.spending import agree, is_central

LEAN = TeamConfig(mode="lean")
MOVE = {"pick": "T1", "place": {"target": "T2", "how": "at", "side": None}, "rotate_deg": 0}
REVISE = {"reasoning": "", "decision": "revise", "problem": "too far right"}
REJECT = {"reasoning": "", "decision": "reject", "problem": "another thing"}
ACCEPT = {"reasoning": "", "decision": "accept", "problem": ""}


def kinds(model: ScriptedModel) -> Counter[str]:
    return Counter(request.contract for request in model.requests)


def planned(**changes: Any) -> tuple[Any, ScriptedModel, Tape]:
    model, tape = scripted(**changes), Tape()
    return plan_with(model, LEAN, tape=tape), model, tape


def not_asked(tape: Tape) -> str:
    return "; ".join(str(event.content["text"]) for event in tape.kinds("stage") if event.name == "not asked")


def verdicts(first: dict[str, Any], second: dict[str, Any] = ACCEPT) -> dict[str, Any]:
    return {"boxes": [{"target": "T1", "verdict": first}, {"target": "T2", "verdict": second}]}


def with_reading(**changes: Any) -> Any:
    """The stub's reading with other values for the first target."""

    def read(request: Request) -> dict[str, Any]:
        reading: dict[str, Any] = stub_script()["ReadScene"](request)
        reading["targets"][0].update(changes)
        return reading

    return read


# -- a plain scene ---------------------------------------------------------------------------------------------------


def test_a_plain_plan_takes_four_requests_and_is_approved():
    plan, model, _ = planned()
    assert (plan.status, plan.verified) == ("planned", True)
    assert kinds(model) == {"DraftPlan": 1, "ReadScene": 1, "JudgeBoxes": 1, "ReviewSteps": 1}
    assert plan.steps[0].place.target == "T2"


def test_what_was_not_asked_and_why_stands_in_one_line():
    _, _, tape = planned()
    line = not_asked(tape)
    for contract, why in (
        ("ReviewPlan", "checked with its steps"),
        ("JudgeBox", "T1, T2"),
        ("WriteSteps", "the plan states"),
    ):
        assert contract in line
        assert why in line
    assert "\n" not in line


def test_the_check_of_plan_and_steps_sees_all_that_the_check_of_the_plan_would_have_seen():
    _, model, _ = planned()
    question = asked(model, "ReviewSteps")[0].question
    assert not question.plan_checked
    assert question.step_kinds == PICK_PLACE.step_kinds
    assert question.overview is question.task.main, "the drawn plan takes the place of the view that it shows"


# -- what calls for more ---------------------------------------------------------------------------------------------


def moved(**changes: Any) -> dict[str, Any]:
    return draft(subgoal("G1", move={**MOVE, **changes}))


@pytest.mark.parametrize(
    "written",
    [
        {**moved(), "unsure": "two of them look the same"},
        {**moved(), "mode": "full"},
        draft(subgoal("G1")),
        moved(rotate_deg=40),
    ],
    ids=["the Supervisor is not sure", "it asks for a full check", "no move is stated", "an angle that no words state"],
)
def test_a_plan_that_is_not_plain_is_checked_by_itself_first(written):
    plan, model, tape = planned(DraftPlan=written, WriteSteps=_steps_as_wanted)
    assert plan.verified
    assert kinds(model)["ReviewPlan"] == 1
    assert asked(model, "ReviewSteps")[0].question.plan_checked
    assert "ReviewPlan" not in not_asked(tape)


def _steps_as_wanted(request: Request) -> Any:
    return stub_script()["WriteSteps"](request)


def test_what_the_supervisor_is_not_sure_of_is_told_to_verification():
    _, model, _ = planned(DraftPlan={**moved(), "unsure": "the lid may be closed"})
    notes = [note.text for note in asked(model, "ReviewPlan")[0].notes]
    assert any("the lid may be closed" in note for note in notes)


def test_steps_that_the_plan_does_not_state_are_written_by_the_supervisor():
    plan, model, _ = planned(DraftPlan=draft(subgoal("G1")))
    assert plan.status == "planned"
    assert kinds(model)["WriteSteps"] == 1


def test_the_steps_of_an_arm_that_carries_follow_from_the_plan_too():
    plan, model, tape = planned_on(ARM, DraftPlan=moved(rotate_deg=30), ReviewPlan=APPROVED)
    assert kinds(model)["WriteSteps"] == 0
    assert [step.kind for step in plan.steps] == [
        "open", "move", "move", "move", "close", "move", "rotate_gripper", "move", "move", "open", "move", "home",
    ]  # fmt: skip
    assert "WriteSteps: the plan states them" in not_asked(tape)


def test_an_arm_that_cannot_turn_what_the_plan_turns_gets_its_steps_written():
    move = {"kind": "move", "subgoal": "G1", "to": MOVE["place"], "height": "clear"}
    bare = Vocabulary(("move_to", "gripper", "home"))
    written = {"reasoning": "", "steps": [move]}
    _, model, _ = planned_on(bare, DraftPlan=moved(rotate_deg=30), ReviewPlan=APPROVED, WriteSteps=written)
    assert kinds(model)["WriteSteps"] == 1


def planned_on(vocabulary: Vocabulary, **changes: Any) -> tuple[Any, ScriptedModel, Tape]:
    model, tape = scripted(**changes), Tape()
    return plan_with(model, LEAN, tape=tape, vocabulary=vocabulary), model, tape


def test_a_robot_that_only_pushes_gets_its_steps_written():
    push = {"subgoal": "G1", "kind": "push", "start": MOVE["place"] | {"target": "T1"}, "end": MOVE["place"]}
    model = scripted(DraftPlan=moved(), WriteSteps={"reasoning": "", "steps": [push]})
    plan_with(model, LEAN, vocabulary=Vocabulary(("push",)))
    assert kinds(model)["WriteSteps"] == 1


@pytest.mark.parametrize(
    ("reading", "where"),
    [
        (with_reading(unsure="another one looks the same"), ""),
        (with_reading(box={"x0": 300, "y0": 200, "x1": 312, "y1": 212}), ""),
        (stub_script()["ReadScene"], "the left one"),
    ],
    ids=["the Manager is not sure", "small", "told apart by where it is"],
)
def test_a_target_in_doubt_is_judged_by_itself(reading, where):
    written = moved()
    written["targets"][0]["where"] = where
    _, model, _ = planned(DraftPlan=written, ReadScene=reading)
    assert kinds(model)["JudgeBoxes"] == 0
    assert {request.question.target.id for request in asked(model, "JudgeBox")} == {"T1", "T2"}


def test_a_plan_without_subgoals_is_always_checked():
    plan, model, _ = planned(DraftPlan=draft())
    assert kinds(model) == {"DraftPlan": 1, "ReviewPlan": 1}
    assert plan.verified


# -- doubts at the check of plan and steps ---------------------------------------------------------------------------


def test_a_doubt_about_the_plan_changes_the_plan_which_is_checked_and_grounded_anew():
    better = draft(subgoal("G1", "open the lid", move=MOVE), subgoal("G2", move=MOVE, after=["G1"]))
    revise = {"reasoning": "", "decision": "revise", "answer": "The lid first.", "plan": better}
    plan, model, _ = planned(
        DraftPlan=moved(), ReviewSteps=[doubt("G1", "is it not closed?"), APPROVED], RevisePlan=revise
    )
    assert (plan.status, plan.verified) == ("planned", True)
    assert [item.text for item in plan.subgoals][0] == "open the lid"
    assert [step.subgoal for step in plan.steps] == ["G1", "G2"]
    assert [(q.about, q.changed) for q in plan.questions] == [("G1", True)]
    assert kinds(model)["ReviewPlan"] == 1, "after a doubt the plan is no longer plain"
    assert kinds(model)["ReadScene"] == 2


def test_a_doubt_about_a_step_of_an_unchecked_plan_has_the_steps_written():
    plan, model, _ = planned(DraftPlan=moved(), ReviewSteps=[doubt("1", "is it the right way round?"), APPROVED])
    assert plan.verified
    (rewritten,) = asked(model, "WriteSteps")
    assert rewritten.question.doubt == "is it the right way round?"
    assert any("1. [G1]" in note.text for note in rewritten.notes), "who repairs the steps is told them"


def test_endless_doubt_about_the_plan_ends_at_the_bound_and_strict_refuses_it():
    for strict in (False, True):
        model = scripted(ReviewSteps=doubt("G1"))
        plan = plan_with(model, TeamConfig(mode="lean", strict=strict, bounds=Bounds(questions=3)))
        assert not plan.verified
        assert len(plan.questions) == 3
        assert plan.status == ("refused" if strict else "planned")


def test_one_wrong_box_of_two_goes_on_alone():
    revision = {"reasoning": "", "decision": "take_after_stop"}
    plan, model, _ = planned(JudgeBoxes=verdicts(REVISE), JudgeRevision=revision)
    assert plan.status == "planned"
    assert [request.question.target.id for request in asked(model, "MoveBox")] == ["T1"]
    assert asked(model, "MoveBox")[0].question.problem == "too far right"
    plan, model, _ = planned(JudgeBoxes=verdicts(REJECT))
    assert plan.status == "planned"
    assert {request.question.target.id for request in asked(model, "LocatePoints")} == {"T1"}


def test_every_box_must_be_judged_once():
    one = {"boxes": [{"target": "T1", "verdict": ACCEPT}]}
    _, model, _ = planned(JudgeBoxes=[one, verdicts(ACCEPT)])
    assert "missing: T2" in asked(model, "JudgeBoxes")[1].feedback


# -- rounds that buy nothing -----------------------------------------------------------------------------------------


def test_guesses_that_agree_are_not_chosen_among_in_lean_and_are_in_paper():
    def samples(spread: float) -> Any:
        def locate(request: Request) -> dict[str, Any]:
            value: dict[str, Any] = stub_script()["LocatePoints"](request)
            value["points"][0]["x"] += spread * request.sample
            return value

        return locate

    for spread, choices in ((1.0, 0), (60.0, 1)):
        _, model, tape = planned(JudgeBoxes=verdicts(REJECT), LocatePoints=samples(spread))
        assert kinds(model)["ChooseMark"] == choices
        assert ("ChooseMark (T1): the guesses agree" in not_asked(tape)) == (choices == 0)
    model = scripted(LocatePoints=samples(1.0))
    plan_with(model, TeamConfig(mode="paper"))
    assert kinds(model)["ChooseMark"] == 2


@pytest.mark.parametrize(("number", "rounds"), [(5, 1), (1, 2)])
def test_a_point_is_chosen_more_finely_only_where_it_is_not_central(number, rounds):
    def choose(request: Request) -> dict[str, Any]:
        return {"reasoning": "", "number": 5 if request.question.fine else number}

    changes = {"ChoosePoint": choose, "JudgeBoxes": verdicts(REJECT)}
    _, model, _ = planned(**changes)
    assert [request.question.fine for request in asked(model, "ChoosePoint")] == [False, True][:rounds]
    model = scripted(**changes)
    plan_with(model, TeamConfig(mode="paper"))
    assert kinds(model)["ChoosePoint"] == 4, "as published: two rounds for each point"


def test_strips_are_shown_in_lean_only_after_a_box_was_sent_back():
    revision = {"reasoning": "", "decision": "take_after_stop"}
    for verdict, strips in ((ACCEPT, 0), (REVISE, 4)):
        _, model, _ = planned(JudgeBoxes=verdicts(verdict), JudgeRevision=revision)
        shown = [p for r in model.requests for p in r.pictures if p.name.startswith("strip")]
        assert len(shown) == strips
        assert kinds(model)["Presence"] == 0


def test_guesses_agree_within_a_share_of_the_target():
    near, far = [(100.0, 50.0), (102.0, 51.0), (101.0, 50.0)], [(100.0, 50.0), (140.0, 50.0)]
    assert agree(near, Box(80, 30, 120, 70), (640, 320)) == (101.0, 50.0)
    assert agree(near, Box(98, 48, 103, 53), (640, 320)) is None, "2 px are much of a thing of 5 px"
    assert agree(far, None, (640, 320)) is None
    assert agree(near, None, (640, 320)) == (101.0, 50.0)


def test_a_long_thing_has_no_central_point():
    assert is_central((50.0, 50.0), Box(30, 30, 70, 70))
    assert not is_central((35.0, 50.0), Box(30, 30, 70, 70))
    assert not is_central((50.0, 50.0), Box(0, 45, 100, 55))
