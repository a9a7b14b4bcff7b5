"""A question that only the user can settle: answered, planning goes on, and every member and Memory knows the answer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import pytest

from tests.planning.helpers import Tape, asked, draft, scripted, subgoal
from tests.planning.rounds import photo
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import Instruction, Plan, Request, Words
from wonderful_team.errors import ConfigError, MethodCodeError
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig, TeamPolicy

QUESTION = {"question": "which red block?", "choices": ["left", "right"]}
UNCLEAR = {**draft(), "clarification": QUESTION}
ANSWER = 'asked "which red block?" (left | right), the user answered: the left one'
MODES = pytest.mark.parametrize("mode", ["lean", "paper"])


def text(request: Request) -> str:
    return "\n".join(part.text for part in request.parts if isinstance(part, Words))


def once_unclear(targets: bool = True) -> Callable[[Request], Any]:
    """Asks until the user's answer is among the words."""

    def drafted(request: Request) -> Any:
        if not request.question.task.said:
            return UNCLEAR
        return draft(subgoal("G1")) if targets else {**draft(subgoal("G1", targets=[])), "targets": []}

    return drafted


def planned(model: ScriptedModel, ask: Any, mode: Any = "lean", tape: Tape | None = None) -> Plan:
    team = TeamPolicy(model, TeamConfig(mode=mode), ask=ask, subscribers=[tape] if tape else ())
    return asyncio.run(team.make_plan(photo(), Instruction("put the red block into the bowl"), PICK_PLACE))


@MODES
def test_planning_goes_on_with_the_answer_and_everyone_who_plans_or_checks_knows_it(mode: str) -> None:
    heard: list[tuple[str, tuple[str, ...]]] = []

    def ask(question: str, choices: tuple[str, ...]) -> str:
        heard.append((question, choices))
        return " the left\none "

    model, tape = scripted(DraftPlan=once_unclear(mode == "lean")), Tape()
    plan = planned(model, ask, mode, tape)
    assert plan.status == "planned"
    assert heard == [("which red block?", ("left", "right"))]
    told = [contract for contract in ("DraftPlan", "ReviewPlan", "WriteSteps", "ReviewSteps") if asked(model, contract)]
    assert {"DraftPlan", "ReviewSteps"} <= set(told)
    for contract in told:
        assert ANSWER in text(asked(model, contract)[-1]), contract
    assert ANSWER in [event.content["text"] for event in tape.kinds("stage")]
    assert [event.content.answer for event in tape.kinds("clarified")] == ["the left one"]


@MODES
def test_memory_hears_question_and_answer(mode: str) -> None:
    model = scripted(DraftPlan=once_unclear(mode == "lean"))
    planned(model, lambda question, choices: "the left one", mode)
    (request,) = asked(model, "Remember")
    assert request.question.role == "user"
    for part in ("which red block?", "left | right", "the left one"):
        assert part in text(request)


def test_a_doubt_that_ends_in_a_question_is_answered_too() -> None:
    doubt = {"about": "G1", "kind": "ambiguity", "question": "which?"}
    reviews = iter([{"reasoning": "", "approved": False, "doubt": doubt}])
    approved = {"reasoning": "", "approved": True, "doubt": None}
    model = scripted(
        DraftPlan=draft(subgoal("G1")),
        ReviewSteps=lambda request: next(reviews, approved),
        RevisePlan={"reasoning": "", "decision": "revise", "answer": "unclear", "plan": UNCLEAR},
    )
    assert planned(model, lambda question, choices: "the left one").status == "planned"


@pytest.mark.parametrize("answer", [None, "", "  \n"])
def test_without_an_answer_it_ends_with_the_question(answer: str | None) -> None:
    plan = planned(scripted(DraftPlan=UNCLEAR), lambda question, choices: answer)
    assert (plan.status, plan.choices) == ("needs_clarification", ("left", "right"))


def test_a_question_that_was_answered_is_not_asked_again() -> None:
    heard = []
    plan = planned(scripted(DraftPlan=UNCLEAR), lambda question, choices: heard.append(question) or "the left one")
    assert plan.status == "needs_clarification"
    assert heard == ["which red block?"]


def test_questions_without_end_are_bounded() -> None:
    numbers = iter(range(100))
    model = scripted(
        DraftPlan=lambda request: {**UNCLEAR, "clarification": {"question": f"{next(numbers)}?", "choices": []}}
    )
    heard = []
    plan = planned(model, lambda question, choices: heard.append(question) or "yes")
    assert plan.status == "needs_clarification"
    assert heard == ["0?", "1?", "2?"]


def test_the_function_may_be_async_and_its_faults_are_named() -> None:
    async def ask(question: str, choices: tuple[str, ...]) -> str:
        return "the left one"

    assert planned(scripted(DraftPlan=once_unclear()), ask).status == "planned"
    with pytest.raises(ConfigError, match=r"ask\(question, choices\) gave a int; valid: the user's words"):
        planned(scripted(DraftPlan=UNCLEAR), lambda question, choices: 1)
    with pytest.raises(MethodCodeError, match=r"ask\(question, choices\)"):
        planned(scripted(DraftPlan=UNCLEAR), lambda question, choices: 1 / 0)


def test_a_long_answer_is_cut_with_a_warning() -> None:
    tape = Tape()
    planned(scripted(DraftPlan=once_unclear()), lambda question, choices: "x" * 5000, tape=tape)
    assert "the answer has 5000 characters; the first 1000 are used" in tape.warnings
