"""After a subgoal a method may be asked whether to go on: in closed loop alone, with what the pictures show that its plan does not expect."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from tests.runtime.runtime_fakes import Listener, MovesPolicy, SquaresWorld, make_plan, planned
from wonderful_team.core.actions import (
    ARM,
    Action,
    At,
    CloseStep,
    Gripper,
    Home,
    HomeStep,
    OpenStep,
    PickPlaceStep,
    Vocabulary,
)
from wonderful_team.core.protocols import Act, Checked, Done, GaveUp, Situation
from wonderful_team.core.values import Observation, PlannedAction, RobotState, StepReport, SubgoalRun, Verdict
from wonderful_team.runtime import rollout
from wonderful_team.runtime.expected import Expectations

RED, BLUE = (60.0, 60.0), (160.0, 90.0)
UP, DOWN, FAR = (200.0, 30.0), (60.0, 100.0), (220.0, 100.0)
TWO = [(RED, UP), (BLUE, DOWN)]


@dataclass
class Checker(MovesPolicy):
    """Plans moves; stops where it is told that something is not as expected, or always."""

    always: bool = False
    checks_subgoals: bool = True
    checked: list[Situation] = field(default_factory=list)

    def check(self, situation: Situation) -> Checked:
        self.checked.append(situation)
        name = situation.executed[-1].subgoal
        if self.always or situation.doubts:
            return Checked((Verdict(name, "not_done", "seen"),), "; ".join(situation.doubts) or "as told")
        return Checked((Verdict(name, "done"),))


def first_look_after_an_action() -> int:
    """Which look at the world is the first one after its first action."""
    world = SquaresWorld()
    looks: list[int] = []
    execute = world.execute

    def noted(action):  # type: ignore[no-untyped-def]
        looks.append(world.reobserve + 1)
        return execute(action)

    world.execute = noted  # type: ignore[method-assign]
    rollout(MovesPolicy([list(TWO)]), world)
    return looks[0]


def test_every_subgoal_but_the_last_is_checked_in_closed_loop() -> None:
    policy, listener = Checker([list(TWO)]), Listener()
    trial = rollout(policy, SquaresWorld(), replans=2, subscribers=[listener])
    (situation,) = policy.checked
    assert [run.subgoal for run in situation.executed] == ["G1"]
    assert situation.observation.hash == situation.executed[-1].after.hash
    assert (situation.attempt, situation.replans_left, situation.doubts) == (0, 2, ())
    assert [run.subgoal for run in trial.runs] == ["G1", "G2"]
    assert trial.verdicts == (Verdict("G1", "done"),)
    assert [event.name for event in listener.events if event.kind == "verdicts"] == ["check"]  # type: ignore[attr-defined]


def test_open_loop_a_last_attempt_and_a_plan_that_was_read_are_not_checked() -> None:
    policy = Checker([list(TWO)], always=True)
    rollout(policy, SquaresWorld())
    assert policy.checked == []
    world = SquaresWorld()
    seen = world.observe()
    rollout(policy, world, plan=make_plan(seen, TWO), plan_observation=seen, replans=1)
    assert policy.checked == []
    # Of two plans only the first may still be followed by another one.
    policy = Checker([list(TWO), [(UP, RED), (BLUE, DOWN)]], always=True)
    trial = rollout(policy, SquaresWorld(), replans=1)
    assert len(policy.checked) == 1
    assert [run.subgoal for run in trial.runs] == ["G1", "G1", "G2"]


def test_a_method_that_has_no_check_or_wants_none_runs_as_before() -> None:
    told = []
    for policy in (MovesPolicy([list(TWO)]), Checker([list(TWO)], always=True, checks_subgoals=False)):
        listener = Listener()
        trial = rollout(policy, SquaresWorld(), replans=1, subscribers=[listener])
        told.append([(event.kind, event.name) for event in listener.events])  # type: ignore[attr-defined]
        assert [run.subgoal for run in trial.runs] == ["G1", "G2"]
    assert told[0] == told[1]


def test_a_stop_ends_the_plan_there_and_is_a_replan() -> None:
    policy = Checker([list(TWO), [(BLUE, DOWN)]], always=True)
    trial = rollout(policy, SquaresWorld(), replans=2)
    assert [run.subgoal for run in trial.runs] == ["G1", "G1"]
    after = policy.asked[1]
    assert (after.attempt, after.replans_left) == (1, 2)
    assert [run.subgoal for run in after.executed] == ["G1"]
    assert policy.asked[2].replans_left == 1


@pytest.mark.parametrize(
    ("nudge", "says"),
    [
        (("blue", 40.0), "T3 (square): the picture there has changed"),
        (("red", -60.0), "where T1 (square) was to be put"),
    ],
    ids=["what a later subgoal uses", "what was just put"],
)
def test_what_the_plan_does_not_expect_is_told(nudge: tuple[str, float], says: str) -> None:
    world = SquaresWorld(nudge={first_look_after_an_action(): nudge})
    policy = Checker([list(TWO)])
    trial = rollout(policy, world, replans=1)
    assert any(doubt.startswith(says) for doubt in policy.checked[0].doubts), policy.checked[0].doubts
    assert [run.subgoal for run in trial.runs] == ["G1"]


def test_what_an_earlier_subgoal_put_is_watched_too() -> None:
    world = SquaresWorld(squares={"red": RED, "blue": BLUE, "green": (110.0, 40.0)})
    moves = [*TWO, ((110.0, 40.0), FAR)]
    looks: list[int] = []
    execute = world.execute

    def noted(action):  # type: ignore[no-untyped-def]
        looks.append(world.reobserve + 1)
        if len(looks) == 2:
            world.nudge[world.reobserve + 1] = ("red", -50.0)
        return execute(action)

    world.execute = noted  # type: ignore[method-assign]
    policy = Checker([moves])
    rollout(policy, world, replans=1)
    first, second = policy.checked
    assert first.doubts == ()
    assert any(doubt.startswith("where T1 (square) was to be put") for doubt in second.doubts), second.doubts


def test_a_thing_that_stayed_where_it_was_is_told() -> None:
    world = SquaresWorld()
    world.execute = lambda action: StepReport(action, True, {"held": True})  # type: ignore[method-assign]
    policy = Checker([list(TWO)])
    rollout(policy, world, replans=1)
    assert [doubt.split(":")[0] for doubt in policy.checked[0].doubts] == [
        "T1 (square)",
        "where T1 (square) was to be put",
    ]


def test_a_check_of_somebody_elses_method_that_returns_something_else_is_its_failure() -> None:
    policy = Checker([list(TWO)])
    policy.check = lambda situation: "fine"  # type: ignore[method-assign,assignment,return-value]
    trial = rollout(policy, SquaresWorld(), replans=1)
    assert trial.outcome == "failure"
    assert "check() of method 'moves'" in trial.reason


class Judging(Checker):
    """Says what became of every subgoal once the whole attempt has run."""

    def decide(self, situation: Situation) -> Act | Done | GaveUp:
        decision = super().decide(situation)
        judged = (Verdict("G1", "undone", "moved since"), Verdict("G2", "done"))
        return replace(decision, verdicts=judged) if isinstance(decision, Done) else decision


def test_a_judgement_of_the_whole_attempt_takes_the_place_of_what_was_said_on_the_way() -> None:
    trial = rollout(Judging([list(TWO)]), SquaresWorld(), replans=1)
    assert [(verdict.subgoal, verdict.status) for verdict in trial.verdicts] == [("G1", "undone"), ("G2", "done")]


def test_what_was_said_of_a_stopped_attempt_stays_beside_the_judgement_of_the_next() -> None:
    policy = Judging([list(TWO), list(TWO)], always=True)
    trial = rollout(policy, SquaresWorld(), replans=1)
    said = [(verdict.subgoal, verdict.status) for verdict in trial.verdicts]
    assert said == [("G1", "not_done"), ("G1", "undone"), ("G2", "done")]


@dataclass
class Arm(SquaresWorld):
    """An arm that reports whether it holds something."""

    vocabulary: Vocabulary = ARM
    holding: bool = False
    done: list[Action] = field(default_factory=list)

    def observe(self) -> Observation:
        return replace(super().observe(), robot=RobotState(np.array([0.5, 0.0, 0.2]), 1.0, self.holding))

    def execute(self, action: Action) -> StepReport:  # type: ignore[override]
        self.done.append(action)
        return StepReport(action, True, {})


@dataclass
class Gripping:
    """Two subgoals, the first of which ends with the arm in the picture, or at home; stops after it."""

    home: bool = False
    name: str = "gripping"
    checks_subgoals: bool = True
    asked: int = 0

    def decide(self, situation: Situation) -> Act | Done:
        self.asked += 1
        if self.asked > 1:
            return Done("as good as it gets")
        first = [PlannedAction(OpenStep("G1"), Gripper("open"))]
        first += [PlannedAction(HomeStep("G1"), Home())] if self.home else []
        return Act((*first, PlannedAction(CloseStep("G2"), Gripper("close"))))

    def check(self, situation: Situation) -> Checked:
        return Checked((), "stop here")


@pytest.mark.parametrize(
    ("home", "holding", "ran"),
    [(False, False, ["gripper", "home"]), (True, False, ["gripper", "home"]), (False, True, ["gripper"])],
    ids=["empty hand goes home", "it is there", "what is held is kept"],
)
def test_a_stopped_arm_leaves_the_picture_with_an_empty_hand(home: bool, holding: bool, ran: list[str]) -> None:
    world = Arm(holding=holding)
    trial = rollout(Gripping(home), world, replans=1)
    assert [action.kind for action in world.done] == ran
    assert {run.subgoal for run in trial.runs} == {"G1"}
    assert sum(len(run.reports) for run in trial.runs) == len(ran)


def test_a_thing_that_is_carried_twice_is_taken_from_where_it_was_put() -> None:
    world = SquaresWorld()
    start = world.observe()
    first, second = planned(1, RED, UP), planned(2, UP, DOWN)
    second = replace(
        second,
        step=PickPlaceStep("G2", "T1", At("T4")),
        sources=(replace(second.sources[0], target="T1"), second.sources[1]),
    )
    third = planned(3, BLUE, FAR)
    plan = make_plan(start, [(RED, UP), (UP, DOWN), (BLUE, FAR)])
    expected = Expectations((first, second, third), plan, start, False)
    before, later = start, [first, second, third]
    for planned_action in (first, second):
        later = later[1:]
        assert planned_action.action is not None
        report = world.execute(planned_action.action)  # type: ignore[arg-type]
        run = SubgoalRun(planned_action.step.subgoal, before, world.observe(), (report,))
        assert expected.doubts(run, later, False) == ()
        before = run.after
