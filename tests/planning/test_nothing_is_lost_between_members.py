"""Each member is told what the paper's prompts tell it: instruction, criticism, doubts and replies."""

from __future__ import annotations

from typing import Any

from tests.agents.test_agent_requests import shown
from tests.planning.helpers import APPROVED, asked, doubt, plan_with, scripted
from tests.planning.stub_model import stub_script
from wonderful_team.planning import TeamConfig

WANTED = "put the first thing into the second thing"


def test_the_manager_is_told_the_instruction_in_every_question_with_a_plan() -> None:
    lean, paper = scripted(), scripted()
    plan_with(lean, TeamConfig(mode="lean"))
    plan_with(paper, TeamConfig(mode="paper"))
    for model, contracts in ((lean, ["ReadScene"]), (paper, ["LocatePoints", "ChooseMark", "GiveBox", "ChoosePoint"])):
        for contract in contracts:
            requests = asked(model, contract)
            assert requests
            assert all(f"<instruction>\n{WANTED}\n</instruction>" in shown(request) for request in requests), contract


def test_the_mover_is_told_what_the_checker_said_last() -> None:
    said = iter(
        [
            {"reasoning": "", "decision": "take_after_go_on", "problem": "the right edge still cuts the rim"},
            {"reasoning": "", "decision": "keep_before", "problem": "the left edge went too far"},
        ]
    )

    def revise(_: Any) -> dict[str, Any]:
        return next(said, {"reasoning": "", "decision": "take_after_stop", "problem": ""})

    model = scripted(
        JudgeBox={"reasoning": "", "decision": "revise", "problem": "it stands too far left"}, JudgeRevision=revise
    )
    plan_with(model)
    first = [request for request in asked(model, "MoveBox") if "/T1/" in request.id]
    problems = [request.question.problem for request in first]
    assert problems[:1] == ["it stands too far left"]
    told = [request.question.problem for request in asked(model, "MoveBox")]
    assert "the right edge still cuts the rim" in told
    assert "the left edge went too far" in told


def test_memory_is_told_reasons_doubts_and_replies() -> None:
    reviews = iter([doubt("G1", "is it free?"), APPROVED])

    def drafted(request: Any) -> Any:
        return {**stub_script()["DraftPlan"](request), "reasoning": "The first thing is the red one."}

    model = scripted(
        DraftPlan=drafted,
        ReviewPlan=lambda _: next(reviews),
        RevisePlan={"reasoning": "Nothing lies in it.", "decision": "keep", "answer": "It is empty.", "plan": None},
    )
    plan_with(model)
    kept = asked(model, "Remember")[0].question
    assert "is it free?" in kept.asked
    assert "G1" in kept.asked
    assert kept.answered == "Kept as it was. It is empty. Because: Nothing lies in it."
