"""How an error ends a plan, whichever method made it."""

from __future__ import annotations

from dataclasses import replace

from wonderful_team.core.values import Plan
from wonderful_team.errors import (
    BudgetReached,
    GeometryError,
    ModelOutputError,
    NeedsClarification,
    NotFoundError,
    NotUnderstoodError,
    PlanError,
    WonderfulTeamError,
)

STATUS: tuple[tuple[type[WonderfulTeamError], str], ...] = (
    (NotFoundError, "not_found"),
    (NotUnderstoodError, "not_understood"),
    (NeedsClarification, "needs_clarification"),
    (BudgetReached, "budget"),
)
ENDS_A_PLAN = (
    PlanError,
    ModelOutputError,
    NotFoundError,
    NotUnderstoodError,
    NeedsClarification,
    BudgetReached,
)
"""What is the method's failure or its cap; other errors are somebody else's and pass."""


def to_mend(error: WonderfulTeamError) -> str:
    """What a new look and another plan may do that this one could not: find its targets, or compute its numbers from them; "" otherwise.

    Words, and not the error: it holds all that was at work when it was raised.
    """
    return str(error) if isinstance(error, NotFoundError | GeometryError) else ""


def ended_by(plan: Plan, error: WonderfulTeamError) -> Plan:
    """The best so far, with what ended it."""
    status = next((name for kind, name in STATUS if isinstance(error, kind)), "failed")
    choices = error.choices if isinstance(error, NeedsClarification) else ()
    return replace(plan, status=status, message=str(error), stage=error.stage or "plan", choices=choices)
