"""What happened: reports of the robot, checks of the gate, verdicts, and the whole trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from wonderful_team.core.actions import Action
from wonderful_team.core.values.observation import Observation
from wonderful_team.core.values.plan import Plan, Provenance
from wonderful_team.core.values.request import Usage

NO_PLAN = ("not_found", "not_understood", "needs_clarification", "refused")
"""How a plan ends that nothing can run of, by the method's own word."""


@dataclass(frozen=True, eq=False)
class StepReport:
    """What a robot knows of one executed action: what it measured and any fault; never the score."""

    action: Action
    executed: bool
    measured: Mapping[str, Any] = field(default_factory=dict)
    fault: str | None = None

    @property
    def words(self) -> str:
        """How it went, in words."""
        if self.executed:
            return f"ran, with a fault: {self.fault}" if self.fault else "ran"
        return self.fault or "did not run, and the robot gave no reason"


@dataclass(frozen=True)
class Verdict:
    """The Replanner's word on one subgoal after execution."""

    subgoal: str
    status: Literal["done", "not_done", "undone", "unclear"]
    cause: str | None = None
    evidence: str = ""


@dataclass(frozen=True, eq=False)
class GateCheck:
    """One check of the safety gate with its margin; `ok` False refuses the action."""

    action: int | None
    name: str
    ok: bool
    value: str
    limit: str
    margin: str = ""


@dataclass(frozen=True, eq=False)
class GateReport:
    """All checks of one passage through the gate."""

    checks: tuple[GateCheck, ...]

    @property
    def admitted(self) -> bool:
        return all(check.ok for check in self.checks)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Every reason for a refusal, all at once, each once."""
        failed = (check for check in self.checks if not check.ok)
        return tuple(dict.fromkeys(_refusal(check) for check in failed))


def refusal_words(name: str, value: str, limit: str) -> str:
    """Why a check refused, in words, as every terminal, log and page says it."""
    return f"{name}: {value} (valid: {limit})"


def _refusal(check: GateCheck) -> str:
    where = f"action {check.action + 1}: " if check.action is not None else ""
    return where + refusal_words(check.name, check.value, check.limit)


@dataclass(frozen=True, eq=False)
class SubgoalRun:
    """Execution of one subgoal: pictures before and after, what the robot reported."""

    subgoal: str
    before: Observation
    after: Observation
    reports: tuple[StepReport, ...]


@dataclass(frozen=True, eq=False)
class Trial:
    """One attempt at one scene, whole.

    Attributes:
        outcome: success | failure | error | unscored.
        stage: Where it failed: plan | grounding | wrong object | gate | execution | budget | … ; None on success.
        seed: Of the scene; None for a photo or a real robot.
        judged: False when actions ran and neither a scorer nor the method judged what came of them.
    """

    scene: str
    seed: int | None
    method: str
    model: str
    plans: tuple[Plan, ...]
    gates: tuple[GateReport, ...]
    runs: tuple[SubgoalRun, ...]
    verdicts: tuple[Verdict, ...]
    outcome: Literal["success", "failure", "error", "unscored"]
    stage: str | None
    reason: str
    usage_by_role: Mapping[str, Usage] = field(default_factory=dict)
    provenance: tuple[Provenance, ...] = ()
    setting: Mapping[str, Any] = field(default_factory=dict)
    judged: bool = True

    @property
    def ending(self) -> str:
        """How it ended: the outcome, or the status of its last plan when it failed because no plan came of it."""
        status = self.plans[-1].status if self.plans else ""
        return status if self.outcome == "failure" and status in NO_PLAN else self.outcome

    @property
    def usage(self) -> Usage:
        return sum(self.usage_by_role.values(), Usage())

    @property
    def reports(self) -> tuple[StepReport, ...]:
        return tuple(report for run in self.runs for report in run.reports)
