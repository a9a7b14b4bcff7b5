"""After a subgoal: free where nothing speaks against it, one question where something does, and a lost plan is not finished."""

from __future__ import annotations

import asyncio
from typing import Any

import numpy as np
import pytest

from tests.planning.helpers import asked, draft, one_step_each, scripted, subgoal
from tests.planning.rounds import photo
from wonderful_team.core.actions import PICK_PLACE, Gripper, Home, MoveTo, PickPlace
from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Act, Checked, Decision, Situation
from wonderful_team.core.values import NO_WORKSPACE, Instruction, Plan, StepReport, Subgoal, SubgoalRun, Verdict
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.checking import AS_EXPECTED, measured_verdicts

SEEN = photo(640, 480)
MOVED = "T1 (the first thing): the picture there has changed, though nothing was to touch it"
CARRY = PickPlace(np.array([0.5, 0.2, 0.034]), np.array([0.4, -0.2, 0.0]), 0.0)
RUN = SubgoalRun("G1", SEEN, SEEN, (StepReport(CARRY, True, {"held": True}),))
ADVICE = {"reasoning": "", "decision": "replan", "cause": "it was moved", "advice": "Take it where it lies."}
GOES_ON = {"reasoning": "", "status": "done", "evidence": "", "cause": None, "rest_holds": True, "what_changed": ""}
LOST = {**GOES_ON, "rest_holds": False, "what_changed": "the first thing was moved"}


def situation(attempt: int = 0, executed: tuple[SubgoalRun, ...] = (), doubts: tuple[str, ...] = ()) -> Situation:
    instruction = Instruction("put the first thing into the second thing")
    return Situation(
        SEEN, instruction, PICK_PLACE, NO_WORKSPACE, attempt=attempt, replans_left=2, executed=executed, doubts=doubts
    )


def followed(
    doubts: tuple[str, ...], config: TeamConfig | None = None, run: SubgoalRun = RUN, **answers: Any
) -> tuple[ScriptedModel, Checked, Decision]:
    """A plan of two subgoals, the check after the first, and the decision after what it says."""
    two = draft(subgoal("G1", "put the lid aside"), subgoal("G2", "put the block in"))
    needs = [{"subgoal": name, "targets": ["T1", "T2"]} for name in ("G1", "G2")]
    listed = {"reasoning": "", "targets": two["targets"], "needs": needs}
    model = scripted(DraftPlan=two, ExtractTargets=listed, WriteSteps=one_step_each, Replan=ADVICE, **answers)
    team = TeamPolicy(model, config or TeamConfig())

    async def go() -> tuple[Checked, Decision]:
        first = await team.decide(situation())
        assert isinstance(first, Act)
        checked = await team.check(situation(0, (run,), doubts)) if team.checks_subgoals else Checked()
        return checked, await team.decide(situation(1, (run,)))

    return model, *asyncio.run(go())


def test_nothing_is_asked_where_nothing_speaks_against_a_subgoal() -> None:
    model, checked, _ = followed(())
    assert checked == Checked((Verdict("G1", "done", None, AS_EXPECTED),))
    assert asked(model, "JudgeSubgoal") == []
    assert len(asked(model, "JudgeOutcome")) == 1


def test_a_doubt_is_looked_at_and_may_turn_out_to_be_nothing() -> None:
    model, checked, _ = followed((MOVED,), JudgeSubgoal=GOES_ON)
    (request,) = asked(model, "JudgeSubgoal")
    assert any(MOVED in getattr(part, "text", "") for part in request.parts)
    assert request.question.subgoal.id == "G1"
    assert [one.id for one in request.question.later] == ["G2"]
    assert (checked.stop, checked.verdicts[0].status) == ("", "done")
    assert len(asked(model, "JudgeOutcome")) == 1


def test_a_plan_that_does_not_hold_any_more_is_stopped_and_planned_anew_from_there() -> None:
    model, checked, decision = followed((MOVED,), JudgeSubgoal=LOST)
    assert checked.stop == "the first thing was moved"
    # What was said then is not asked again.
    assert asked(model, "JudgeOutcome") == []
    (replan,) = asked(model, "Replan")
    assert [(v.subgoal, v.status) for v in replan.question.verdicts] == [("G1", "done"), ("G2", "not_done")]
    assert "the first thing was moved" in (replan.question.verdicts[1].cause or "")
    # What was reached is told to those who plan anew; what was said of it is told once.
    assert asked(model, "DraftPlan")[1].question.task.done == ("'put the lid aside': reached, as judged",)
    assert isinstance(decision, Act)
    assert decision.verdicts == ()


def test_a_subgoal_that_was_missed_stops_the_plan() -> None:
    missed = {**GOES_ON, "status": "not_done", "cause": "it lies in the other box"}
    model, checked, _ = followed((MOVED,), JudgeSubgoal=missed)
    assert "it lies in the other box" in checked.stop
    (replan,) = asked(model, "Replan")
    assert [v.status for v in replan.question.verdicts] == ["not_done", "not_done"]
    assert asked(model, "DraftPlan")[1].question.task.done == ()


def test_what_a_look_does_not_show_is_left_to_a_later_one() -> None:
    _, checked, _ = followed((MOVED,), JudgeSubgoal={**GOES_ON, "status": "unclear"})
    assert checked.stop == ""


@pytest.mark.parametrize(
    ("config", "count"), [(TeamConfig(thorough=True), 1), (TeamConfig(mode="paper"), 0)], ids=["thorough", "paper"]
)
def test_thorough_asks_after_every_subgoal_and_the_paper_after_the_whole_attempt(
    config: TeamConfig, count: int
) -> None:
    model, _, _ = followed((), config)
    assert len(asked(model, "JudgeSubgoal")) == count
    assert len(asked(model, "JudgeOutcome")) == 1


def test_what_the_robot_measured_settles_an_attempt_without_a_question() -> None:
    dropped = SubgoalRun("G1", SEEN, SEEN, (StepReport(CARRY, False, {"held": False}, "nothing was held"),))
    model, _, _ = followed((), run=dropped, JudgeSubgoal=GOES_ON)
    assert asked(model, "JudgeOutcome") == []
    (replan,) = asked(model, "Replan")
    assert replan.question.verdicts[0].cause == "nothing was held"
    for config in (TeamConfig(thorough=True), TeamConfig(mode="paper")):
        model, _, _ = followed((), config, run=dropped)
        assert len(asked(model, "JudgeOutcome")) == 1


def arm(*said: tuple[str, bool, bool]) -> tuple[StepReport, ...]:
    """Reports of an arm: what it did, whether that worked, whether it holds something afterwards."""
    actions = {
        "open": Gripper("open"),
        "close": Gripper("close"),
        "move": MoveTo(Pose.at(np.array([0.5, 0.0, 0.2]), 0.0)),
        "home": Home(),
    }
    return tuple(
        StepReport(actions[what], worked, {"holding": holding}, None if worked else "it failed")
        for what, worked, holding in said
    )


EMPTY = (("open", True, False), ("move", True, False), ("close", False, False), ("home", True, False))
LOST_IT = (("close", True, True), ("move", False, False), ("home", True, False))
BEFORE_IT = (("open", True, False), ("move", False, False))
LET_GO = (("close", True, True), ("move", True, True), ("open", True, False), ("move", False, False))
CENTRED = (("close", True, True), ("open", True, False), ("close", False, False))
STOPPED = (("close", True, True), ("move", False, True))


@pytest.mark.parametrize(
    ("said", "settled"),
    [(EMPTY, True), (LOST_IT, True), (BEFORE_IT, False), (LET_GO, False), (STOPPED, True), (CENTRED, True)],
    ids=[
        "closed on nothing",
        "lost on the way",
        "before it gripped",
        "after it let go",
        "it still holds it",
        "second grip",
    ],
)
def test_what_was_never_put_down_settles_it(said: tuple[tuple[str, bool, bool], ...], settled: bool) -> None:
    plan = Plan(Instruction("x"), "planned", (Subgoal("G1", "one"), Subgoal("G2", "two")))
    run = SubgoalRun("G2", SEEN, SEEN, arm(*said))
    known = {"G1": Verdict("G1", "done")}
    found = measured_verdicts(plan, (RUN, run), known)
    assert (found is not None) is settled
    assert found is None or [v.status for v in found] == ["done", "not_done"]
    # An earlier subgoal that nobody judged has to be looked at.
    assert measured_verdicts(plan, (RUN, run), {}) is None
