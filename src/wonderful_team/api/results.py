"""What calls from Python return: a plan, a grounding or a trial, with its cost and its page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.notebook import card
from wonderful_team.core.text import counted, ending_words, picture_names, spoken
from wonderful_team.core.values import GateReport, Observation, Plan, PlannedAction, Subgoal, Target, Trial, Usage
from wonderful_team.errors import ActionRefusedError
from wonderful_team.runtime.approval import APPROVAL_S, Approval, Proposal

PAGE_NAME = "page.html"


@dataclass(frozen=True)
class FoundTarget:
    """A target with its place in the main picture; all coordinates are pixels of that picture.

    Attributes:
        status: found | absent | gave_up | not_grounded (planning stopped before it was looked for).
        box_px: (x0, y0, x1, y1), or None.
        points_px: Action points by role, such as pick and place.
    """

    id: str
    kind: str
    words: str
    status: str
    box_px: tuple[float, float, float, float] | None = None
    points_px: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def point_px(self) -> tuple[float, float] | None:
        """The first action point, or None."""
        return next(iter(self.points_px.values()), None)


@dataclass(frozen=True, eq=False)
class PlanResult:
    """A plan with what it cost and where its page lies.

    Attributes:
        plan: The whole plan.
        observation: What it was made from.
        gate: What the safety gate says of its actions; None when there are none.
        usage_by_role: Cost by role.
        seconds: How long planning took, on the wall clock.
        folder: The run folder; None when nothing was recorded.
        told: Warnings of the run beside those of the plan, as they were told while it ran.
        unwritten: Which files of the run folder could not be written, and why.
    """

    plan: Plan
    observation: Observation
    gate: GateReport | None = None
    usage_by_role: Mapping[str, Usage] = field(default_factory=dict)
    seconds: float = 0.0
    folder: Path | None = None
    told: tuple[str, ...] = ()
    unwritten: tuple[str, ...] = ()

    @property
    def id(self) -> str:
        return self.plan.id

    @property
    def status(self) -> str:
        """Planned | draft | checked | grounded | not_found | not_understood | needs_clarification | refused | budget | failed.

        refused: by Verification with `strict`, or by the safety gate; `message` says which and why.
        """
        return self.plan.status if self._admitted else "refused"

    @property
    def _admitted(self) -> bool:
        return self.gate is None or self.gate.admitted

    @property
    def message(self) -> str:
        """Why it ended so, in a sentence."""
        if self.gate is None or self.gate.admitted:
            return self.plan.message
        return str(ActionRefusedError(self.gate.reasons))

    @property
    def verified(self) -> bool:
        """Whether Verification approved it."""
        return self.plan.verified

    @property
    def choices(self) -> tuple[str, ...]:
        """What may be meant, when clarification is needed."""
        return self.plan.choices

    @property
    def warnings(self) -> tuple[str, ...]:
        """All that the user was warned of, each once."""
        return tuple(dict.fromkeys((*self.told, *self.plan.warnings)))

    @property
    def subgoals(self) -> tuple[Subgoal, ...]:
        return self.plan.subgoals

    @property
    def actions(self) -> tuple[PlannedAction, ...]:
        return self.plan.actions

    @property
    def targets(self) -> tuple[FoundTarget, ...]:
        """Every target, found or not, in the order of the plan."""
        return tuple(_found(target, self.plan) for target in self.plan.targets)

    @property
    def usage(self) -> Usage:
        """Calls, pictures, tokens, money and seconds over all roles."""
        return sum(self.usage_by_role.values(), Usage())

    @property
    def page(self) -> Path | None:
        """The run's page."""
        return None if self.folder is None else self.folder / PAGE_NAME

    def approve(self, by: str, note: str = "", valid_s: float = APPROVAL_S) -> Approval:
        """Consent to run exactly this plan, made from this picture, as its page shows it now.

        Args:
            by: Who approves.
            note: What they say, if anything.
            valid_s: How long the consent holds [s].
        """
        gate = self.gate or GateReport(())
        return Proposal(self.plan, self.actions, gate, self.observation.hash, self.page).approve(by, note, valid_s)

    def to_json(self) -> dict[str, Any]:
        """A JSON-ready summary; the whole plan stands in the run folder's plan.json."""
        return {
            "plan_id": self.id,
            "status": self.status,
            "message": self.message,
            "choices": list(self.choices),
            "verified": self.verified,
            "subgoals": to_jsonable(self.subgoals),
            "targets": [target_json(target) for target in self.targets],
            "actions": to_jsonable(self.actions),
            "questions": to_jsonable(self.plan.questions),
            "gate": None if self.gate is None else {"admitted": self.gate.admitted, "reasons": list(self.gate.reasons)},
            "warnings": list(self.warnings),
            **cost_json(self.usage, self.usage_by_role, self.folder),
            "seconds": round(self.seconds, 3),
        }

    def _repr_html_(self) -> str:
        """In a notebook: the picture of the plan, how it ended, its targets."""
        from wonderful_team.images import action_arrows, action_turns, overview

        names = picture_names(self.plan.instruction.text, self.plan.instruction.slots)
        lines = [self.message] if self.message else []
        lines += [f"{goal.id}  {goal.text}" for goal in self.subgoals]
        lines += [f"{target.id}  {target.words}  {target.status.replace('_', ' ')}" for target in self.targets]
        if self.gate is not None and not self.gate.admitted:
            lines += [f"refused by the safety gate: {reason}" for reason in self.gate.reasons]
        drawn = overview(
            self.observation.main,
            self.plan.grounded,
            names=names,
            arrows=action_arrows(self.actions),
            turns=action_turns(self.actions, self.plan.grounded, self.observation.main),
            keep_out=self.plan.keep_out,
        )
        spent = f"{counted(self.usage.calls, 'call')}, {self.seconds:.1f} s"
        lines += [spent if self.page is None else f"{spent}   page: {self.page}"]
        title = f"{self.status.replace('_', ' ')}: {self.plan.instruction.plain_text}"
        return card(title, [spoken(line, names) for line in lines], [(drawn, counted(len(self.actions), "action"))])


@dataclass(frozen=True, eq=False)
class TrialResult(Trial):
    """A trial that knows its run folder, what the user was warned of, and which of its files could not be written and why."""

    folder: Path | None = None
    warnings: tuple[str, ...] = ()
    unwritten: tuple[str, ...] = ()

    @property
    def page(self) -> Path | None:
        """The run's page."""
        return None if self.folder is None else self.folder / PAGE_NAME

    def _repr_html_(self) -> str:
        """In a notebook: outcome, before and after, what became of each subgoal."""
        ending, reason = ending_words(self.ending, self.reason)
        stage = f" at {self.stage}" if self.stage and self.ending == self.outcome else ""
        said = self.plans[-1].instruction if self.plans else None
        names = {} if said is None else picture_names(said.text, said.slots)
        lines = [] if said is None else [said.plain_text]
        lines += [f"{one.subgoal}  {one.status.replace('_', ' ')}  {one.cause or ''}".rstrip() for one in self.verdicts]
        executed = sum(report.executed for report in self.reports)
        lines += [f"{counted(len(self.plans), 'plan')}, {counted(executed, 'action')} executed"]
        lines += [] if self.page is None else [f"page: {self.page}"]
        ends = [(self.runs[0].before, "before"), (self.runs[-1].after, "after")] if self.runs else []
        pictures = [(seen.main.rgb, name) for seen, name in ends]
        title = spoken(f"{ending}{stage}: {reason}", names)
        return card(title, [spoken(line, names) for line in lines], pictures)


def target_json(target: FoundTarget) -> dict[str, Any]:
    """A target as JSON."""
    return {
        "id": target.id,
        "kind": target.kind,
        "words": target.words,
        "status": target.status,
        "box_px": to_jsonable(target.box_px),
        "points_px": to_jsonable(target.points_px),
    }


def cost_json(usage: Usage, by_role: Mapping[str, Usage], folder: Path | None) -> dict[str, Any]:
    """Cost and place of a run as JSON."""
    return {
        "usage": to_jsonable(usage),
        "usage_by_role": {role: to_jsonable(spent) for role, spent in by_role.items()},
        "folder": None if folder is None else str(folder),
        "page": None if folder is None else str(folder / PAGE_NAME),
    }


def _found(target: Target, plan: Plan) -> FoundTarget:
    grounded = plan.grounded.get(target.id)
    if grounded is None:
        return FoundTarget(target.id, target.kind, target.words, "not_grounded")
    box = None if grounded.box is None else grounded.box.as_tuple
    return FoundTarget(target.id, target.kind, target.words, grounded.status, box, dict(grounded.points))
