"""A star whose first stroke fails is drawn at the second plan, by the function of the first one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from tests.desk import read_record
from tests.sims.arms.needed import needs_arms
from wonderful_team.api.replay import replay
from wonderful_team.core.actions import Action
from wonderful_team.record import read_plan


class Stuck:
    """An arm that does not start the first time."""

    def __init__(self, inner: Any) -> None:
        self.inner, self.tries = inner, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def execute(self, action: Action) -> Any:
        self.tries += 1
        if self.tries == 1:
            return wt.StepReport(action, False, {}, "the arm did not start")
        return self.inner.execute(action)


@needs_arms
def test_a_replan_calls_the_function_that_was_accepted_for_the_failed_plan(tmp_path: Path) -> None:
    inner = wt.make_world("arms/star", seed=3)
    try:
        trial = wt.rollout(wt.Team(model="simulated:perfect", out=tmp_path), Stuck(inner), replans=1)
    finally:
        inner.close()
    assert trial.outcome == "success", trial.reason
    assert [[one.name for one in plan.functions] for plan in trial.plans] == [["path_1"], ["path_1"]]
    assert trial.folder is not None
    requests = read_record(trial.folder)["planner"]["requests"]
    first, second = (one["answer"]["parsed"]["code"] for one in requests if one["contract"] == "WriteFunction")
    assert "path_1" not in first
    assert second == "def path(boxes):\n    return path_1({'T1': boxes['T1']})\n"
    assert sum(one["contract"] == "ReviewPath" for one in requests) == 2
    told = [part.get("words", "") for one in requests if one["contract"] == "DraftPlan" for part in one["parts"]]
    assert any("path_1: the 11 points of the path on the" in words for words in told)
    found = replay(trial.folder)
    assert found.same
    assert found.now == tuple(plan.id for plan in trial.plans)


@needs_arms
@pytest.mark.slow
def test_a_run_of_a_plan_file_calls_the_function_that_came_with_the_plan(tmp_path: Path) -> None:
    def ran(wrap: Any, **options: Any) -> wt.TrialResult:
        inner = wt.make_world("arms/star", seed=3)
        try:
            return wt.rollout(wt.Team(model="simulated:perfect", out=tmp_path), wrap(inner), **options)
        finally:
            inner.close()

    made = ran(lambda inner: inner, replans=0)
    assert made.folder is not None
    trial = ran(Stuck, replans=1, plan=read_plan(made.folder))
    assert trial.outcome == "success", trial.reason
    assert trial.folder is not None
    requests = read_record(trial.folder)["planner"]["requests"]
    (code,) = (one["answer"]["parsed"]["code"] for one in requests if one["contract"] == "WriteFunction")
    assert "path_1(" in code
    assert replay(trial.folder).same
