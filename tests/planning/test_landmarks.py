"""A thing that others are only placed beside: its outline is looked for, and no point on it is asked for or judged."""

from __future__ import annotations

from typing import Any

import pytest

from tests.planning.helpers import asked, draft, plan_with, scripted, subgoal
from wonderful_team.core.actions import ARM
from wonderful_team.core.values import Request, Words
from wonderful_team.planning import TeamConfig

BESIDE = {"pick": "T1", "place": {"target": "T2", "how": "beside", "side": "left"}, "rotate_deg": 0}
AT = {"pick": "T1", "place": {"target": "T2", "how": "at", "side": None}, "rotate_deg": 0}


def text(request: Request) -> str:
    return "\n".join(part.text for part in request.parts if isinstance(part, Words))


def drafted(*moves: Any) -> dict[str, Any]:
    plan = draft(*(subgoal(f"G{number}", move=move) for number, move in enumerate(moves, start=1)))
    plan["targets"][1]["use"] = []
    return plan


def test_no_point_of_it_is_asked_for_or_judged() -> None:
    model = scripted(DraftPlan=drafted(BESIDE))
    plan = plan_with(model, TeamConfig())
    assert plan.status == "planned", plan.message
    (reading,) = asked(model, "ReadScene")
    assert [target.roles for target in reading.question.targets] == [("pick",), ()]
    assert "T2 (object): the second thing; no points: only its outline is needed" in text(reading)
    assert plan.grounded["T2"].points == {}
    assert plan.grounded["T2"].box is not None
    (judged,) = asked(model, "JudgeBoxes")
    assert "Points drawn, by their use: none; only the outline is needed." in text(judged)


@pytest.mark.parametrize("moves", [(AT,), (BESIDE, AT), (None,), (BESIDE, None), ({**BESIDE, "pick": "T2"},)])
def test_a_thing_that_may_have_another_use_keeps_its_point(moves: tuple[Any, ...]) -> None:
    model = scripted(DraftPlan=drafted(*moves))
    plan_with(model, TeamConfig())
    assert asked(model, "ReadScene")[0].question.targets[1].roles == ("pick",)


def test_without_a_grounding_team_a_point_has_to_do() -> None:
    model = scripted(DraftPlan=drafted(BESIDE))
    plan_with(model, TeamConfig(ablation="s7"))
    assert all(request.question.target.roles == ("pick",) for request in asked(model, "LocatePoints"))
    assert len(asked(model, "LocatePoints")) == 2


@pytest.mark.parametrize(("use", "roles"), [([], ()), (["grasp"], ("grasp",))])
def test_what_a_path_is_led_over_needs_no_point_of_its_own(use: list[str], roles: tuple[str, ...]) -> None:
    plan = draft(subgoal("G1", "a star is drawn on the paper", targets=["T1"], function="a star on the paper"))
    plan["targets"] = [{**plan["targets"][0], "use": use}]
    model = scripted(DraftPlan=plan)
    plan_with(model, TeamConfig(), vocabulary=ARM)
    (reading,) = asked(model, "ReadScene")
    assert reading.question.targets[0].roles == roles
    assert ("no points: only its outline is needed" in text(reading)) == (not roles)
