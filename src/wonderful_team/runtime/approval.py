"""A person's consent to one exact plan, and what she is shown before she gives it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from wonderful_team.core.values import GateCheck, GateReport, Plan, PlannedAction, content_hash, file_hash

APPROVAL_S = 600.0
"""How long a consent holds [s]: as long as the picture that was looked at may be acted upon."""


@dataclass(frozen=True)
class Approval:
    """Consent to run one plan and no other, as it was seen, for a while.

    Attributes:
        plan_id: `Plan.id`, or `actions_id(actions)` for a method that acts without a plan.
        by: Who approved.
        note: What they said, if anything.
        picture: Hash of the observation that the plan was made from.
        page: SHA-256 of the page that was read; "" where there is none.
        expires_s: Unix time after which it no longer holds [s].
    """

    plan_id: str
    by: str
    note: str = ""
    picture: str = ""
    page: str = ""
    expires_s: float = 0.0


@dataclass(frozen=True)
class Declined:
    """A person's no. With `because`, the method may make one new plan that heeds it, and she is asked again."""

    by: str = ""
    because: str = ""


@dataclass(frozen=True, eq=False)
class Proposal:
    """What a person is asked to approve.

    Attributes:
        plan: None for a method that acts without a plan.
        actions: What would run, in order.
        gate: The gate's checks so far; it has admitted the actions but for the consent.
        picture: Hash of the observation that the plan was made from.
        page: The page that shows it all, already written; None where nothing is recorded.
    """

    plan: Plan | None
    actions: Sequence[PlannedAction]
    gate: GateReport
    picture: str = ""
    page: Path | None = None

    @property
    def id(self) -> str:
        """What the approval must name."""
        return approved_id(self.plan, self.actions)

    def approve(self, by: str, note: str = "", valid_s: float = APPROVAL_S) -> Approval:
        """Consent to exactly this."""
        return Approval(self.id, by, note, self.picture, file_hash(self.page), time.time() + valid_s)

    def decline(self, by: str = "", because: str = "") -> Declined:
        """No; or "no, because …", which is advice for one new plan."""
        return Declined(by, because)


Approver: TypeAlias = Callable[[Proposal], Approval | Declined | None]
"""Asked before anything moves; None is a no."""


def actions_id(actions: Sequence[PlannedAction]) -> str:
    """SHA-256 of actions that come without a plan: 64 hex digits."""
    return content_hash(tuple(actions))


def approved_id(plan: Plan | None, actions: Sequence[PlannedAction]) -> str:
    """The id that an approval must name."""
    return plan.id if plan is not None else actions_id(actions)


def approval_checks(
    wanted_id: str, picture: str, page: str, approval: Approval | Declined | None, required: bool
) -> list[GateCheck]:
    """Whether the consent is to this plan, this picture and this page, by somebody, and still holds.

    Args:
        wanted_id: Of what would run.
        picture: Hash of the observation that it was made from.
        page: Hash of the page that shows it; "" where there is none.
        approval: What was said; None when nobody was asked or nobody answered.
        required: Refuse without consent.
    """
    if approval is None:
        return [_check("approval", False, "none", f"given for plan {wanted_id[:12]}")] if required else []
    if isinstance(approval, Declined):
        said = "declined" + (f" by {approval.by}" if approval.by else "")
        said += f", because {approval.because}" if approval.because else ""
        return [_check("approval", False, said, f"given for plan {wanted_id[:12]}")]
    by = approval.by.strip()
    left_s = approval.expires_s - time.time()
    shown = f"{left_s:.0f} s left" if left_s > 0 else f"expired {-left_s:.0f} s ago" if approval.expires_s else "no end"
    return [
        _check(
            "approval",
            approval.plan_id == wanted_id and bool(by),
            f"plan {approval.plan_id[:12] or 'none'} by {by or 'nobody'}",
            f"given for plan {wanted_id[:12]}, by a named person",
        ),
        _same("approved picture", approval.picture, picture),
        _same("approved page", approval.page, page),
        _check("approval still holds", left_s > 0, shown, "more than 0 s left"),
    ]


def _same(name: str, named: str, wanted: str) -> GateCheck:
    return _check(name, named == wanted, named[:12] or "none named", wanted[:12] or "none")


def _check(name: str, ok: bool, value: str, limit: str) -> GateCheck:
    return GateCheck(None, name, ok, value, limit)
