"""Drafting, doubting, revising: who is asked what, and where it ends."""

from __future__ import annotations

import pytest

from tests.planning.helpers import APPROVED, Tape, asked, doubt, draft, one_step_each, plan_with, scripted, subgoal
from wonderful_team.planning import Bounds, TeamConfig

LEAN = TeamConfig(mode="lean")
THOROUGH = TeamConfig(mode="lean", thorough=True)


def test_a_doubt_is_answered_and_recorded():
    model = scripted(ReviewPlan=[doubt(question="is the box open?"), APPROVED])
    plan = plan_with(model)
    assert plan.verified
    assert [(q.about, q.question, q.answer, q.changed) for q in plan.questions] == [
        ("G1", "is the box open?", "It stands.", False)
    ]
    second = asked(model, "ReviewPlan")[1].question
    assert any("is the box open?" in line and "It stands." in line for line in second.checked)


def test_a_revision_replaces_the_plan_and_keeps_the_first_draft():
    better = draft(subgoal("G1", "open the lid"), subgoal("G2", after=["G1"]))
    revise = {"reasoning": "", "decision": "revise", "answer": "The lid first.", "plan": better}
    model = scripted(ReviewPlan=[doubt(), APPROVED], RevisePlan=revise, WriteSteps=one_step_each)
    plan = plan_with(model, THOROUGH)
    assert [s.text for s in plan.subgoals][0] == "open the lid"
    assert len(plan.first_draft) == 1
    assert plan.questions[0].changed


def test_full_mode_checks_every_subgoal_once_per_revision():
    three = draft(subgoal("G1"), subgoal("G2"), subgoal("G3"), mode="full")
    model = scripted(DraftPlan=three, WriteSteps=one_step_each)
    plan = plan_with(model, THOROUGH)
    assert plan.verified
    assert [r.question.under_check for r in asked(model, "ReviewPlan")] == ["G1", "G2", "G3"]


def test_full_mode_looks_at_the_whole_plan_after_an_answer_that_changed_nothing():
    two = draft(subgoal("G1"), subgoal("G2"), mode="full")
    model = scripted(DraftPlan=two, ReviewPlan=[doubt("G1"), APPROVED], WriteSteps=one_step_each)
    plan = plan_with(model, THOROUGH)
    assert plan.verified
    assert [r.question.under_check for r in asked(model, "ReviewPlan")] == ["G1", "G2", None]


@pytest.mark.parametrize("mode", ["one_step", "full"])
def test_endless_doubt_ends_at_the_bound_as_not_verified(mode):
    model = scripted(DraftPlan=draft(subgoal("G1"), mode=mode), ReviewPlan=doubt())
    tape = Tape()
    plan = plan_with(model, TeamConfig(mode="lean", bounds=Bounds(questions=4)), tape=tape)
    assert plan.status == "planned"
    assert not plan.verified
    assert len(plan.questions) == 4
    assert "still doubts" in tape.warnings


def test_strict_refuses_a_plan_that_is_not_approved():
    model = scripted(ReviewPlan=doubt())
    plan = plan_with(model, TeamConfig(mode="lean", strict=True, thorough=True, bounds=Bounds(questions=1)))
    assert plan.status == "refused"
    assert not plan.actions


def test_ambiguity_ends_as_a_question_with_choices():
    unclear = {**draft(), "clarification": {"question": "which red block?", "choices": ["left", "right"]}}
    plan = plan_with(scripted(DraftPlan=unclear))
    assert plan.status == "needs_clarification"
    assert plan.choices == ("left", "right")
    assert "which red block?" in plan.message


def test_nothing_to_do_is_a_plan_without_actions():
    model = scripted(DraftPlan=draft())
    plan = plan_with(model, LEAN)
    assert plan.status == "planned"
    assert plan.actions == ()
    assert "already fulfilled" in plan.message
    assert asked(model, "ReviewPlan"), "Verification must agree that nothing is to be done"


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (draft(subgoal("G1"), subgoal("G1")), "unique"),
        (draft(subgoal("G1", after=["G7"])), "G7"),
        (draft(subgoal("G1", targets=["T9"])), "T9"),
        (draft(subgoal("G1", targets=[])), "names no target"),
        ({"nonsense": 1}, "Field required"),
    ],
)
def test_a_wrong_draft_goes_back_with_the_reason(wrong, said):
    model = scripted(DraftPlan=[wrong, draft(subgoal("G1"))])
    plan = plan_with(model, LEAN)
    assert plan.status == "planned"
    first, second = asked(model, "DraftPlan")
    assert first.attempt == 0
    assert second.attempt == 1
    assert said in second.feedback


def test_a_model_that_never_learns_fails_the_plan_stage():
    plan = plan_with(scripted(DraftPlan="not even JSON"), LEAN)
    assert plan.status == "failed"
    assert plan.stage == "plan"
    assert "3 attempts" in plan.message


def test_a_doubt_about_a_step_has_the_steps_rewritten():
    model = scripted(ReviewSteps=[doubt("1", "is it the right way round?"), APPROVED])
    plan = plan_with(model, THOROUGH)
    assert plan.verified
    assert plan.questions[0].about == "step 1"
    assert asked(model, "WriteSteps")[1].question.doubt == "is it the right way round?"


@pytest.mark.parametrize(("until", "status"), [("draft", "draft"), ("checked", "checked"), ("grounded", "grounded")])
@pytest.mark.parametrize("mode", ["lean", "paper"])
def test_until_stops_early(until, status, mode):
    model = scripted()
    plan = plan_with(model, TeamConfig(mode=mode), until=until)
    assert plan.status == status
    assert not asked(model, "WriteSteps")
