"""After a failed action an arm with an empty hand goes home, so that the next plan is made from a picture of the whole scene."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from tests.runtime.runtime_fakes import SquaresWorld, make_plan
from wonderful_team.core.actions import ARM, Action, At, CloseStep, Gripper, MoveStep, MoveTo, OpenStep, Vocabulary
from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Act, Done, GaveUp, Situation
from wonderful_team.core.values import Observation, PlannedAction, RobotState, StepReport, Trial
from wonderful_team.runtime import rollout


@dataclass
class FailingArm(SquaresWorld):
    """An arm of which the first action fails."""

    vocabulary: Vocabulary = ARM
    holding: bool = False
    stopped_by: str = ""
    done: list[Action] = field(default_factory=list)

    def observe(self) -> Observation:
        seen = super().observe()
        return replace(seen, robot=RobotState(np.array([0.5, 0.0, 0.2]), 1.0, self.holding))

    def execute(self, action: Action) -> StepReport:  # type: ignore[override]
        self.done.append(action)
        first = len(self.done) == 1
        told = {"holding": self.holding} | ({"stopped_by": self.stopped_by} if first and self.stopped_by else {})
        return StepReport(action, not first, told, "it slipped" if first else None)


@dataclass
class Opens:
    """Opens the gripper, and is done when it is asked again."""

    name: str = "opens"
    seen: list[Situation] = field(default_factory=list)

    def decide(self, situation: Situation) -> Act | Done | GaveUp:
        self.seen.append(situation)
        open_ = PlannedAction(OpenStep("G1"), Gripper("open"))
        return Act((open_,)) if len(self.seen) == 1 else Done("as good as it gets")


class Given:
    """Runs the plan that it is given, and is done when it is asked again."""

    name = "given"

    def decide(self, situation: Situation) -> Act | Done | GaveUp:
        plan = situation.plan
        return Done("as good as it gets") if plan is None else Act(plan.actions, plan)


def ran(world: FailingArm, replans: int) -> tuple[Trial, Opens]:
    policy = Opens()
    return rollout(policy, world, replans=replans), policy


def test_it_goes_home_where_it_is_asked_again() -> None:
    world = FailingArm()
    trial, policy = ran(world, replans=1)
    assert [action.kind for action in world.done] == ["gripper", "home"]
    (told,) = policy.seen[1].executed
    assert [report.executed for report in told.reports] == [False, True]
    assert any(not report.executed and report.fault == "it slipped" for report in trial.reports)


@pytest.mark.parametrize(("replans", "holding"), [(0, False), (1, True)], ids=["nobody asks again", "it holds a thing"])
def test_it_stays_otherwise(replans: int, holding: bool) -> None:
    world = FailingArm(holding=holding)
    ran(world, replans)
    assert [action.kind for action in world.done] == ["gripper"]


@pytest.mark.parametrize(
    ("stopped_by", "then"),
    [("contact", ["gripper", "home"]), ("collision", [])],
    ids=["it lies on something", "something hit it"],
)
def test_what_came_to_lie_on_something_is_let_go_of_and_nothing_else(stopped_by: str, then: list[str]) -> None:
    world = FailingArm(holding=True, stopped_by=stopped_by)
    ran(world, replans=1)
    assert [action.kind for action in world.done] == ["gripper", *then]


@dataclass
class JammedArm(SquaresWorld):
    """An arm that grips a thing and then lifts it so far, where something presses on it."""

    vocabulary: Vocabulary = ARM
    lifted_m: float = 0.0
    done: list[Action] = field(default_factory=list)

    def observe(self) -> Observation:
        seen = super().observe()
        return replace(seen, robot=RobotState(np.array([0.5, 0.0, 0.1]), 0.2, self._holding))

    @property
    def _holding(self) -> bool:
        return bool(self.done) and not (isinstance(self.done[-1], Gripper) and self.done[-1].state == "open")

    def execute(self, action: Action) -> StepReport:  # type: ignore[override]
        self.done.append(action)
        rises = isinstance(action, MoveTo)
        told = {"holding": self._holding, "tool_m": (0.5, 0.0, 0.1 + (self.lifted_m if rises else 0.0))}
        told |= {"stopped_by": "collision"} if rises else {}
        return StepReport(action, not rises, told, "something pressed on the arm" if rises else None)


class Lifts(Opens):
    """Grips and lifts, and is done when it is asked again."""

    def decide(self, situation: Situation) -> Act | Done | GaveUp:
        self.seen.append(situation)
        over = Pose.at((0.5, 0.0, 0.2))
        close = PlannedAction(CloseStep("G1"), Gripper("close"))
        rise = PlannedAction(MoveStep("G1", At("T1"), "above"), MoveTo(over))
        return Act((close, rise)) if len(self.seen) == 1 else Done("as good as it gets")


@pytest.mark.parametrize(("lifted_m", "then"), [(0.002, ["gripper", "home"]), (0.03, [])], ids=["jammed", "lifted"])
def test_what_could_not_be_lifted_is_let_go_of_where_it_stands(lifted_m: float, then: list[str]) -> None:
    world = JammedArm(lifted_m=lifted_m)
    trial = rollout(Lifts(), world, replans=1)
    assert trial.gates[0].admitted, trial.gates[0].reasons
    assert [action.kind for action in world.done] == ["gripper", "move_to", *then]


def test_of_a_plan_that_was_read_exactly_its_actions_run() -> None:
    world = FailingArm()
    seen = world.observe()
    open_ = PlannedAction(OpenStep("G1"), Gripper("open"))
    plan = replace(make_plan(seen, []), steps=(open_.step,), actions=(open_,))
    trial = rollout(Given(), world, plan=plan, plan_observation=seen, replans=1)
    assert trial.gates[0].admitted, trial.gates[0].reasons
    assert [action.kind for action in world.done] == ["gripper"]
