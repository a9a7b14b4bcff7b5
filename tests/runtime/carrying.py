"""An arm that carries things to places, before the gate."""

from __future__ import annotations

from collections.abc import Mapping

from wonderful_team.core.actions import ARM, At, CloseStep, HomeStep, MoveStep, OpenStep, Step
from wonderful_team.core.values import GateReport, GroundedTarget, Instruction, Limits, Observation, Plan, View
from wonderful_team.motion import ground_actions
from wonderful_team.runtime import check_gate


def carried(thing: str, place: str) -> tuple[Step, ...]:
    return (
        OpenStep("G1"),
        MoveStep("G1", At(thing), "clear"),
        MoveStep("G1", At(thing), "at"),
        CloseStep("G1"),
        MoveStep("G1", At(thing), "clear"),
        MoveStep("G1", At(place), "clear"),
        MoveStep("G1", At(place), "at"),
        OpenStep("G1"),
        MoveStep("G1", At(place), "clear"),
        HomeStep("G1"),
    )


def gate_of_carrying(
    view: View, grounded: Mapping[str, GroundedTarget], moves: tuple[tuple[str, str], ...], limits: Limits
) -> GateReport:
    """The gate's word on a plan that carries things (the first of each pair) to places, one after the other."""
    steps = tuple(step for thing, place in moves for step in carried(thing, place))
    actions = ground_actions(steps, grounded, view, limits)
    now = Observation({"top": view})
    plan = Plan(Instruction("tidy up"), "planned", actions=actions, grounded=grounded, scene_hash=now.hash)
    return check_gate(plan.actions, vocabulary=ARM, limits=limits, plan=plan, then=now, now=now)
