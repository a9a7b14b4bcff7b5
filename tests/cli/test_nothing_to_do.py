"""A model's word that there is nothing to do is told as its word."""

from __future__ import annotations

from tests.models.providers.asking import small_scene
from wonderful_team.api.results import PlanResult
from wonderful_team.cli.wording import plan_exit_code, plan_lines
from wonderful_team.core.values import Instruction, Observation, Plan, Subgoal


def made(*subgoals: Subgoal) -> PlanResult:
    view = small_scene()
    message = "" if subgoals else "nothing to do: the instruction is already fulfilled"
    plan = Plan(instruction=Instruction("put the cube there"), subgoals=subgoals, status="planned", message=message)
    return PlanResult(plan, Observation({"top": view}))


def test_that_nothing_is_to_be_done_is_the_models_word() -> None:
    lines = plan_lines(made())
    assert lines[0] == "nothing to do: the instruction is already fulfilled"
    assert any("the model's word" in line for line in lines)
    assert plan_exit_code(made()) == 0
    assert not any("the model's word" in line for line in plan_lines(made(Subgoal("G1", "the cube lies there"))))
