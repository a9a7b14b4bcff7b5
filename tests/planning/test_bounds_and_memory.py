"""Budgets keep the best so far; memory and record do not depend on races."""

from __future__ import annotations

import asyncio
import random

import pytest

from tests.planning.helpers import APPROVED, Tape, asked, doubt, plan_with, scripted
from tests.planning.rounds import photo
from tests.planning.stub_model import stub_script
from wonderful_team.core.actions import ARM, PICK_PLACE
from wonderful_team.core.caps import Caps
from wonderful_team.core.values import Instruction, Usage, Words
from wonderful_team.errors import ConfigError, ModelUnavailableError
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig, TeamPolicy


@pytest.mark.parametrize("calls", [1, 2, 3, 4, 6, 9, 14])
def test_a_cap_on_calls_is_never_passed_and_keeps_the_best_so_far(calls):
    model = scripted()
    plan = plan_with(model, caps=Caps(calls=calls))
    assert len(model.requests) <= calls
    assert plan.status == "budget"
    assert bool(plan.subgoals) == (calls >= 1)
    assert f"{calls} calls" in plan.message


def test_a_cap_on_money_stops_before_the_call_that_could_pass_it():
    from wonderful_team.core.values import Answer

    class Paid:
        name = "paid"
        calls = 0

        async def answer(self, request):
            self.calls += 1
            value = await ScriptedModel(stub_script()).answer(request)
            return Answer(value.value, Usage(calls=1, tokens_in=100, usd=0.01))

    model = Paid()
    plan = plan_with(model, TeamConfig(mode="lean"), caps=Caps(usd=0.025))
    assert plan.status == "budget"
    assert model.calls == 2


def test_a_slow_model_meets_the_cap_on_seconds():
    plan = plan_with(ScriptedModel(stub_script(), delay_s=0.2), caps=Caps(seconds=0.3))
    assert plan.status == "budget"
    assert "0.3 s" in plan.message


def test_a_silent_model_is_unavailable_not_a_failed_plan():
    team = TeamPolicy(ScriptedModel(stub_script(), delay_s=5), deadline_s=0.05)
    with pytest.raises(ModelUnavailableError, match=r"within 0\.05 s"):
        asyncio.run(team.make_plan(photo(), Instruction("do it"), PICK_PLACE))


@pytest.mark.parametrize("caps", [{"calls": 0}, {"usd": -1}, {"seconds": 0}])
def test_a_cap_that_is_not_positive_is_refused(caps):
    with pytest.raises(ConfigError, match="must be positive"):
        Caps(**caps)


def test_requests_do_not_depend_on_the_order_of_answers():
    """Answers that arrive in another order leave every request's words, notes and pictures the same."""

    def each_sample_elsewhere(request):
        points = stub_script()["LocatePoints"](request)["points"]
        moved = [{"x": point["x"] + 3 * request.sample, "y": point["y"]} for point in points]
        return {"reasoning": "", "found": True, "points": moved}

    class Jittery(ScriptedModel):
        def __init__(self, seed):
            super().__init__({**stub_script(), "LocatePoints": each_sample_elsewhere})
            self.rng, self.late = random.Random(seed), seed > 0

        async def answer(self, request):
            # Seed 0 answers at once, as a cache or a replay does.
            await asyncio.sleep(self.rng.random() * 0.01 if self.late else 0)
            return await super().answer(request)

    def sent(seed):
        model = Jittery(seed)
        plan = plan_with(model)
        words = {r.id: "".join(p.text for p in r.parts if isinstance(p, Words)) for r in model.requests}
        pictures = {r.id: [p.hash for p in r.pictures] for r in model.requests}
        return plan.id, words, pictures, {r.id: [n.text for n in r.notes] for r in model.requests}

    assert sent(0) == sent(1) == sent(2) == sent(3)


def test_memory_that_cannot_answer_costs_a_warning_not_the_plan():
    tape = Tape()
    plan = plan_with(scripted(Remember="nonsense", ReviewPlan=[doubt(), APPROVED]), tape=tape)
    assert plan.status == "planned"
    assert "nothing remembered" in tape.warnings


def test_what_memory_keeps_reaches_the_steps():
    kept = {"keep": True, "key": "colour", "summary": "the bowl is the green one"}
    model = scripted(Remember=kept, ReviewPlan=[doubt(), APPROVED])
    plan_with(model)
    texts = "".join(p.text for r in asked(model, "WriteSteps") for p in r.parts if isinstance(p, Words))
    assert "the bowl is the green one" in texts


def test_helper_functions_run_in_the_sandbox_and_are_rewritten_until_accepted():
    path_goal = {
        "reasoning": "",
        "subgoals": [
            {"id": "G1", "text": "draw round it", "after": [], "targets": ["T1"], "function": "a path round T1"}
        ],
        "targets": [
            {
                "id": "T1",
                "kind": "object",
                "words": "the thing",
                "part": None,
                "where": "",
                "like": [],
                "use": ["place"],
            }
        ],
        "mode": "one_step",
        "clarification": None,
    }
    right = "def path(boxes):\n    x0, y0, x1, y1 = boxes['T1']\n    return [(x0, y0), (x1, y0), (x1, y1)]"
    model = scripted(
        DraftPlan=path_goal,
        WriteFunction=[
            {"reasoning": "", "code": "import os\ndef path(boxes):\n    return os.listdir('/')"},
            {"reasoning": "", "code": "def path(boxes):\n    return [(1, 2), (3, 4)]"},
            {"reasoning": "", "code": right},
        ],
        ReviewPath=[
            {"reasoning": "", "accepted": False, "problem": "it is nowhere near T1"},
            {"reasoning": "", "accepted": True, "problem": ""},
        ],
        WriteSteps={"reasoning": "", "steps": [{"kind": "follow", "subgoal": "G1", "function": "G1"}]},
    )
    plan = plan_with(model, TeamConfig(mode="lean"), vocabulary=ARM)
    assert plan.status == "planned", plan.message
    assert [s.kind for s in plan.steps] == ["follow"]
    second, third = asked(model, "WriteFunction")[1:]
    assert "os" in second.question.error
    assert "nowhere near T1" in third.question.error


def test_functions_that_never_work_fail_their_stage_at_the_bound():
    path_goal = {
        "reasoning": "",
        "subgoals": [{"id": "G1", "text": "draw", "after": [], "targets": ["T1"], "function": "a path"}],
        "targets": [
            {
                "id": "T1",
                "kind": "object",
                "words": "the thing",
                "part": None,
                "where": "",
                "like": [],
                "use": ["place"],
            }
        ],
        "mode": "one_step",
        "clarification": None,
    }
    model = scripted(DraftPlan=path_goal, WriteFunction={"reasoning": "", "code": "def path(boxes): return []"})
    plan = plan_with(model, TeamConfig(mode="lean"), vocabulary=ARM)
    assert plan.status == "failed"
    assert plan.stage == "function"
    assert len(asked(model, "WriteFunction")) == 5


def test_the_budget_holds_with_doubts_too():
    model = scripted(ReviewPlan=doubt())
    plan = plan_with(model, caps=Caps(calls=7))
    assert plan.status == "budget"
    assert len(model.requests) == 7
