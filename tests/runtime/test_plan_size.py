"""A plan has a limit on its parts, whoever made it: a model, a method, a file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from tests.planning.helpers import plan_with
from tests.planning.stub_model import stub_script
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import MAX_ACTIONS, Observation, Plan, PlannedAction, Subgoal, View
from wonderful_team.errors import ConfigError
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.record.plan_file import plan_from_json, plan_to_json
from wonderful_team.runtime import check_gate

MANY = 10_000


def moved() -> PlannedAction:
    step = wt.PickPlaceStep("G1", pick="T1", place=wt.At("T2"))
    return PlannedAction(step, wt.PickPlace(np.array([0.5, 0.2, 0.0]), np.array([0.5, -0.2, 0.0])))


def seen() -> Observation:
    return Observation({"top": View("top", "top", 0.0, np.full((64, 128, 3), 90, np.uint8))})


class Desk:
    vocabulary = PICK_PLACE
    limits = wt.Limits((0.25, -0.5, -0.01), (0.75, 0.5, 0.5))
    instruction = wt.Instruction("move it")

    def __init__(self) -> None:
        self.ran = 0

    def observe(self) -> Observation:
        return seen()

    def execute(self, action: wt.Action) -> wt.StepReport:
        self.ran += 1
        return wt.StepReport(action, executed=True)

    def stop(self) -> None: ...

    def close(self) -> None: ...


@pytest.mark.parametrize(
    ("contract", "part", "says"),
    [
        ("DraftPlan", "subgoals", "10000 subgoals, at most 100 are allowed"),
        ("ExtractTargets", "targets", "10000 targets, at most 100 are allowed"),
        ("WriteSteps", "steps", f"10000 actions, at most {MAX_ACTIONS} are allowed"),
    ],
)
def test_a_model_that_writes_too_much_is_told_number_and_limit(contract: str, part: str, says: str) -> None:
    script = stub_script()
    usual = script[contract]

    def too_much(request):
        answer = usual(request)
        return {**answer, part: answer[part][:1] * MANY}

    plan = plan_with(ScriptedModel({**script, contract: too_much}))
    assert plan.status == "failed"
    assert says in plan.message


def test_a_method_with_too_many_actions_moves_nothing() -> None:
    class Many:
        name = "many"

        def decide(self, situation):
            return wt.Act((moved(),) * MANY)

    world = Desk()
    trial = wt.rollout(Many(), world)
    assert (trial.outcome, trial.stage, world.ran) == ("failure", "method", 0)
    assert f"10000 actions, at most {MAX_ACTIONS} are allowed" in trial.reason


def test_a_plan_file_with_too_many_parts_is_not_read(tmp_path: Path) -> None:
    plan = Plan(wt.Instruction("move it"), "planned", subgoals=(Subgoal("G1", "move"),), actions=(moved(),))
    held = plan_to_json(replace(plan, subgoals=plan.subgoals * 101))
    with pytest.raises(ConfigError, match="the plan has 101 subgoals, at most 100 are allowed"):
        plan_from_json(json.loads(json.dumps(held)))
    held = plan_to_json(replace(plan, actions=plan.actions * (MAX_ACTIONS + 1)))
    with pytest.raises(ConfigError, match=f"the plan has {MAX_ACTIONS + 1} actions, at most {MAX_ACTIONS}"):
        plan_from_json(json.loads(json.dumps(held)))


def test_the_gate_refuses_before_it_looks_at_any_of_them() -> None:
    actions = (moved(),) * (MAX_ACTIONS + 1)
    report = check_gate(actions, vocabulary=PICK_PLACE, limits=Desk.limits, plan=None, then=None, now=seen())
    assert not report.admitted
    assert [check.name for check in report.checks] == ["size of plan"]
    assert f"{MAX_ACTIONS + 1} actions, at most {MAX_ACTIONS}" in report.reasons[0]
