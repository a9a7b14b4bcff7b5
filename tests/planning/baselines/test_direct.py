"""`direct`: one call for plan and points; axes and checks only when asked for."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from tests.desk import draw_desk, read_record
from tests.planning.baselines.runs import Listening, contracts, decided, photo, pictures, requests, run
from wonderful_team.core.pictures import Axes
from wonderful_team.core.protocols import Act
from wonderful_team.planning.baselines.direct import CHECKS


@pytest.mark.parametrize(
    ("method", "asked"),
    [
        ("direct", ["PlanDirectly"]),
        ("direct:axes", ["PlanDirectly"]),
        ("direct:checked", ["PlanDirectly", "ReviewSteps"]),
        ("direct:axes:checked", ["PlanDirectly", "ReviewSteps"]),
    ],
)
def test_one_request_without_a_check_two_with_it(method: str, asked: list[str], tmp_path: Path) -> None:
    trial = run(method, "visual_manipulation", tmp_path)
    assert trial.outcome == "success"
    assert contracts(trial) == asked
    assert {request["role"] for request in requests(trial)} == {"planner"}
    assert trial.usage_by_role["planner"].calls == len(asked)
    assert trial.plans[0].verified == ("checked" in method)
    assert trial.page.is_file()
    setting = read_record(trial.folder)["planner"].get("setting") or trial.setting
    assert setting["loop"] == "open"


@pytest.mark.parametrize("method", ["direct", "direct:axes"])
def test_axes_are_drawn_only_when_asked_for(method: str, tmp_path: Path) -> None:
    model = Listening(wt.make_model("offline"))
    assert isinstance(decided(method, photo(tmp_path), model), Act)
    shown = model.heard[0].pictures[0]
    assert bool(shown.mark(Axes)) == (method == "direct:axes")
    trial = run(method, "visual_manipulation", tmp_path)
    told = [
        part
        for part in requests(trial)[0]["parts"]
        if "words" in part and part["words"].startswith('Picture "top view"')
    ]
    assert ("tick labels" in told[0]["words"]) == (method == "direct:axes")
    assert pictures(requests(trial)[0])


@pytest.mark.parametrize("task", ["rotate", "rearrange", "twist", "follow_order"])
def test_it_can_state_what_the_tasks_of_the_paper_need(task: str, tmp_path: Path) -> None:
    assert run("direct", task, tmp_path).outcome == "success"


class Doubtful:
    """Offline; its first checks doubt the first step."""

    name = "doubtful"

    def __init__(self, doubts: int) -> None:
        self.left, self.model = doubts, wt.make_model("offline")

    def answer(self, request: wt.Request) -> Any:
        if request.contract != "ReviewSteps" or not self.left:
            return self.model.answer(request)
        self.left -= 1
        doubt = {"about": "1", "kind": "wrong_target", "question": "is it not the other one?"}
        return {"reasoning": "", "approved": False, "doubt": doubt}


@pytest.mark.parametrize("doubts", [1, 9])
def test_a_doubt_sends_the_plan_back_at_most_so_often(doubts: int, tmp_path: Path) -> None:
    model = Listening(Doubtful(doubts))
    made = decided("direct:checked", photo(tmp_path), model)
    assert isinstance(made, Act)
    assert made.plan is not None
    kinds = [request.contract for request in model.heard]
    rounds = min(doubts, CHECKS)
    assert kinds.count("PlanDirectly") == 1 + rounds
    assert len(made.plan.questions) == rounds
    assert made.plan.verified == (doubts < CHECKS)
    again = model.heard[2]
    assert any("step 1: is it not the other one?" in getattr(part, "text", "") for part in again.parts)


def test_the_drawn_plan_is_what_is_checked(tmp_path: Path) -> None:
    model = Listening(wt.make_model("offline"))
    decided("direct:checked", photo(tmp_path), model)
    assert any("with the plan" in picture.name for picture in model.heard[1].pictures)


def test_a_cap_on_calls_ends_it_at_stage_budget(tmp_path: Path) -> None:
    trial = run("direct:checked", "visual_manipulation", tmp_path, max_calls=1)
    assert (trial.outcome, trial.stage, trial.usage.calls) == ("failure", "budget", 1)
    assert trial.page.is_file()


def test_it_finds_things_in_photos_in_one_answer(tmp_path: Path) -> None:
    seen = wt.Observation.from_files(draw_desk(tmp_path) / "desk.png")
    policy: Any = wt.Method(method="direct", model="offline").policy()
    circle, square, none = asyncio.run(policy.locate(seen, ["red circle", "blue square", "green star"]))
    assert circle.as_tuple == pytest.approx((54, 124, 106, 176), abs=3)
    assert square.as_tuple == pytest.approx((200, 60, 260, 120), abs=3)
    assert none is None
    assert policy.usage_by_role["planner"].calls == 1
