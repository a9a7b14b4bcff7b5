"""What a trial accepted of helper functions is offered to its later steps, run and reviewed as any other, and stays in that trial."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from tests.planning.helpers import APPROVED, asked, plan_with, scripted
from tests.planning.rounds import photo
from wonderful_team.core.actions import ARM
from wonderful_team.core.geometry import Box
from wonderful_team.core.protocols import Situation
from wonderful_team.core.values import (
    NO_WORKSPACE,
    FunctionBox,
    HelperFunction,
    Instruction,
    Plan,
    Request,
    Subgoal,
    Words,
)
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning import function_library as library
from wonderful_team.planning.function_library import MAX_FUNCTIONS, MOST_CODE, MOST_SHOWN, next_name, shown, told
from wonderful_team.record import plan_from_json, plan_to_json

ROUND = "a path round it"
FRAME = "def path(boxes):\n    x0, y0, x1, y1 = boxes['T1']\n    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]"
ACROSS = "def path(boxes):\n    x0, y0, x1, y1 = next(iter(boxes.values()))\n    return [(x0, y0), (x1, y1)]"
COUNTING = "COUNT = 0\ndef path(boxes):\n    global COUNT\n    COUNT += 1\n    return [(0, 0), (3, COUNT)]"
ACCEPTED = {"reasoning": "", "accepted": True, "problem": ""}
REFUSED = {"reasoning": "", "accepted": False, "problem": "it is too wide"}


def goal(name: str, target: str, purpose: str = ROUND) -> dict[str, Any]:
    return {"id": name, "text": f"draw round {target}", "after": [], "targets": [target], "function": purpose}


def draft(*goals: dict[str, Any]) -> dict[str, Any]:
    targets = [
        {"id": name, "kind": "object", "words": words, "part": None, "where": "", "like": [], "use": ["place"]}
        for name, words in (("T1", "the red block"), ("T2", "the blue block"))
    ]
    used = {name for one in goals for name in one["targets"]}
    held = [one for one in targets if one["id"] in used]
    return {"reasoning": "", "subgoals": [*goals], "targets": held, "mode": "one_step", "clarification": None}


def steps(request: Request) -> dict[str, Any]:
    return {
        "reasoning": "",
        "steps": [{"kind": "follow", "subgoal": name, "function": name} for name in request.question.functions],
    }


def reuses(request: Request) -> dict[str, Any]:
    """The frame, or the newest earlier function that has this purpose."""
    question = request.question
    for one in question.earlier:
        if one.purpose == question.subgoal.function and not question.error:
            given = ", ".join(f"{a!r}: boxes[{b!r}]" for a, b in zip(one.takes, question.boxes, strict=True))
            return code(f"def path(boxes):\n    return {one.name}({{{given}}})")
    return code(ACROSS if "line" in question.subgoal.function else FRAME.replace("T1", next(iter(question.boxes))))


def code(text: str) -> dict[str, Any]:
    return {"reasoning": "", "code": text}


def drawing(*goals: dict[str, Any], **changes: Any) -> ScriptedModel:
    script = {"DraftPlan": draft(*goals), "WriteFunction": reuses, "ReviewPath": ACCEPTED, "WriteSteps": steps}
    return scripted(**{**script, **changes})


def made(team: TeamPolicy, **options: Any) -> Plan:
    instruction = Instruction("draw round the blocks")
    return asyncio.run(team.make_plan(photo(), instruction, ARM, **options))


def words_of(request: Request) -> str:
    return "\n".join(part.text for part in request.parts if isinstance(part, Words))


def written(model: ScriptedModel) -> list[tuple[str, list[str]]]:
    """For which subgoal a function was asked for, and what was offered."""
    return [
        (one.question.subgoal.id, [held.name for held in one.question.earlier]) for one in asked(model, "WriteFunction")
    ]


# -- within one plan --------------------------------------------------------------------------------------------------


def test_a_second_subgoal_with_the_same_purpose_waits_and_calls_the_first_ones_function() -> None:
    model = drawing(
        goal("G1", "T1", "a path round T1"), goal("G2", "T2", "A path  round T2"), goal("G3", "T2", "a line across")
    )
    plan = plan_with(model, TeamConfig(), vocabulary=ARM)
    assert plan.status == "planned", plan.message
    assert [name for name, _ in written(model)] == ["G1", "G3", "G2"], "only what has the same purpose waits"
    assert written(model)[2] == ("G2", ["path_1", "path_2"])
    order = [one.contract for one in model.requests if one.contract in ("WriteFunction", "ReviewPath")]
    assert order[:2] == ["WriteFunction"] * 2, "what has another purpose is written side by side"


def test_what_is_called_again_is_run_drawn_and_reviewed_for_its_own_boxes() -> None:
    model = drawing(goal("G1", "T1"), goal("G2", "T2"))
    plan = plan_with(model, TeamConfig(), vocabulary=ARM)
    assert [one.name for one in plan.functions] == ["path_1"], "a call of it is no second function"
    first, second = (one.question for one in asked(model, "ReviewPath"))
    assert (first.subgoal.id, second.subgoal.id) == ("G1", "G2")
    assert first.view.marks[-1].points != second.view.marks[-1].points
    boxes = {one.id: plan.grounded[one.id].box for one in plan.targets}
    corner = [planned.sources[0].point_px for planned in plan.actions]
    assert corner == [pytest.approx((boxes[name].x0, boxes[name].y0)) for name in ("T1", "T2")]


def test_a_call_that_the_review_refuses_goes_back_to_its_author() -> None:
    reviews = iter([ACCEPTED, REFUSED, ACCEPTED])
    model = drawing(goal("G1", "T1"), goal("G2", "T2"), ReviewPath=lambda _: next(reviews))
    plan = plan_with(model, TeamConfig(), vocabulary=ARM)
    assert plan.status == "planned", plan.message
    again = asked(model, "WriteFunction")[-1].question
    assert again.error == "the path was drawn and refused: it is too wide"
    assert [one.name for one in again.earlier] == ["path_1"]


def test_an_error_inside_an_earlier_function_goes_back_too() -> None:
    tries = iter([code(FRAME), code("def path(boxes):\n    return path_1(boxes)"), code(ACROSS)])
    model = drawing(goal("G1", "T1"), goal("G2", "T2"), WriteFunction=lambda _: next(tries))
    plan = plan_with(model, TeamConfig(), vocabulary=ARM)
    assert plan.status == "planned", plan.message
    assert "KeyError" in asked(model, "WriteFunction")[-1].question.error
    assert [one.name for one in plan.functions] == ["path_1", "path_2"]


def test_a_target_that_is_found_elsewhere_has_its_own_path_computed_again_and_no_other() -> None:
    doubted = {"about": "T1", "kind": "wrong_box", "question": "is that the red one?"}
    reviews = iter([{"reasoning": "", "approved": False, "doubt": doubted}, APPROVED])

    def review(request: Request) -> Any:
        from wonderful_team.contracts import PlanReview

        said = PlanReview.model_validate(next(reviews))
        return request.question.in_form(said).model_dump(exclude_unset=True)

    model = drawing(goal("G1", "T1"), goal("G2", "T2", "a line across"), ReviewSteps=review)
    plan = plan_with(model, TeamConfig(), vocabulary=ARM)
    assert plan.status == "planned", plan.message
    assert [name for name, _ in written(model)] == ["G1", "G2", "G1"]
    assert len(plan.actions) == 2


# -- from plan to plan ------------------------------------------------------------------------------------------------


def test_a_replan_is_told_of_them_and_offers_them_and_a_first_plan_hears_nothing() -> None:
    model = drawing(goal("G1", "T1"))
    team = TeamPolicy(model, TeamConfig())
    made(team)
    again = made(team, advice=("the pen never touched the table",))
    assert again.status == "planned", again.message
    first, second = asked(model, "DraftPlan")
    assert (first.question.functions, second.question.functions) == (
        (),
        ("path_1: a path round it (T1 was the red block)",),
    )
    assert 'as in "a circle round T2, by path_1"' in words_of(second)
    assert "- path_1: a path round it (T1 was the red block)" in words_of(second)
    assert written(model) == [("G1", []), ("G1", ["path_1"])]
    one, two = asked(model, "WriteFunction")
    assert "where its path is what went wrong before, compute a better one" in words_of(two)
    assert "the pen never touched the table" in words_of(two)
    assert two.pictures[-1].marks[-1].label == "path_1", "what it drew is shown"
    assert all("accepted earlier" not in words_of(one) for one in (first, one))


def test_what_went_wrong_is_no_news_to_whoever_has_no_earlier_function() -> None:
    model = drawing(goal("G1", "T1"))
    made(TeamPolicy(model, TeamConfig()), advice=("the pen never touched the table",))
    (only,) = asked(model, "WriteFunction")
    assert only.question.advice == ()
    assert "the pen never" not in words_of(only)


def test_what_was_accepted_in_a_plan_that_failed_is_kept() -> None:
    def write(request: Request) -> dict[str, Any]:
        return code(FRAME if request.question.subgoal.id == "G1" else "def path(boxes): return []")

    model = drawing(goal("G1", "T1"), goal("G2", "T2"), WriteFunction=write)
    team = TeamPolicy(model, TeamConfig())
    plan = made(team)
    assert (plan.status, plan.stage) == ("failed", "function")
    assert [one.name for one in plan.functions] == ["path_1"]
    made(team)
    assert asked(model, "DraftPlan")[-1].question.functions


def test_a_trial_that_goes_on_from_a_plan_file_goes_on_with_its_functions() -> None:
    plan = plan_from_json(plan_to_json(made(TeamPolicy(drawing(goal("G1", "T1")), TeamConfig()))))
    assert plan.functions[0].code == FRAME
    model = drawing(goal("G1", "T1"))
    team = TeamPolicy(model, TeamConfig())
    told = Situation(photo(), plan.instruction, ARM, NO_WORKSPACE, attempt=0, replans_left=1)
    asyncio.run(team.decide(replace(told, plan=plan)))
    made(team)
    assert written(model) == [("G1", ["path_1"])]


def test_another_trial_sees_nothing_of_it() -> None:
    model = drawing(goal("G1", "T1"))
    team = TeamPolicy(model, TeamConfig())
    made(team)
    situation = Situation(photo(), Instruction("draw round the blocks"), ARM, NO_WORKSPACE, attempt=0, replans_left=1)
    asyncio.run(team.decide(situation))
    other = TeamPolicy(model, TeamConfig())
    made(other)
    assert written(model) == [("G1", [])] * 3
    assert all(one.question.functions == () for one in asked(model, "DraftPlan"))


# -- what is kept, and what is shown of it ----------------------------------------------------------------------------


def function(number: int, text: str = ACROSS, purpose: str | None = None, side: float = 10.0) -> HelperFunction:
    box = Box(0, 0, side, side)
    path = ((0.0, 0.0), (side, side))
    return HelperFunction(
        f"path_{number}", purpose or f"line {number}", text, (FunctionBox("T1", "the plate", box),), path
    )


def asks(purpose: str) -> Subgoal:
    return Subgoal("G1", "it is drawn", (), ("T5",), purpose)


def lines(number: int, calls: str = "") -> HelperFunction:
    """A function of its own, which may call another."""
    text = f"def path(boxes):\n    {calls}\n    return [(0, 0), ({number}, {number})]"
    return replace(function(number, text), path=((0.0, 0.0), (float(number), float(number))))


def kept(*functions: HelperFunction) -> tuple[HelperFunction, ...]:
    held: tuple[HelperFunction, ...] = ()
    for one in functions:
        held, _ = asyncio.run(library.with_function(held, one))
    return held


@pytest.mark.parametrize(
    ("again", "became"),
    [
        (function(2), "the path of path_1 again"),
        (function(2, "def path(boxes):\n    return path_1(boxes)", side=30.0), "the path of path_1 again"),
        (function(2, "def path(boxes):\n    # anew\n    return [boxes['T1'][:2], boxes['T1'][2:]]"), "the path of path_1 again"),
        (
            replace(function(2, COUNTING), path=((0.0, 0.0), (3.0, 1.0))),
            "not kept, it gives another path when it is called by a name",
        ),
    ],
    ids=["the same code", "a call", "rewritten", "a global"],
)  # fmt: skip
def test_what_adds_nothing_and_what_cannot_be_called_is_not_kept(again: HelperFunction, became: str) -> None:
    held = kept(function(1))
    assert asyncio.run(library.with_function(held, again)) == (held, became)


def test_at_the_limit_the_oldest_goes_that_no_other_one_calls() -> None:
    first = [lines(1), lines(2, "path_1(boxes)"), *(lines(k) for k in range(3, MAX_FUNCTIONS + 1))]
    held = kept(*first, lines(MAX_FUNCTIONS + 1))
    assert len(held) == MAX_FUNCTIONS
    assert [one.name for one in held[:2]] == ["path_1", "path_3"], "path_2 called path_1"
    assert next_name(held) == f"path_{MAX_FUNCTIONS + 2}", "a number is never given twice"


def test_what_is_shown_is_bounded_and_begins_with_what_is_asked_for() -> None:
    held = tuple(function(number) for number in range(1, 8))
    assert [one.name for one in shown(held, asks("a star"))] == ["path_7", "path_6", "path_5"]
    assert len(shown(held, asks("a star"))) == MOST_SHOWN
    assert [one.name for one in shown(held, asks("Line  2"))] == ["path_2", "path_7", "path_6"]
    assert [one.name for one in shown(held, asks("path_3 again, for the cup"))] == ["path_3", "path_7", "path_6"]
    assert [one.name for one in shown((*held, function(8, purpose="line 7")), asks(""))] == [
        "path_8",
        "path_6",
        "path_5",
    ]
    long = shown((function(1, ACROSS + "\n#" + "x" * 5_000),), asks(""))[0]
    assert len(long.code) < MOST_CODE + 50
    assert long.code.endswith("more characters)")
    wordy = function(1, purpose="a star " * 500)
    assert max(map(len, told((wordy,) * 9))) < 400
    assert len(told(held)) == library.MOST_TOLD


@pytest.mark.parametrize(
    "change",
    [
        lambda one: replace(one, path=tuple((x, y, 0.1) for x, y in one.path)),
        lambda one: replace(one, path=((5.0, 5.0), (5.0, 5.0)), boxes=()),
        lambda one: replace(one, path=((-900.0, 5.0), (1e6, 5.0))),
    ],
    ids=["rising", "one spot without a box", "far out"],
)
def test_any_path_can_be_drawn_on_white(change: Callable[[HelperFunction], HelperFunction]) -> None:
    (one,) = shown((change(function(1)),), asks(""))
    assert max(one.drawn.size_px) <= 330
    assert min(one.drawn.size_px) >= 1
    inside = one.drawn.frame.whole_box
    (path,) = [mark for mark in one.drawn.marks if hasattr(mark, "points")]
    assert all(inside.x0 <= x <= inside.x1 and inside.y0 <= y <= inside.y1 for x, y in path.points)


def test_a_path_of_a_plan_file_is_as_bounded_as_one_of_the_sandbox() -> None:
    with pytest.raises(ValueError, match="up to 1e\\+06 px"):
        replace(function(1), path=((0.0, 0.0), (1e308, 0.0)))
    with pytest.raises(ValueError, match="0 points; 2 or more are valid"):
        replace(function(1), path=())


@pytest.mark.parametrize("name", ["star", "path", "path_0", "path_1\nimport os", "len", "path_1_", ""])
def test_a_function_goes_by_no_other_name(name: str) -> None:
    with pytest.raises(ValueError, match="valid are path_1, path_2"):
        replace(function(1), name=name)
