"""A plan that puts one thing where it has put it already names two things alike: nothing of it moves."""

from __future__ import annotations

import pytest

from wonderful_team.core.actions import At, Beside, HomeStep, OriginOf, PickPlaceStep, PushStep
from wonderful_team.core.values import PlannedAction
from wonderful_team.runtime.agreement import repeat_checks


def again(*steps):
    """The actions, counted from 1, that the gate refuses for this."""
    return [check.action + 1 for check in repeat_checks([PlannedAction(step, None) for step in steps])]


def put(thing, place, turn=0.0):
    return PickPlaceStep("G1", thing, place if not isinstance(place, str) else At(place), turn)


@pytest.mark.parametrize(
    ("steps", "refused"),
    [
        ((put("T1", "T9"), put("T2", "T9")), []),
        ((put("T1", "T9"), put("T1", "T9")), [2]),
        ((put("T1", "T9"), put("T2", "T9"), put("T1", "T9"), put("T1", "T9")), [3, 4]),
        ((put("T1", Beside("T9", "left")), put("T1", Beside("T9", "left"))), [2]),
        # Reasons to pick it up once more: to another place, back and there again, turned, pushed in between.
        ((put("T1", "T9"), put("T1", "T8")), []),
        ((put("T1", "T9"), put("T1", OriginOf("T1")), put("T1", "T9")), []),
        ((put("T1", "T9"), put("T1", "T9", 90.0)), []),
        ((put("T1", "T9"), PushStep("G1", At("T1"), At("T8")), put("T1", "T9")), []),
        ((put("T1", "T9"), HomeStep("G1"), put("T1", "T9")), [3]),
    ],
)
def test_a_thing_is_put_to_one_place_once(steps, refused):
    assert again(*steps) == refused


def test_the_gate_refuses_such_a_plan_and_says_which_thing_and_since_when():
    from tests.runtime.runtime_fakes import SquaresWorld, make_plan
    from tests.runtime.test_gate import MOVE, gate

    now = SquaresWorld().observe()
    plan = make_plan(now, [MOVE, MOVE])
    twice = [plan.actions[0], plan.actions[0]]
    assert not gate(twice, plan=plan, then=now, now=now).admitted
    reasons = " ".join(gate(twice, plan=plan, then=now, now=now).reasons)
    assert "picked again" in reasons
    assert "lies there since action 1" in reasons
    assert "picked again" not in " ".join(gate(twice, now=now).reasons)
