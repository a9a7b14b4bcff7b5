"""Planted faults are labelled, strike once, and the team catches a wrong first box and a wrong plan."""

from __future__ import annotations

from tests.planning.helpers import APPROVED, doubt, draft, plan_with, scripted, subgoal
from wonderful_team.models.wrappers import Injecting, Injection, demo_injections, shift_box, swap_targets
from wonderful_team.planning import TeamConfig


def test_an_injected_box_is_labelled_and_shifted_by_the_stated_radii():
    model = Injecting(scripted(), [Injection(("GiveBox",), shift_box(1.0), "first box beside its object")])
    clean, spoiled = plan_with(scripted()), plan_with(model)
    event = next(e for e in spoiled.grounded["T1"].history if e.what == "box")
    right = next(e for e in clean.grounded["T1"].history if e.what == "box")
    assert event.provenance == "injected"
    assert abs(event.box.centre[0] - right.box.centre[0]) == right.box.width / 2
    assert spoiled.grounded["T2"].history[1].provenance != "injected", "it strikes once"


def test_a_swapped_plan_reads_the_wrong_way_round():
    value = type("Q", (), {})
    plan = draft(subgoal("G1"))
    from wonderful_team.contracts import PlanDraft

    swapped = swap_targets(PlanDraft(**plan), value)
    assert swapped.subgoals[0].text == "put the second thing into the first thing"
    assert swapped.subgoals[0].targets == ["T2", "T1"]


def test_verification_sees_the_injected_plan_and_its_doubt_is_recorded():
    def review(request):
        right = request.question.subgoals[0].text == "put the first thing into the second thing"
        return APPROVED if right else doubt(question="is it not the other way round?")

    better = draft(subgoal("G1"))
    model = scripted(
        ReviewPlan=review, RevisePlan={"reasoning": "", "decision": "revise", "answer": "Yes.", "plan": better}
    )
    plan = plan_with(Injecting(model, demo_injections()), TeamConfig(way="lean"))
    assert plan.first_draft[0].text == "put the second thing into the first thing"
    assert plan.subgoals[0].text == "put the first thing into the second thing"
    assert plan.questions[0].changed
