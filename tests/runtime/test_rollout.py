"""The rollout: what runs, what stops it, and how every ending is counted."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import pytest

from tests.runtime.runtime_fakes import Listener, MovesPolicy, SquaresTruth, SquaresWorld, make_plan
from wonderful_team.core.protocols import Act, Done, GaveUp, Score
from wonderful_team.core.values import GateReport, Usage
from wonderful_team.errors import (
    BudgetReached,
    ConfigError,
    ModelUnavailableError,
    NotFoundError,
    RobotFaultError,
    SafetyStopError,
)
from wonderful_team.runtime import Proposal, rollout

RED, BLUE = (60.0, 60.0), (160.0, 90.0)
UP, MIDDLE = (200.0, 30.0), (120.0, 60.0)


def goal(world):
    return SquaresTruth(world, {"red": UP})


class Raises:
    name = "raises"

    def __init__(self, error):
        self.error = error

    def decide(self, situation):
        raise self.error


def test_a_plan_runs_and_is_scored_after_the_trial():
    world, listener = SquaresWorld(), Listener()
    trial = rollout(MovesPolicy([[(RED, UP), (BLUE, RED)]]), world, scorer=goal(world), subscribers=[listener], seed=3)
    assert (trial.outcome, trial.stage, trial.seed, trial.method) == ("success", None, 3, "moves")
    assert [run.subgoal for run in trial.runs] == ["G1", "G2"]
    first = trial.runs[0]
    assert first.before.hash != first.after.hash
    assert first.after.hash == trial.runs[1].before.hash
    kinds = [event.kind for event in listener.events]
    assert kinds == [
        "run", "observe", "asking", "decision", "plan", "gate", "observe", "execute", "observe", "subgoal",
        "gate", "execute", "observe", "subgoal", "done",
    ]  # fmt: skip


def test_without_a_scorer_it_is_unscored():
    assert rollout(MovesPolicy([[(RED, UP)]]), SquaresWorld()).outcome == "unscored"


def test_a_scorer_that_cannot_judge_leaves_it_unscored():
    class Blind(SquaresTruth):
        def score(self):
            return Score(None, None, "occluded")

    world = SquaresWorld()
    trial = rollout(MovesPolicy([[(RED, UP)]]), world, scorer=Blind(world, {}))
    assert (trial.outcome, trial.reason) == ("unscored", "occluded")


def test_replans_are_asked_for_with_what_was_executed():
    world = SquaresWorld()
    policy = MovesPolicy([[(RED, MIDDLE)], [(MIDDLE, UP)]])
    trial = rollout(policy, world, replans=3, scorer=goal(world))
    assert trial.outcome == "success"
    assert [(s.attempt, s.replans_left, len(s.executed)) for s in policy.asked] == [(0, 3, 0), (1, 3, 1), (2, 2, 1)]
    assert len(trial.plans) == 2


def test_replans_are_bounded():
    world = SquaresWorld()
    policy = MovesPolicy([[(RED, MIDDLE)], [(MIDDLE, RED)], [(RED, MIDDLE)]])
    trial = rollout(policy, world, replans=1, scorer=goal(world))
    # N replans are N plans after the first one, and one question more for the judgement of the last.
    assert (trial.outcome, len(policy.asked), world.ran) == ("failure", 3, 2)
    assert [situation.replans_left for situation in policy.asked] == [1, 1, 0]


@pytest.mark.parametrize("replans", [0, 1, 3])
def test_refused_plans_are_replanned_so_often_and_no_more(replans):
    policy = MovesPolicy([[(RED, (400.0, 60.0))] for _ in range(9)])
    trial = rollout(policy, SquaresWorld(), replans=replans)
    assert (trial.outcome, trial.stage, len(trial.plans)) == ("failure", "gate", 1)
    assert [asked.replans_left for asked in policy.asked] == [replans, *range(replans, 0, -1)]


class Blinking:
    """Finds nothing so many times, then moves what it should."""

    name = "blinking"

    def __init__(self, blinks, again=True):
        self.blinks, self.again, self.asked = blinks, again, []

    def decide(self, situation):
        self.asked.append(situation)
        if situation.executed:
            return Done("moved")
        plan = make_plan(situation.observation, [(RED, UP)])
        if len(self.asked) <= self.blinks:
            lost = replace(plan, status="not_found", message=f"blink {len(self.asked)}", actions=())
            return GaveUp(lost.message, "grounding", lost, again=self.again)
        return Act(plan.actions, plan)


def test_what_a_new_look_may_mend_is_planned_again_while_replans_are_left():
    world, listener = SquaresWorld(), Listener()
    policy = Blinking(2)
    trial = rollout(policy, world, replans=3, scorer=goal(world), subscribers=[listener])
    assert trial.outcome == "success"
    asked = [(s.attempt, s.replans_left, len(s.executed), s.refused) for s in policy.asked]
    assert asked == [(0, 3, 0, None), (1, 3, 0, None), (2, 2, 0, None), (3, 1, 1, None)]
    assert [plan.status for plan in trial.plans] == ["not_found", "not_found", "planned"]
    looks = [event.name for event in listener.events if event.kind == "observe"]
    assert looks[:3] == ["start", "attempt 1", "attempt 2"], "with a new picture each time"


@pytest.mark.parametrize("replans", [0, 1, 3])
def test_plans_that_find_nothing_are_made_so_often_and_no_more(replans):
    policy = Blinking(9)
    trial = rollout(policy, SquaresWorld(), replans=replans)
    assert (trial.outcome, trial.stage, trial.reason) == ("failure", "grounding", f"blink {replans + 1}")
    assert len(trial.plans) == len(policy.asked) == replans + 1
    final = Blinking(9, again=False)
    assert len(rollout(final, SquaresWorld(), replans=replans).plans) == len(final.asked) == 1


def test_an_object_nudged_between_two_actions_stops_the_second_one():
    world = SquaresWorld(nudge={4: ("blue", 3.0)})  # look 4 stands right before the second motion
    trial = rollout(MovesPolicy([[(RED, MIDDLE), (BLUE, RED)]]), world)
    assert (trial.outcome, trial.stage, world.ran) == ("failure", "gate", 1)
    assert "T3 (pick)" in trial.reason


def test_a_nudge_in_a_place_that_the_plan_changed_is_noticed_against_the_last_picture():
    world = SquaresWorld(nudge={4: ("red", 3.0)})
    trial = rollout(MovesPolicy([[(RED, MIDDLE), (MIDDLE, UP)]]), world)
    assert (trial.stage, world.ran) == ("gate", 1)
    assert rollout(MovesPolicy([[(RED, MIDDLE), (MIDDLE, UP)]]), SquaresWorld()).stage is None


def test_a_refused_plan_goes_back_to_the_policy_while_replans_are_left():
    world = SquaresWorld()
    policy = MovesPolicy([[(RED, (400.0, 60.0))], [(RED, UP)]])
    trial = rollout(policy, world, replans=1, scorer=goal(world))
    assert trial.outcome == "success"
    assert any("workspace y" in reason for reason in policy.asked[1].refused.reasons)
    alone = rollout(MovesPolicy([[(RED, (400.0, 60.0))]]), SquaresWorld())
    assert (alone.outcome, alone.stage) == ("failure", "gate")


def test_a_plan_that_was_read_runs_as_it_is_and_no_other():
    world = SquaresWorld()
    plan = make_plan(world.observe(), [(RED, UP)])
    policy = MovesPolicy([])
    assert rollout(policy, world, plan=plan, scorer=goal(world)).outcome == "success"
    assert policy.asked[0].plan is plan

    class Stubborn(MovesPolicy):
        def decide(self, situation):
            other = make_plan(situation.observation, [(RED, MIDDLE)])
            return Act(other.actions, other)

    fresh = SquaresWorld()
    trial = rollout(Stubborn([]), fresh, plan=plan)
    assert (trial.stage, fresh.ran) == ("gate", 0)
    assert "plan that was read" in trial.reason


def test_a_plan_of_another_scene_does_not_run():
    plan = make_plan(SquaresWorld().observe(), [(RED, UP)])
    changed = SquaresWorld({"red": (63.0, 60.0), "blue": BLUE})
    assert rollout(MovesPolicy([]), changed, plan=plan).stage == "gate"
    assert changed.ran == 0


def test_approval_is_required_when_asked_for():
    world = SquaresWorld()
    seen = world.observe()
    plan = make_plan(seen, [(RED, UP)])
    consent = Proposal(plan, plan.actions, GateReport(()), seen.hash).approve("Ada")
    assert rollout(MovesPolicy([]), world, plan=plan, approval=consent).stage is None
    refused = rollout(MovesPolicy([]), SquaresWorld(), plan=plan, approval=replace(consent, plan_id="0" * 64))
    assert (refused.stage, refused.runs) == ("gate", ())
    asked = []

    def approver(proposal):
        asked.append((proposal.id, proposal.gate.admitted, proposal.picture))

    no = rollout(MovesPolicy([]), SquaresWorld(), plan=plan, approval=approver)
    assert (no.stage, no.runs) == ("gate", ())
    assert "you declined" in no.reason
    assert asked == [(plan.id, True, seen.hash)]


@pytest.mark.parametrize(
    ("error", "outcome", "stage"),
    [
        (NotFoundError("T1 not found"), "failure", "grounding"),
        (BudgetReached("the cap of 3 calls is reached"), "failure", "budget"),
        (ModelUnavailableError("no answer"), "error", "model"),
    ],
)
def test_errors_of_method_and_provider_are_counted_apart(error, outcome, stage):
    world = SquaresWorld()
    trial = rollout(Raises(error), world, scorer=goal(world))
    assert (trial.outcome, trial.stage, trial.reason) == (outcome, stage, str(error))


@pytest.mark.parametrize("error", [RobotFaultError("joint 3: over-current"), SafetyStopError("stop was pressed")])
def test_a_fault_halts_the_run(error):
    world = SquaresWorld(trouble={1: error})
    trial = rollout(MovesPolicy([[(RED, UP), (BLUE, RED)], [(RED, UP)]]), world, replans=3)
    assert (trial.outcome, trial.stage, trial.reason) == ("failure", "execution", str(error))
    assert (world.ran, world.stopped) == (1, 1)
    assert trial.reports[0].executed is False


def test_ctrl_c_stops_the_world_and_hands_over_what_happened():
    world, listener = SquaresWorld(trouble={2: KeyboardInterrupt()}), Listener()
    with pytest.raises(KeyboardInterrupt):
        rollout(MovesPolicy([[(RED, UP), (BLUE, RED)]]), world, subscribers=[listener])
    assert world.stopped == 1
    trial = listener.events[-1].content
    assert (trial.outcome, trial.stage, len(trial.runs)) == ("error", "interrupted", 2)


def test_a_bug_of_ours_is_not_the_methods_failure():
    class Ours(Raises):
        """Stands for a method of the package."""

    Ours.__module__ = "wonderful_team.planning.team"
    world, listener = SquaresWorld(), Listener()
    with pytest.raises(ZeroDivisionError):
        rollout(Ours(ZeroDivisionError("x")), world, subscribers=[listener])
    assert listener.events[-1].content.outcome == "error"
    assert world.stopped == 1


def test_an_action_that_did_not_run_ends_the_attempt():
    world = SquaresWorld()
    trial = rollout(MovesPolicy([[((30.0, 100.0), UP), (RED, UP)]]), world)
    assert (world.ran, trial.outcome) == (1, "unscored")
    assert "nothing was held" in trial.reason


def test_the_horizon_is_respected():
    world = SquaresWorld(horizon=1)
    trial = rollout(MovesPolicy([[(RED, MIDDLE), (BLUE, RED)], [(RED, UP)]]), world, replans=3, scorer=goal(world))
    assert (world.ran, trial.outcome, trial.stage) == (1, "failure", "execution")
    assert "horizon of 1 action" in trial.reason


def test_giving_up_is_a_failure_with_the_methods_stage():
    class Quits(MovesPolicy):
        def decide(self, situation):
            return GaveUp("cannot see it", "grounding")

    trial = rollout(Quits([]), SquaresWorld())
    assert (trial.outcome, trial.stage, trial.reason) == ("failure", "grounding", "cannot see it")


def test_chunk_policies_are_asked_again_without_replans():
    class Chunks(MovesPolicy):
        chunks = True

    world = SquaresWorld(horizon=5)
    policy = Chunks([[(RED, MIDDLE)], [(MIDDLE, UP)]])
    assert rollout(policy, world, scorer=goal(world)).outcome == "success"
    assert [situation.attempt for situation in policy.asked] == [0, 0, 0]


class Slow(MovesPolicy):
    """Async, and on one loop only, like a client with connections."""

    loops: set

    async def decide(self, situation):
        await asyncio.sleep(0)
        self.loops.add(id(asyncio.get_running_loop()))
        return MovesPolicy.decide(self, situation)


def slow_rollout():
    policy = Slow([[(RED, MIDDLE)], [(MIDDLE, UP)]])
    policy.loops = set()
    world = SquaresWorld()
    trial = rollout(policy, world, replans=2, scorer=goal(world))
    return trial.outcome, len(policy.loops)


def test_async_policies_work_with_and_without_a_running_loop():
    async def in_a_notebook():
        return slow_rollout()

    assert slow_rollout() == ("success", 1)
    assert asyncio.run(in_a_notebook()) == ("success", 1)


def test_usage_is_taken_from_policies_that_know_it():
    class Paid(MovesPolicy):
        usage_by_role = {"supervisor": Usage(calls=2)}
        model_name = "mine"

    trial = rollout(Paid([]), SquaresWorld())
    assert (trial.usage.calls, trial.model) == (2, "mine")


def test_wrong_use_is_refused():
    with pytest.raises(ConfigError, match="replans must be 0 or more, got -1"):
        rollout(MovesPolicy([]), SquaresWorld(), replans=-1)

    class Odd(MovesPolicy):
        def decide(self, situation):
            return "done"

    trial = rollout(Odd([]), SquaresWorld())
    assert (trial.outcome, trial.stage) == ("failure", "method")
    assert "returned is a str; valid: Act, Done, GaveUp" in trial.reason


def test_what_was_left_undone_without_an_action_is_a_failure_of_the_plan():
    class Unmet:
        """A scorer that names no stage."""

        def score(self) -> Score:
            return Score(False, None, "the red square is not up")

    lazy = rollout(MovesPolicy([]), SquaresWorld(), scorer=Unmet())
    assert (lazy.outcome, lazy.stage) == ("failure", "plan")
    busy = rollout(MovesPolicy([[(RED, UP)]]), SquaresWorld(), scorer=Unmet())
    assert (busy.outcome, busy.stage) == ("failure", "execution")


def test_done_at_once_moves_nothing():
    world = SquaresWorld()
    trial = rollout(MovesPolicy([]), world, scorer=SquaresTruth(world, {"red": RED}))
    assert (trial.outcome, world.ran) == ("success", 0)
