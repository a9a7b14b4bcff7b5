"""Verification walks through the subgoals, and reviews steps with what was computed and settled before."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.agents.question_samples import KINDS, SUBGOALS, TASK
from tests.agents.test_agent_requests import build, shown
from tests.planning.helpers import APPROVED, asked, doubt, plan_with, scripted
from wonderful_team.contracts import PlanReview, ReviewPlan, WalkedReview
from wonderful_team.core.actions import At, PickPlace, PickPlaceStep, Push, PushStep
from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.values import GroundedTarget, Limits, NumberSource, PlannedAction, Target, View
from wonderful_team.motion.in_words import numbers_in_words

T7, T8, T9 = (Target(name, "object", words) for name, words in (("T7", "mug"), ("T8", "tray"), ("T9", "lost lamp")))
QUESTION = ReviewPlan(TASK, KINDS, SUBGOALS, (T7, T8, T9))


def check(subgoal: str, verdict: str = "fine") -> dict[str, str]:
    said = {"before": "the picture", "doable": "yes", "after": "nothing", "asked": "yes"}
    return {"subgoal": subgoal, **said, "verdict": verdict}


def settle(question: ReviewPlan, walk: list[dict[str, str]], approved: bool = True) -> Any:
    raised = None if approved else {"about": "G1", "kind": "missing_subgoal", "question": "where is the rest?"}
    answer = WalkedReview.model_validate({"walk": walk, "approved": approved, "doubt": raised})
    return question.validate(answer)


def test_every_subgoal_to_be_checked_is_walked_through_once() -> None:
    settle(QUESTION, [check("G1"), check("G2")])
    settle(replace(QUESTION, under_check="G2"), [check("G2")])
    with pytest.raises(ValueError, match="must hold every subgoal that is to be checked; missing: G2"):
        settle(QUESTION, [check("G1")])
    with pytest.raises(ValueError, match="must be unique"):
        settle(QUESTION, [check("G1"), check("G1"), check("G2")])
    with pytest.raises(ValueError, match="unknown subgoal in the walk 'G1'; valid: G2"):
        settle(replace(QUESTION, under_check="G2"), [check("G1"), check("G2")])


@pytest.mark.parametrize("verdict", ["wrong", "cannot_tell"])
def test_a_plan_is_not_approved_against_its_own_walk(verdict: str) -> None:
    with pytest.raises(ValueError, match=f"approved, yet the walk says G2 {verdict}"):
        settle(QUESTION, [check("G1"), check("G2", verdict)])
    settle(QUESTION, [check("G1"), check("G2", verdict)], approved=False)


def test_an_answer_without_a_walk_goes_back_unless_it_is_one_of_an_earlier_release() -> None:
    with pytest.raises(ValueError, match="missing: G1, G2"):
        QUESTION.validate(WalkedReview.model_validate({"approved": True, "doubt": None}))
    QUESTION.validate(WalkedReview.model_validate({"reasoning": "all good", "approved": True, "doubt": None}))
    schema = WalkedReview.model_json_schema()
    assert schema["required"] == ["walk", "approved", "doubt"]
    assert "reasoning" not in schema["properties"]


def test_clauses_are_bounded() -> None:
    with pytest.raises(ValueError, match="at most 300 characters"):
        WalkedReview.model_validate({"walk": [{**check("G1"), "after": "x" * 301}], "approved": True, "doubt": None})


def test_a_walk_for_models_that_judge_otherwise_says_what_their_doubt_says() -> None:
    raised = {"about": "G2", "kind": "missing_prerequisite", "question": "is the tray free?"}
    review = PlanReview.model_validate({"reasoning": "", "approved": False, "doubt": raised})
    answer, _ = QUESTION.validate(QUESTION.walked(review))
    assert [item.verdict for item in answer.walk] == ["fine", "wrong"]
    assert answer.walk[1].before == "is the tray free?"


def test_words_ask_for_reasons_and_do_not_lean_towards_approval() -> None:
    text = " ".join(shown(build(QUESTION)).split())
    for said in ("First walk through the subgoals", "taken until a later subgoal clears it", "missing_subgoal"):
        assert said in text
    for gone in ("most short plans are sound", "When you are not sure"):
        assert gone not in text


def test_a_target_that_no_subgoal_names_is_pointed_out() -> None:
    text = shown(build(QUESTION))
    assert "Targets that no subgoal names: a lost subgoal?:\n- T9" in text
    assert "no subgoal names:" not in shown(build(replace(QUESTION, targets=(T7, T8))))


def test_the_review_of_steps_is_told_what_the_plan_phase_settled() -> None:
    reviews = iter([doubt("G1", "is the tray free?"), APPROVED])
    model = scripted(
        ReviewPlan=lambda _: next(reviews),
        RevisePlan={"reasoning": "", "decision": "keep", "answer": "It is free.", "plan": None},
    )
    plan_with(model)
    (request,) = asked(model, "ReviewSteps")
    assert "asked about G1: is the tray free? Answer: It is free. (kept)" in shown(request)
    assert "nothing yet" not in shown(request)


SCALE = 200.0
CAMERA = AffineCamera(np.array([[0, SCALE, 0, 0], [SCALE, 0, 0, 0], [0, 0, -1, 1.0]]))
LIMITS = Limits((0, 0, 0), (1, 1, 1), clearance_m=0.2, blade_m=0.05)


def view(depth: bool = True) -> View:
    depth_m = np.ones((200, 200))
    depth_m[80:120, 90:110] = 0.88  # a wall, 12 cm high
    return View("top", "top", 0.0, np.zeros((200, 200, 3), np.uint8), depth_m if depth else None, CAMERA)


def source(role: str, target: str, px: tuple[float, float], how: str = "") -> NumberSource:
    return NumberSource(role, target, px, (px[1] / SCALE, px[0] / SCALE, 0.0), how)


def found(name: str, box: Box) -> GroundedTarget:
    return GroundedTarget(Target(name, "object", name), "found", "top", box)


def test_heights_on_the_way_are_said_in_words() -> None:
    action = PickPlace(np.array([0.5, 0.1, 0.03]), np.array([0.5, 0.9, 0.0]))
    planned = PlannedAction(
        PickPlaceStep("G1", "T1", At("T2")),
        action,
        (source("pick", "T1", (20, 100)), source("place", "T2", (180, 100))),
    )
    (line,) = numbers_in_words([planned], {}, view(), LIMITS)
    assert line == (
        "step 1: held at 3.0 cm, put down on a surface at 0.0 cm; the highest surface under its way is at 12.0 cm, and it is "
        "carried 20.0 cm over the table"
    )
    assert isinstance(planned.action, PickPlace)
    tall = replace(planned, action=replace(planned.action, place_m=planned.action.place_m + (0, 0, 0.25)))
    assert "carried 25.0 cm" in numbers_in_words([tall], {}, view(), LIMITS)[0], "as the gate has it: above both ends"
    (blind,) = numbers_in_words([planned], {}, view(depth=False), LIMITS)
    assert "heights are not known" in blind
    (pixels,) = numbers_in_words([replace(planned, action=None)], {}, view(), LIMITS)
    assert "no camera is known" in pixels


def test_the_strip_of_a_push_and_the_room_beside_it_are_said_in_words() -> None:
    action = Push(np.array([0.5, 0.1, 0.0]), np.array([0.5, 0.6, 0.0]))
    planned = PlannedAction(
        PushStep("G1", At("T1"), At("T2")),
        action,
        (source("push_start", "T1", (20, 100)), source("push_end", "T2", (120, 100), "a guess")),
    )
    grounded = {
        "T1": found("T1", Box(22, 94, 36, 106)),  # 6 cm across the way: wider than the blade
        "T3": found("T3", Box(60, 110, 80, 120)),  # 2 cm beside the strip
        "T4": found("T4", Box(60, 60, 80, 96)),  # 1 cm in it
        "T5": found("T5", Box(60, 150, 80, 190)),
    }
    (line,) = numbers_in_words([planned], grounded, view(), LIMITS)
    assert "50.0 cm along the surface" in line
    assert "tool and thing sweep a strip 6.0 cm wide" in line
    assert "2.0 cm between the strip and the box of T3" in line
    assert "the strip crosses the box of T4" in line
    assert "T5" not in line
    assert "a guess, no picture shows it" in line
    spot = replace(grounded["T4"], target=Target("T4", "area", "spot"))
    assert "T4" not in numbers_in_words([planned], {**grounded, "T4": spot}, view(), LIMITS)[0]
    again = replace(planned, sources=(source("push_start", "T3", (20, 100)), planned.sources[1]))
    assert "T3" in numbers_in_words([planned, planned], grounded, view(), LIMITS)[1]
    assert "T1" not in numbers_in_words([planned, again], grounded, view(), LIMITS)[1]
    (unknown,) = numbers_in_words([planned], grounded, view(), replace(LIMITS, blade_m=None))
    assert "how wide the tool is, is not known" in unknown
