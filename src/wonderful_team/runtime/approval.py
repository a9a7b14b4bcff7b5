"""A person's consent to one exact plan."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from wonderful_team.jsonable import to_jsonable
from wonderful_team.types import GateReport, Plan, PlannedAction


@dataclass(frozen=True)
class Approval:
    """Consent to run the plan with this id and no other.

    Attributes:
        plan_id: `Plan.id`, or `actions_id(actions)` for a method that acts without a plan.
        by: Who approved.
        note: What they said, if anything.
    """

    plan_id: str
    by: str
    note: str = ""


Approver: TypeAlias = Callable[[Plan | None, Sequence[PlannedAction], GateReport], Approval | None]
"""Shown the plan (if any), its actions and the gate's checks so far; returns consent or None."""


def actions_id(actions: Sequence[PlannedAction]) -> str:
    """Hash of actions that come without a plan: 12 hex digits."""
    text = json.dumps(to_jsonable(tuple(actions)), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def approved_id(plan: Plan | None, actions: Sequence[PlannedAction]) -> str:
    """The id that an approval must name."""
    return plan.id if plan is not None else actions_id(actions)
