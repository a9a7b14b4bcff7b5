"""What has happened so far in a rollout; tells subscribers and becomes the Trial."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from wonderful_team.core.protocols import (
    CHECK,
    JUDGE,
    Act,
    Checked,
    Decision,
    Event,
    Policy,
    Situation,
    Subscriber,
    World,
    offers,
)
from wonderful_team.core.values import (
    GateReport,
    Observation,
    Plan,
    PlannedAction,
    StepReport,
    SubgoalRun,
    Trial,
    Verdict,
)
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.runtime.optional import Accounting, Configured, NamedModel, Sourced


@dataclass(frozen=True)
class RolloutEnd:
    """How it ended. `outcome` None leaves the word to the scorer; `final` forbids another attempt."""

    outcome: Literal["success", "failure", "error", "unscored"] | None
    stage: str | None
    reason: str
    final: bool = False


@dataclass
class RolloutLog:
    """Collects the parts of a Trial while it runs."""

    policy: Policy
    scene: str
    seed: int | None
    subscribers: Sequence[Subscriber]
    plans: list[Plan] = field(default_factory=list)
    gates: list[GateReport] = field(default_factory=list)
    runs: list[SubgoalRun] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    executed: int = 0
    last: Decision | None = None
    _before_attempt: int = field(default=0, init=False)
    """Verdicts on the attempts before the one that runs."""

    def tell(self, kind: str, name: str, content: Any = None) -> None:
        for subscriber in self.subscribers:
            subscriber.on_event(Event(kind, name, content))

    def observe(self, world: World, where: str) -> Observation:
        """Look, and tell."""
        observation = world.observe()
        self.observed(where, observation)
        return observation

    def observed(self, where: str, observation: Observation) -> None:
        self.tell("observe", where, observation)

    def asking(self, situation: Situation, *, check: bool = False) -> None:
        """Note what a method is told beside pictures and reports, so that it can be asked so again."""
        told: dict[str, Any] = {
            "attempt": situation.attempt,
            "replans_left": situation.replans_left,
            "looks_left": situation.reobserve_left,
        }
        if situation.advice:
            told["advice"] = situation.advice
        if check:
            told |= {"check": True, "doubts": list(situation.doubts)}
        self.tell("asking", f"attempt {situation.attempt}", told)

    def decided(self, decision: Decision) -> None:
        """Note a decision and what it carries."""
        self.last = decision
        name = type(decision).__name__
        again = {"again": True} if getattr(decision, "again", False) else {}
        self.tell("decision", name, {"decision": name, "reason": getattr(decision, "reason", ""), **again})
        self._judged(JUDGE, tuple(getattr(decision, "verdicts", ())))
        if isinstance(decision, Act):
            self._before_attempt = len(self.verdicts)
            if decision.plan is not None:
                self.add_plan(decision.plan)

    def checked(self, checked: Checked) -> None:
        """Note what a method says after a subgoal, whether it goes on or not."""
        self.tell("decision", "Checked", {"decision": "Checked", "reason": checked.stop})
        self._judged(CHECK, checked.verdicts)

    def _judged(self, name: str, verdicts: tuple[Verdict, ...]) -> None:
        if not verdicts:
            return
        if name == JUDGE:
            # A judgement of the whole attempt takes the place of what was said of its subgoals while it ran.
            del self.verdicts[self._before_attempt :]
        self.verdicts += verdicts
        self.tell("verdicts", name, verdicts)

    def traced(self, error: WonderfulTeamError) -> None:
        """Tell the traceback of the user's own code, where that is what failed."""
        if error.trace:
            self.tell("crash", type(error).__name__, error)

    def add_plan(self, plan: Plan) -> None:
        if all(plan.id != known.id for known in self.plans):
            self.plans.append(plan)
            self.tell("plan", plan.id, plan)

    def passed_gate(self, where: str, report: GateReport) -> None:
        self.gates.append(report)
        self.tell("gate", where, report)

    def ran_action(self, planned: PlannedAction, report: StepReport) -> None:
        self.executed += 1
        self.tell("execute", str(self.executed), (planned, report))

    def ran_subgoal(self, run: SubgoalRun) -> None:
        self.runs.append(run)
        self.tell("subgoal", run.subgoal, run)

    @property
    def unasked(self) -> bool:
        """Whether actions were the method's last word: it was not asked what came of them."""
        return isinstance(self.last, Act)

    def finish(self, ending: RolloutEnd) -> Trial:
        """The trial as it stands; told to subscribers as the last event."""
        policy = self.policy
        trial = Trial(
            scene=self.scene,
            seed=self.seed,
            method=policy.name,
            model=policy.model_name if offers(policy, NamedModel) else "",
            plans=tuple(self.plans),
            gates=tuple(self.gates),
            runs=tuple(self.runs),
            verdicts=tuple(self.verdicts),
            outcome=ending.outcome or "unscored",
            stage=ending.stage,
            reason=ending.reason,
            judged=ending.outcome not in (None, "unscored") or not self.unasked,
            usage_by_role=dict(policy.usage_by_role) if offers(policy, Accounting) else {},
            provenance=tuple(policy.provenance) if offers(policy, Sourced) else (),
            setting=dict(policy.setting) if offers(policy, Configured) else {},
        )
        self.tell("done", trial.outcome, trial)
        return trial
