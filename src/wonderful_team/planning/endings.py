"""How planning ends: the plan with its status, and why it did not come to more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.core.values import GroundedTarget, Plan, Target
from wonderful_team.planning.notes import one_line
from wonderful_team.planning.plan_loop import PlanState


def with_state(plan: Plan, state: PlanState, status: str) -> Plan:
    """The plan with what is known of it so far."""
    return replace(
        plan,
        status=status,
        subgoals=state.subgoals,
        targets=state.targets,
        mode=state.mode,
        verified=state.verified,
        questions=state.questions,
        first_draft=plan.first_draft or state.first_draft,
    )


def nothing_to_do(plan: Plan) -> Plan:
    """The end of a plan without subgoals."""
    return replace(plan, status="planned", message="nothing to do: the instruction is already fulfilled")


def refused(plan: Plan, what: str) -> Plan:
    """The end of a plan that may run only with Verification's approval (strict)."""
    return replace(plan, status="refused", message=f"Verification did not approve the {what} (strict)", stage="plan")


def not_found(absent: Sequence[GroundedTarget]) -> str:
    """What was looked for in vain, in one line."""
    return "; ".join(f"{item.target.id} not found: {item.target.words}" for item in absent)


def told_not_found(item: GroundedTarget) -> str:
    """The same of one target, with why, for whoever plans again."""
    why = one_line(item.history[-1].text).rstrip(".") if item.history else ""
    return f"{item.target.id} ({item.target.words}) was not found in the picture{f': {why}' if why else ''}."


def asks_anew(state: PlanState, absent: Sequence[GroundedTarget]) -> bool:
    """Whether a revised plan looks for something else than what was not found."""
    missing = {_looked_for(item.target) for item in absent}
    return not missing & {_looked_for(target) for target in state.targets}


def _looked_for(target: Target) -> tuple[object, ...]:
    return target.kind, target.words, target.part, target.where, target.like, target.alike


def same_plan(state: PlanState, last: PlanState) -> bool:
    """Whether a plan that could not be carried out came back unchanged."""
    return (state.subgoals, state.targets) == (last.subgoals, last.targets)


def named(item: GroundedTarget) -> str:
    """A target in words, and whether it was found."""
    state = {"found": "found", "absent": "not here", "gave_up": "gave up"}[item.status]
    return f"{item.target.words} ({state})"
