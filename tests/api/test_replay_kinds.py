"""Every kind of run replays from its own answers: one recorded run of each, made again without a model or a world."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from tests.desk import WORDS, draw_desk, read_record
from wonderful_team.api.replay import replay
from wonderful_team.errors import ModelCodeError, ModelServerError
from wonderful_team.offline import OfflineModel

TASK = "tabletop/visual_manipulation"
DESK = Path(__file__).parents[2] / "examples"


class Faulty:
    """A world whose robot does nothing and reports a fault the first time, or raises."""

    def __init__(self, inner, error=None):
        self.inner, self.error, self.tries = inner, error, 0

    def __getattr__(self, name):
        return getattr(self.inner, name)

    def execute(self, action):
        self.tries += 1
        if self.error is not None:
            raise self.error
        if self.tries == 1:
            return wt.StepReport(action, False, {"tool_m": [0.1, 0.2, 0.3]}, "the suction cup did not reach")
        return self.inner.execute(action)


class Failing(OfflineModel):
    """Breaks at one kind of question."""

    def __init__(self, contract, error):
        super().__init__()
        self.contract, self.error = contract, error

    def answer(self, request):
        if request.contract == self.contract:
            raise self.error
        return super().answer(request)


def in_world(out, task=TASK, wrap=lambda world: world, team=None, **more):
    world = wt.make_world(task, seed=3)
    try:
        return wt.rollout(team or wt.Team(out=out), wrap(world), seed=3, scene=f"{task}#3", **more)
    finally:
        world.close()


def reobserve(out):
    trial = in_world(out, "tabletop/sweep_without_exceeding", replans=1, reobserve=4)
    # One push of the first plan ran; the second was made for the picture after it.
    assert len(read_record(trial.folder)["planner"]["plans"]) > 1
    return trial


def looks_then_a_replan(out):
    """After a look the robot fails: what follows is judged and replanned, and looks are left."""
    trial = in_world(out, "tabletop/sweep_without_exceeding", Faulty, replans=2, reobserve=4)
    assert any("did not reach" in str(report.fault) for report in trial.reports)
    return trial


def replans(out):
    return in_world(out, wrap=Faulty, replans=2)


def refused(out):
    def cramped(world):
        faulty = Faulty(world)
        faulty.limits = wt.Limits((0.25, -0.5, 0.0), (0.5, 0.0, 0.3))
        return faulty

    trial = in_world(out, wrap=cramped, replans=2)
    assert not trial.gates[0].admitted
    return trial


def robot_fault(out):
    trial = in_world(out, wrap=lambda world: Faulty(world, RuntimeError("joint 3 is hot")), replans=2)
    assert "joint 3 is hot" in trial.reason
    return trial


def model_fault(out):
    trial = in_world(out, team=wt.Team(model=Failing("JudgeBoxes", KeyError("x")), out=out))
    assert trial.outcome == "error"
    return trial


def model_fault_after_motion(out):
    trial = in_world(out, team=wt.Team(model=Failing("JudgeOutcome", ModelServerError("502")), out=out), replans=2)
    assert (trial.outcome, len(trial.reports)) == ("error", 1)
    return trial


def approved(out):
    trial = in_world(out, approval=lambda proposal: proposal.approve("a person"))
    assert trial.outcome == "success"
    return trial


def declined(out):
    trial = in_world(out, approval=lambda proposal: proposal.decline("a person"), replans=2)
    assert trial.reports == ()
    return trial


def declined_with_advice(out):
    answers = iter((lambda one: one.decline("a person", "it is the wrong one"), lambda one: one.approve("a person")))
    trial = in_world(out, approval=lambda proposal: next(answers)(proposal), replans=2)
    assert trial.outcome == "success"
    return trial


def own_world(out):
    world = wt.make_world(f"{DESK}/own_world.py:TileDesk", seed=4)
    return wt.rollout(wt.Team(out=out), world, seed=4, scene="own_world.py:TileDesk#4", replans=1)


def a_plan_that_was_read(out):
    world = wt.make_world(TASK, seed=3)
    try:
        team = wt.Team(out=out)
        plan = team.plan(world.observe(), world.instruction)
        return wt.rollout(team, world, plan=plan, seed=3, scene=f"{TASK}#3")
    finally:
        world.close()


def photo(out):
    return wt.Team(out=out).plan(wt.Observation.from_files(DESK / "desk.png"), "put the red block into the blue bowl")


def photo_in_metres(out):
    desk = draw_desk(out)
    seen = wt.Observation.from_files(desk / "desk.png", depth=desk / "depth.png", camera=desk / "camera.json")
    return wt.Team(out=out).plan(seen, WORDS)


def photo_with_a_model_fault(out):
    with pytest.raises(ModelCodeError) as found:
        wt.Team(model=Failing("DraftPlan", KeyError("x")), out=out).plan(
            wt.Observation.from_files(DESK / "desk.png"), "put the red block into the blue bowl"
        )
    return found.value


def stopped_early(out):
    return wt.Team(out=out).plan(
        wt.Observation.from_files(DESK / "desk.png"), "put the red block into the blue bowl", until="checked"
    )


def not_understood(out):
    return wt.Team(out=out).plan(wt.Observation.from_files(DESK / "desk.png"), "put the flurb on the blue bowl")


def clarified(out):
    def ask(question, choices):
        return choices[1]

    seen = np.full((480, 640, 3), (225, 220, 209), np.uint8)
    seen[100:160, 100:160] = seen[100:160, 400:460] = (200, 30, 30)
    seen[300:400, 250:400] = (30, 60, 200)
    plan = wt.Team(out=out, ask=ask).plan(seen, "put the red block onto the blue block")
    assert plan.status == "planned"
    # The answer is heeded: the second choice is the block on the right.
    assert plan.plan.grounded["T1"].box.x0 > 300
    return plan


def out_of_budget(out):
    return in_world(out, team=wt.Team(out=out, max_calls=3))


def grounding(out):
    return wt.Team(out=out).ground(wt.Observation.from_files(DESK / "desk.png"), ["red block"])


KINDS = (
    reobserve, looks_then_a_replan, replans, refused, robot_fault, model_fault, model_fault_after_motion, approved, declined,
    declined_with_advice, own_world,
    a_plan_that_was_read, photo, photo_in_metres, photo_with_a_model_fault, stopped_early, not_understood, clarified,
    out_of_budget,
    grounding,
)  # fmt: skip


@pytest.mark.parametrize("make", KINDS, ids=lambda kind: kind.__name__)
def test_every_kind_of_run_replays(make, tmp_path, monkeypatch):
    folder = make(tmp_path).folder
    record = read_record(folder)
    monkeypatch.setattr("wonderful_team.registry.worlds.make_world", lambda *_, **__: pytest.fail("a world was made"))
    monkeypatch.setattr(OfflineModel, "answer", lambda *_: pytest.fail("a model was asked"))
    found = replay(folder)
    assert found.now == found.then
    # Not one request is left out, those that failed included.
    requests = record["planner"]["requests"]
    ended = [one for one in requests if one["answer"] or one["invalid"] or "failed" in one]
    assert found.answers == len(ended)


@pytest.mark.parametrize("make", [reobserve, looks_then_a_replan, replans], ids=lambda kind: kind.__name__)
def test_a_record_without_the_counts_of_attempts_replays_by_the_names_of_its_pictures(make, tmp_path):
    """As records of earlier releases are, which counted one replan fewer as left."""
    folder = make(tmp_path).folder
    record = read_record(folder)
    del record["planner"]["asked"]
    text = re.sub(r"Attempts left: (\d+)\.", lambda left: f"Attempts left: {int(left[1]) - 1}.", json.dumps(record))
    (folder / "record.json").write_text(text, encoding="utf-8")
    assert replay(folder).same
