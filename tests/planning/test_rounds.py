"""The waiting chain of both ways of working, in virtual time: what users wait for must not grow unnoticed."""

from __future__ import annotations

import pytest

from tests.planning.rounds import measure
from wonderful_team.planning import ABLATIONS, TeamConfig


def chain(config: TeamConfig) -> list[dict[str, int]]:
    _, watch, _ = measure(config)
    return [dict(kinds) for kinds in watch.rounds()]


def test_paper_waits_eleven_rounds():
    plan, watch, seconds = measure(TeamConfig(mode="paper"))
    assert plan.status == "planned"
    assert round(seconds) == 11
    assert [dict(kinds) for kinds in watch.rounds()] == [
        {"DraftPlan": 1},
        {"ReviewPlan": 1},
        {"ExtractTargets": 1},
        {"LocatePoints": 6},
        {"ChooseMark": 2},
        {"GiveBox": 2},
        {"JudgeBox": 2, "Presence": 2},
        {"ChoosePoint": 2},
        {"ChoosePoint": 2},
        {"WriteSteps": 1},
        {"ReviewSteps": 1},
    ]


def test_lean_waits_four_rounds_for_a_plain_scene():
    plan, watch, seconds = measure(TeamConfig(mode="lean"))
    assert plan.status == "planned"
    assert plan.verified
    assert round(seconds) == 4
    assert [dict(kinds) for kinds in watch.rounds()] == [
        {"DraftPlan": 1},
        {"ReadScene": 1},
        {"JudgeBoxes": 1},
        {"ReviewSteps": 1},
    ]


def test_lean_waits_five_rounds_when_it_asks_everything():
    plan, watch, seconds = measure(TeamConfig(mode="lean", thorough=True))
    assert plan.status == "planned"
    assert round(seconds) == 5
    assert [dict(kinds) for kinds in watch.rounds()] == [
        {"DraftPlan": 1},
        {"ReviewPlan": 1},
        {"ReadScene": 1},
        {"JudgeBox": 2, "WriteSteps": 1},
        {"ReviewSteps": 1},
    ]


GONE = {
    "s1": {"ReviewPlan", "ReviewSteps"},
    "s2": {"JudgeBox", "JudgeBoxes", "JudgeRevision", "Presence"},
    "s3": {"ReviewPlan", "ReviewSteps", "JudgeBox", "JudgeBoxes", "JudgeRevision", "Presence"},
    "s4": {"JudgeBox", "JudgeBoxes", "MoveBox", "Presence"},
    "s5": {"ReviewPlan", "ReviewSteps", "JudgeBox", "JudgeBoxes", "MoveBox", "Presence"},
    "s6": {"ChooseMark", "GiveBox", "JudgeBox", "JudgeBoxes", "MoveBox", "ChoosePoint", "ReadScene", "Presence"},
    "s7": {
        "ReviewPlan",
        "ReviewSteps",
        "ChooseMark",
        "GiveBox",
        "JudgeBox",
        "JudgeBoxes",
        "MoveBox",
        "ChoosePoint",
        "ReadScene",
    },
    "s8": {"Remember"},
}
ROLES_GONE = {
    "s1": {"verification"},
    "s2": {"checker"},
    "s3": {"verification", "checker"},
    "s4": {"checker", "mover"},
    "s5": {"verification", "checker", "mover"},
    "s6": {"manager", "checker", "mover"},
    "s7": {"verification", "manager", "checker", "mover"},
    "s8": {"memory"},
}


@pytest.mark.parametrize("ablation", sorted(set(ABLATIONS) - {"full"}))
@pytest.mark.parametrize("mode", ["paper", "lean"])
def test_a_switched_off_member_sends_nothing(ablation, mode):
    plan, watch, _ = measure(TeamConfig(mode=mode, ablation=ablation))
    requests = [request for _, request in watch.sent]
    assert plan.status == "planned"
    assert not GONE[ablation] & {request.contract for request in requests}
    assert not ROLES_GONE[ablation] & {request.role for request in requests}


def test_with_the_checker_off_the_mover_may_stop():
    _, watch, _ = measure(TeamConfig(mode="paper", ablation="s2"))
    moves = [request.question for _, request in watch.sent if request.contract == "MoveBox"]
    assert moves
    assert all(question.may_stop for question in moves)


def test_with_grounding_off_the_supervisor_points():
    _, watch, _ = measure(TeamConfig(mode="lean", ablation="s6"))
    pointing = [request for _, request in watch.sent if request.contract == "LocatePoints"]
    assert {request.role for request in pointing} == {"supervisor"}
    assert len(pointing) == 2
