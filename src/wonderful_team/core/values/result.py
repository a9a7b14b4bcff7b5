"""What happened: reports of the robot, checks of the gate, verdicts, and the whole trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from wonderful_team.core.actions import Action
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values.observation import Observation
from wonderful_team.core.values.plan import Plan, Provenance
from wonderful_team.core.values.request import Usage

NO_PLAN = ("not_found", "not_understood", "needs_clarification", "refused")
"""How a plan ends that nothing can run of, by the method's own word."""
GOING_HOME = "before going home"
"""Where the gate stands for an arm that leaves the picture where a plan ends early."""


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
class HeightProfile:
    """The tool's way in one action over what depth shows, as the gate checked it.

    Attributes:
        action: Which one, from 0.
        points_m: Of the tool, from where the action begins, straight in between, shape (N, 3) [m], base frame.
        low_m: Lowest point of what passes there, the tool or what it carries, shape (N,) [m].
        surface_m: Highest of what is seen there and has to be cleared, shape (N,) [m]; NaN where nothing is, or not looked for.
        goal_m: Highest of what the action is meant to touch there, shape (N,) [m]; NaN where nothing is.
        clearance_m: Smallest distance from what passes down to what is seen [m]: the number of the gate's check; None where
            nothing is seen.
        least_m: How small it may be [m]; None where nothing is seen.
        nearest: At which of the points it is; None where nothing is seen.
        stays: Whether the tool stands at the last of the points afterwards; the end of picking and placing is the world's own doing.
    """

    action: int
    points_m: Array
    low_m: Array
    surface_m: Array
    goal_m: Array
    clearance_m: float | None = None
    least_m: float | None = None
    nearest: int | None = None
    stays: bool = False

    def __post_init__(self) -> None:
        for name, shape in (("points_m", (None, 3)), ("low_m", (None,)), ("surface_m", (None,)), ("goal_m", (None,))):
            array = np.array(getattr(self, name), dtype=np.float64)
            if (
                array.ndim != len(shape)
                or (shape[-1] and array.shape[-1] != shape[-1])
                or len(array) != len(self.low_m)
            ):
                raise ValueError(f"{name}: expected one row for each of {len(self.low_m)} points, got {array.shape}")
            array.setflags(write=False)
            object.__setattr__(self, name, array)


@dataclass(frozen=True, eq=False)
class GateReport:
    """All checks of one passage through the gate.

    Attributes:
        checks: In the order of the actions.
        profiles: The tool's way in every action that has one in metres.
    """

    checks: tuple[GateCheck, ...]
    profiles: tuple[HeightProfile, ...] = ()

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
