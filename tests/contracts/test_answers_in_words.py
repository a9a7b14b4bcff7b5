"""What the contracts accept and refuse of plans, steps, reviews, notes and verdicts: one row a case."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import pytest

from tests.agents.question_samples import SAMPLES
from tests.contracts.right_answers import PLAN, QUESTION, changed, judged, subgoal, target
from wonderful_team.contracts import Question
from wonderful_team.core.actions import Beside, FollowStep, MoveStep, OriginOf, PickPlaceStep
from wonderful_team.core.values import MAX_ACTIONS, MAX_SUBGOALS, MAX_TARGETS

MANY_TARGETS = [target(f"T{number}") for number in range(1, MAX_TARGETS + 2)]
MANY_SUBGOALS = [subgoal(f"G{number}") for number in range(1, MAX_SUBGOALS + 2)]
HOME = {"subgoal": "G1", "kind": "home"}
PICK = {"subgoal": "G1", "kind": "pick_place", "pick": "T7", "rotate_deg": 0}
LONG_PLAN = f"the plan has {MAX_SUBGOALS + 1} subgoals, at most {MAX_SUBGOALS} are allowed"
MANY = f"the plan has {MAX_TARGETS + 1} targets, at most {MAX_TARGETS} are allowed"


def move(turn: float) -> dict[str, Any]:
    """A move that is turned so far [degrees]."""
    return {"pick": "T1", "place": {"target": "T2", "how": "at", "side": None}, "rotate_deg": turn}


def draft(place: str, value: Any, says: str) -> list[tuple[str, dict[str, Any], str]]:
    """The same defect in a plan that is drafted and in one that is revised."""
    return [("DraftPlan", {place: value}, says), ("RevisePlan", {f"plan.{place}": value}, says)]


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    *draft("subgoals.1.id", "G1", "subgoal ids must be unique; these occur twice: G1"),
    *draft("subgoals.1.after", ["G7"], "unknown subgoal in 'after' of G2 'G7'; valid: G1, G2"),
    *draft("subgoals.1.after", ["{G1}"], "unknown subgoal in 'after' of G2 '{G1}'; valid: G1, G2"),
    *draft("subgoals.0.after", ["G2"], "subgoal G1 stands before G2, which it says must come first"),
    *draft("subgoals.0.after", ["G1"], "subgoal G1 stands before G1, which it says must come first"),
    *draft("subgoals.1.targets", ["T3"], "unknown target of subgoal G2 'T3'; valid: T1, T2"),
    *draft("subgoals.1.targets", [], "subgoal G2 names no target"),
    *draft("subgoals.0.text", "", "subgoals.0.text.*at least 1 character"),
    *draft("subgoals.0.text", None, "subgoals.0.text.*valid string"),
    *[row for turn in (361.0, -1e18, math.inf, math.nan) for row in draft("subgoals.0.move", move(turn), "move.rotate_deg")],
    *draft("subgoals.0.move", {**move(0.0), "pick": "T9"}, "unknown target in the move of G1 'T9'; valid: T1, T2"),
    *draft("targets.1.id", "T1", "target ids must be unique; these occur twice: T1"),
    *draft("targets.0.words", "", "targets.0.words.*at least 1 character"),
    *draft("targets.0.kind", "robot", "targets.0.kind.*'object' or 'area'"),
    *draft("targets.0.use", ["eat"], "targets.0.use.0"),
    *draft("targets.0.like", ["cup"], "unknown picture in 'like' of T1 'cup'; valid: dragged_obj, base_obj, scene_1"),
    *draft("targets.0.like", ["{cup}"], "unknown picture in 'like' of T1 'cup'"),
    *draft("mode", "both", "mode.*'full' or 'one_step'"),
    *draft("clarification", {"question": "", "choices": []}, "clarification.question.*at least 1 character"),
    *draft("subgoals", MANY_SUBGOALS, LONG_PLAN),
    *draft("targets", MANY_TARGETS, MANY),
    ("RevisePlan", {"plan": None}, "plan must be given exactly when the decision is revise"),
    ("RevisePlan", {"decision": "keep"}, "plan must be given exactly when the decision is revise"),
    ("RevisePlan", {"answer": ""}, "answer.*at least 1 character"),
    ("ExtractTargets", {"needs.0.subgoal": "G5"}, "unknown subgoal 'G5'; valid: G1, G2"),
    ("ExtractTargets", {"needs.0.subgoal": "G2"}, "needs must list every subgoal; missing: G1"),
    ("ExtractTargets", {"needs": []}, "needs must list every subgoal; missing: G1, G2"),
    ("ExtractTargets", {"needs.1.targets": ["T9"]}, "unknown target of subgoal G2 'T9'; valid: T1, T2"),
    ("ExtractTargets", {"needs.1.targets": []}, "needs.1.targets.*at least 1 item"),
    ("ExtractTargets", {"targets.0.id": "T2"}, "target ids must be unique; these occur twice: T2"),
    ("ExtractTargets", {"targets": MANY_TARGETS}, MANY),
    ("ReviewPlan", {"approved": True}, "doubt must be null exactly when approved is true"),
    ("ReviewPlan", {"doubt": None}, "doubt must be null exactly when approved is true"),
    ("ReviewPlan", {"doubt.about": "G3"}, "unknown subgoal 'G3'; valid: G1, G2, plan"),
    ("ReviewPlan", {"doubt.about": "T7"}, "unknown subgoal 'T7'; valid: G1, G2, plan"),
    ("ReviewPlan", {"doubt.kind": "taste"}, "doubt.kind"),
    ("ReviewPlan", {"doubt.question": ""}, "doubt.question.*at least 1 character"),
    ("ReviewSteps", {"doubt.about": "0"}, "unknown step or subgoal '0'; valid: 1, 2, G1, G2, plan"),
    ("ReviewSteps", {"doubt.about": "G3"}, "unknown step or subgoal 'G3'; valid: 1, 2, G1, G2, plan"),
    ("ReviewSteps", {"doubt.kind": "wrong_point"}, "unknown target for a doubt of kind wrong_point '2'; valid: T7, T8"),
    ("ReviewSteps", {"walk": []}, "the walk must hold every subgoal that is to be checked; missing: G1, G2"),
    ("ReviewSteps", {"doubt.about": 2}, "doubt.about.*valid string"),
    ("ReviewSteps", {"approved": True}, "doubt must be null exactly when approved is true"),
    ("WriteSteps", {"steps": []}, "the plan has subgoals but no steps"),
    ("WriteSteps", {"steps": [HOME]}, "no step serves subgoal G2"),
    ("WriteSteps", {"steps": [HOME] * (MAX_ACTIONS + 1)}, f"{MAX_ACTIONS + 1} actions, at most {MAX_ACTIONS} are allowed"),
    ("WriteSteps", {"steps.0.subgoal": "G9"}, "unknown subgoal 'G9'; valid: G1, G2"),
    ("WriteSteps", {"steps.0.pick": "T1"}, "unknown target in step 1 'T1'; valid: T7, T8"),
    ("WriteSteps", {"steps.0.pick": "{T7}"}, "unknown target in step 1 '{T7}'; valid: T7, T8"),
    ("WriteSteps", {"steps.0.place.target": "T9"}, "unknown target in step 1 'T9'; valid: T7, T8"),
    ("WriteSteps", {"steps.0.place.side": None}, "a place beside a target needs a side: left, right, above or below"),
    ("WriteSteps", {"steps.0.place.side": "behind"}, "side"),
    ("WriteSteps", {"steps.0.place.how": "under"}, "how"),
    ("WriteSteps", {"steps.0.rotate_deg": 361}, "rotate_deg.*less than or equal to 360"),
    ("WriteSteps", {"steps.0.rotate_deg": float("nan")}, "rotate_deg"),
    ("WriteSteps", {"steps.1.function": "G2"}, "unknown function in step 2 'G2'; valid: G1"),
    ("WriteSteps", {"steps.2.height": "high"}, "height"),
    ("WriteSteps", {"steps.0.kind": "throw"}, "'pick_place', 'push'"),
    ("WriteFunction", {"code": ""}, "code.*at least 1 character"),
    ("ReviewPath", {"accepted": True}, "problem must be empty exactly when accepted is true"),
    ("ReviewPath", {"problem": ""}, "problem must be empty exactly when accepted is true"),
    ("Remember", {"keep": False}, "key and summary must be given exactly when keep is true"),
    ("Remember", {"key": ""}, "key and summary must be given exactly when keep is true"),
    ("Remember", {"summary": ""}, "key and summary must be given exactly when keep is true"),
    ("Remember", {"key": "k" * 61}, "key.*at most 60 characters"),
    ("Remember", {"summary": "s" * 601}, "summary.*at most 600 characters"),
    ("JudgeOutcome", {"verdicts.1.subgoal": "G1"}, "verdicts must hold each subgoal once: G1, G2"),
    ("JudgeOutcome", {"verdicts.1.subgoal": "G3"}, "verdicts must hold each subgoal once: G1, G2"),
    ("JudgeOutcome", {"verdicts": []}, "verdicts must hold each subgoal once: G1, G2"),
    ("JudgeOutcome", {"verdicts.0.status": "perhaps"}, "verdicts.0.status"),
    ("JudgeSubgoal", {"rest_holds": True}, "what_changed must be empty exactly when rest_holds is true"),
    ("JudgeSubgoal", {"what_changed": ""}, "what_changed must be empty exactly when rest_holds is true"),
    ("JudgeSubgoal", {"status": "undone"}, "status.*'done', 'not_done' or 'unclear'"),
    ("Replan", {"advice": ""}, "advice must be given exactly when the decision is replan"),
    ("Replan", {"decision": "give_up"}, "advice must be given exactly when the decision is replan"),
    ("Replan", {"decision": "retry"}, "decision.*'done', 'replan' or 'give_up'"),
]  # fmt: skip


@pytest.mark.parametrize(("contract", "changes", "says"), REFUSED)
def test_a_wrong_answer_is_refused_by_what_is_wrong(contract: str, changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=f"(?s){says}"):
        judged(QUESTION[contract], changed(contract, changes))


UNCLEAR = {"question": "Which {mug}?", "choices": ["the red one", "the blue one"]}
ACCEPTED: list[tuple[str, dict[str, Any]]] = [
    ("DraftPlan", {"subgoals": [], "targets": []}),
    # A question stands alone: whatever else was written beside it is not used.
    ("DraftPlan", {"clarification": UNCLEAR, "subgoals": [subgoal("G1", targets=("T9",))]}),
    # Words are data: braces and quotes in them mean nothing.
    ("DraftPlan", {"targets.0.words": "the {base_obj} called \"{0}\"", "subgoals.0.text": "{}"}),
    ("RevisePlan", {"decision": "keep", "plan": None}),
    ("ReviewPlan", {"approved": True, "doubt": None, "walk.0.verdict": "fine"}),
    ("ReviewSteps", {"approved": True, "doubt": None}),
    ("ReviewSteps", {"doubt.about": "G1"}),
    ("ReviewSteps", {"doubt.about": "T7", "doubt.kind": "wrong_point"}),
    ("ReviewPath", {"accepted": True, "problem": ""}),
    ("Remember", {"keep": False, "key": "", "summary": ""}),
    ("Replan", {"decision": "done", "advice": ""}),
    ("JudgeOutcome", {"verdicts.0.cause": "", "verdicts.0.evidence": "{}"}),
    ("WriteSteps", {"steps.2": {**HOME, "subgoal": "G2"}}),
]  # fmt: skip


@pytest.mark.parametrize(("contract", "changes"), ACCEPTED)
def test_a_right_answer_is_taken(contract: str, changes: dict[str, Any]) -> None:
    said = changed(contract, changes)
    answer, repairs = judged(QUESTION[contract], said)
    assert (answer, repairs) == (type(answer).model_validate(said), ())


def test_a_plan_without_targets_may_name_none_in_its_subgoals() -> None:
    without = replace(QUESTION["DraftPlan"], with_targets=False)
    plan = {**PLAN, "targets": [], "subgoals": [subgoal("G1", targets=()), subgoal("G2", targets=("T5",))]}
    answer, _ = judged(without, plan)
    assert [goal.id for goal in answer.to_subgoals()] == ["G1", "G2"]  # type: ignore[attr-defined]
    with pytest.raises(ValueError, match="unknown target of subgoal G2 'T5'; valid: none"):
        judged(QUESTION["DraftPlan"], {**plan, "subgoals": plan["subgoals"][1:]})


def test_a_doubt_about_a_plan_without_subgoals_is_about_the_plan() -> None:
    empty = replace(QUESTION["ReviewPlan"], subgoals=())
    assert judged(empty, changed("ReviewPlan", {"doubt.about": "plan"}))[1] == ()
    with pytest.raises(ValueError, match="unknown subgoal 'G2'; valid: plan"):
        judged(empty, changed("ReviewPlan", {}))


def test_steps_become_what_was_written() -> None:
    answer: Any = judged(QUESTION["WriteSteps"], changed("WriteSteps", {}))[0]
    assert answer.to_steps() == (
        PickPlaceStep("G1", "T7", Beside("T8", "left"), -90.0),
        FollowStep("G1", "G1"),
        MoveStep("G2", OriginOf("T7"), "clear"),
    )


@pytest.mark.parametrize("kinds", [("home",), ("home", "open"), ("pick_place", "push")])
def test_only_kinds_of_steps_that_the_world_can_run_are_taken(kinds: tuple[str, ...]) -> None:
    asked = replace(QUESTION["WriteSteps"], step_kinds=kinds)
    other = {"subgoal": "G1", "kind": "close", "tight": True}
    with pytest.raises(ValueError, match=f"'{kinds[0]}'"):
        judged(asked, {"reasoning": "", "steps": [other]})


def test_what_a_target_is_for_is_said_once() -> None:
    answer: Any = judged(QUESTION["DraftPlan"], changed("DraftPlan", {"targets.0.use": ["pick", "grasp", "pick"]}))[0]
    first, second = answer.to_targets()
    assert (first.use, first.source, second.source) == (("pick", "grasp"), "slot", "scene")


def _offered(question: Question) -> str:
    return json.dumps(question.output().model_json_schema())


def test_a_planner_is_offered_nothing_that_its_method_has_no_use_for() -> None:
    sample: dict[str, Any] = {one.contract: one for one in SAMPLES}
    # Without outlines nothing has a side: neither in a plan from a list nor in steps of points alone. Who answers so all the same is read.
    assert '"beside"' in _offered(sample["WriteSteps"])
    alone = replace(sample["WriteSteps"], outlines=False)
    assert '"beside"' not in _offered(alone) + _offered(sample["PlanFromList"])
    place = {"target": "T1", "how": "beside", "side": "left"}
    step = {"subgoal": "G1", "kind": "pick_place", "pick": "T2", "place": place, "rotate_deg": 0.0}
    read: Any = replace(alone, step_kinds=("pick_place",)).output().model_validate({"reasoning": "", "steps": [step]})
    assert read.to_steps()[0].place == Beside("T1", "left")
    # No boxes are drawn when a plan is checked alone.
    assert "wrong_box" in _offered(sample["ReviewSteps"])
    assert "wrong_box" not in _offered(sample["ReviewPlan"])


def test_who_plans_directly_says_what_there_is_before_the_steps_that_name_it() -> None:
    schema = next(one for one in SAMPLES if one.contract == "PlanDirectly").output().model_json_schema()
    assert list(schema["properties"]) == ["reasoning", "subgoals", "targets", "absent", "steps"]
