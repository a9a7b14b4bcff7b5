"""Looks: the first actions of a plan run, then the method is asked again; bounded, and never with a plan that was read."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from tests.runtime.runtime_fakes import Listener, SquaresTruth, SquaresWorld, make_plan
from wonderful_team.core.protocols import Act, Done, Situation
from wonderful_team.errors import ConfigError
from wonderful_team.runtime import Approval, rollout

RED, BLUE = (60.0, 60.0), (160.0, 90.0)
UP, MIDDLE = (200.0, 30.0), (120.0, 60.0)


@dataclass
class Looker:
    """One move at a time; asks for a look after each, until its moves run out."""

    moves: list
    always: bool = False
    name: str = "looker"
    asked: list[Situation] = field(default_factory=list)

    def decide(self, situation):
        self.asked.append(situation)
        if not self.moves:
            return Done("looks right")
        plan = make_plan(situation.observation, [self.moves.pop(0)])
        return Act(plan.actions, plan, reobserve=self.always or situation.reobserve_left > 0)


def test_a_look_is_a_new_picture_and_no_replan():
    world, listener = SquaresWorld(), Listener()
    policy = Looker([(RED, MIDDLE), (MIDDLE, UP)])
    trial = rollout(policy, world, reobserve=5, scorer=SquaresTruth(world, {"red": UP}), subscribers=[listener])
    assert trial.outcome == "success"
    assert [situation.attempt for situation in policy.asked] == [0, 0, 0]
    assert [situation.replans_left for situation in policy.asked] == [0, 0, 0]
    assert [situation.reobserve_left for situation in policy.asked] == [5, 4, 3]
    assert [len(situation.executed) for situation in policy.asked] == [0, 1, 1]
    assert len({situation.observation.hash for situation in policy.asked}) == 3
    assert [event.name for event in listener.events if event.kind == "observe" and event.name == "look"]
    assert len(trial.plans) == 2


def test_looks_are_bounded():
    policy = Looker([(RED, MIDDLE), (MIDDLE, RED)] * 10, always=True)
    trial = rollout(policy, SquaresWorld(), reobserve=3)
    assert len(policy.asked) == 4
    assert len(trial.runs) == 4
    assert "ran out" in trial.reason


def test_without_looks_an_act_is_the_whole_attempt():
    policy = Looker([(RED, MIDDLE), (MIDDLE, UP)], always=True)
    assert len(rollout(policy, SquaresWorld()).runs) == 1
    policy = Looker([(RED, MIDDLE), (MIDDLE, UP)], always=True)
    assert len(rollout(policy, SquaresWorld(), replans=1).runs) == 2
    # Asked once more, for its judgement of what ran last.
    assert [(situation.attempt, situation.replans_left) for situation in policy.asked] == [(0, 1), (1, 1), (2, 0)]


def test_what_did_not_run_is_no_look():
    policy = Looker([((20.0, 20.0), UP), (RED, UP)])
    trial = rollout(policy, SquaresWorld(), reobserve=5)
    assert len(policy.asked) == 1
    assert "did not run" in trial.reason


def test_a_plan_that_was_read_or_approved_runs_as_it_is():
    world = SquaresWorld()
    seen = world.observe()
    plan = make_plan(seen, [(RED, UP)])
    with pytest.raises(ConfigError, match="reobserve must be 0"):
        rollout(Looker([]), world, plan=plan, plan_observation=seen, reobserve=2)
    with pytest.raises(ConfigError, match="reobserve must be 0"):
        rollout(Looker([]), world, approval=Approval(plan.id, "a person"), reobserve=2)
    with pytest.raises(ConfigError, match="reobserve must be 0 or more"):
        rollout(Looker([]), world, reobserve=-1)
    assert world.ran == 0
