"""Planted faults are labelled, strike once, and the team catches a wrong first box and a wrong plan."""

from __future__ import annotations

import pytest

from tests.planning.helpers import APPROVED, doubt, draft, plan_with, scripted, subgoal
from wonderful_team.models.wrappers import SHIFT_RADII, Injecting, Injection, shift_box
from wonderful_team.planning import TeamConfig


def test_an_injected_box_is_labelled_and_shifted():
    model = Injecting(scripted(), [Injection(("GiveBox",), shift_box, "first box beside its object")])
    clean, spoiled = plan_with(scripted()), plan_with(model)
    event = next(e for e in spoiled.grounded["T1"].history if e.what == "box")
    right = next(e for e in clean.grounded["T1"].history if e.what == "box")
    assert event.provenance == "injected"
    assert abs(event.box.centre[0] - right.box.centre[0]) == pytest.approx(SHIFT_RADII * right.box.width / 2)
    assert spoiled.grounded["T2"].history[1].provenance != "injected", "it strikes once"


def test_verification_sees_the_injected_plan_and_its_doubt_is_recorded():
    def review(request):
        right = request.question.subgoals[0].text == "put the first thing into the second thing"
        return APPROVED if right else doubt(question="is it not the other way round?")

    def wrong_way_round(plan, request):
        swapped = plan.subgoals[0].model_copy(update={"text": "put the second thing into the first thing"})
        return plan.model_copy(update={"subgoals": [swapped]})

    better = draft(subgoal("G1"))
    model = scripted(
        ReviewPlan=review,
        ReviewSteps=review,
        RevisePlan={"reasoning": "", "decision": "revise", "answer": "Yes.", "plan": better},
    )
    planted = Injecting(model, [Injection(("DraftPlan",), wrong_way_round, "a plan the wrong way round")])
    plan = plan_with(planted, TeamConfig(mode="lean"))
    assert plan.first_draft[0].text == "put the second thing into the first thing"
    assert plan.subgoals[0].text == "put the first thing into the second thing"
    assert plan.questions[0].changed
