"""Angles that pictures show, read by the models that need no key: from truth, and from pixels."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.simulated.tables import set_table
from wonderful_team.contracts import ReadTurn, WriteSteps
from wonderful_team.core.actions import PickPlaceStep
from wonderful_team.core.values import Answer, Request
from wonderful_team.images.turned import turn_strip
from wonderful_team.offline.answers.turns import answer_read_turn
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.turns import COARSE_DEG, FINE_DEG, Turning, _pair
from wonderful_team.runtime import rollout
from wonderful_team.sims.tabletop import make_world
from wonderful_team.simulated import PROFILES, SimulatedModel


def question_of(turning: Turning, target: Any, turns: Any) -> ReadTurn:
    strip = turn_strip(turning.thing, turning.goal, turning.reach, turns, "turns")
    return ReadTurn(target, strip, tuple(float(turn) for turn in turns), turning.shows)


@pytest.mark.parametrize("seed", [700, 702, 705])
def test_both_read_the_angle_that_the_examples_show(seed: int) -> None:
    with set_table("twist", seed) as table:
        draft = table.draft()
        targets = [item.to_target() for item in draft.targets]
        subgoals = tuple(item.to_subgoal() for item in draft.subgoals)
        steps = table.ask(WriteSteps(table.scene.task, table.world.vocabulary.step_kinds, subgoals, tuple(targets)))
        right = steps.to_steps()[0].rotate_deg
        turning = _pair(table.scene.instruction)
        assert turning is not None
        for answer in (table.ask, answer_read_turn):
            read = 0.0
            for turns in (COARSE_DEG, FINE_DEG):
                asked = question_of(turning, targets[0], [read + turn for turn in turns])
                read = asked.turns[answer(asked).number - 1]
            assert abs(math.remainder(read - right, 360.0)) <= 5.0


def test_who_knows_the_truth_is_blind_where_the_goal_is_not_shown() -> None:
    with set_table("twist", 700) as table:
        target = table.targets()[0]
        turning = _pair(table.scene.instruction)
        assert turning is not None
        asked = question_of(turning, target, COARSE_DEG)
        assert table.ask(asked).number is not None
        grey = replace(asked, strip=replace(asked.strip, rgb=np.full_like(asked.strip.rgb, 128)))
        assert table.ask(grey).number is None


class Misread:
    """A Supervisor who estimates every angle 50 degrees too small."""

    name = "misread"

    def __init__(self, model: Any) -> None:
        self.model = model

    async def answer(self, request: Request) -> Answer:
        answer: Answer = await self.model.answer(request)
        if request.contract == "DraftPlan":
            goals = [
                goal.model_copy(update={"move": goal.move.model_copy(update={"rotate_deg": goal.move.rotate_deg - 50})})
                for goal in answer.value.subgoals
            ]
            return replace(answer, value=answer.value.model_copy(update={"subgoals": goals}))
        if request.contract != "WriteSteps":
            return answer
        steps = [step.model_copy(update={"rotate_deg": step.rotate_deg - 50}) for step in answer.value.steps]
        return replace(answer, value=answer.value.model_copy(update={"steps": steps}))


@pytest.mark.parametrize(("members", "solved"), [("full", True), ("s1", True), ("s7", False)])
def test_an_angle_that_one_look_misreads_is_put_right_by_the_strip(members: str, solved: bool) -> None:
    """With nobody to look again (s7) the same error costs the task."""
    world = make_world("twist", seed=702)
    try:
        model = SimulatedModel(world.privileged, world.instruction, PROFILES["perfect"])
        team = TeamPolicy({"*": model, "supervisor": Misread(model)}, TeamConfig(mode="lean", ablation=members))
        trial = rollout(team, world, scorer=world.privileged, seed=702, max_age_s=None)
    finally:
        world.close()
    assert (trial.outcome == "success") is solved, trial.reason
    assert all(isinstance(step, PickPlaceStep) for plan in trial.plans for step in plan.steps)
