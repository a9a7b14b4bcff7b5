"""Motion: actions one after another, each behind the gate, with a new picture after every subgoal."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeAlias

from wonderful_team.core import deadline
from wonderful_team.core.actions import Gripper, Home, HomeStep, OpenStep
from wonderful_team.core.geometry import Box
from wonderful_team.core.protocols import Act, World
from wonderful_team.core.text import counted
from wonderful_team.core.values import (
    GOING_HOME,
    GateReport,
    Observation,
    Plan,
    PlannedAction,
    ReadPlan,
    StepReport,
    SubgoalRun,
    file_hash,
)
from wonderful_team.errors import ConfigError
from wonderful_team.runtime.approval import Approval, Approver, Declined, Proposal
from wonderful_team.runtime.expected import Expectations
from wonderful_team.runtime.gate import check_gate
from wonderful_team.runtime.read_plan_checks import read_plan_checks
from wonderful_team.runtime.rollout_log import RolloutEnd, RolloutLog
from wonderful_team.runtime.seen_checks import still_free_checks
from wonderful_team.runtime.stage import Stage
from wonderful_team.runtime.staleness import staleness_checks, touched, watched

LIFTED_M = 0.005
"""What the fingers hold was not lifted while they are no farther than this from where they closed [m]."""
Check: TypeAlias = Callable[[SubgoalRun, tuple[str, ...]], str]
"""Asked after a subgoal with what the plan did not expect: why to stop there, or ""."""


class Execution:
    """Runs what a policy decided, in one world.

    Args:
        world: Where it runs.
        progress: Is told.
        approval: Consent to one plan, or whom to ask for it.
        max_age_s: Oldest picture that may be acted upon [s]; None for no limit.
        page: Writes the page that a person reads before she is asked; None where nothing is recorded.
        strict: Refuse a plan that was read beforehand and that Verification did not approve.

    Attributes:
        refusal: The report of the gate that refused the last run; None when it was admitted.
        declined: What a person said instead of her consent to the last run; None when she was not asked, or agreed.
    """

    def __init__(
        self,
        world: World,
        progress: RolloutLog,
        approval: Approval | Approver | None,
        max_age_s: float | None,
        page: Callable[[], Path | None] | None = None,
        strict: bool = False,
    ) -> None:
        self._world = world
        self._progress = progress
        self._approval = approval
        self._max_age_s = max_age_s
        self._page = page
        self._strict = strict
        self._age_limit_s: float | None = None
        self._again = False
        self._in_view = False
        self._stages: list[Stage] = []
        self.refusal: GateReport | None = None
        self.declined: Declined | None = None

    def run(
        self,
        decision: Act,
        then: Observation | None,
        horizon: int | None,
        *,
        read: ReadPlan | None = None,
        again: bool = False,
        check: Check | None = None,
    ) -> RolloutEnd | None:
        """Gate and execute; None when all actions ran, else why not. `final` when no further attempt makes sense.

        Args:
            decision: What the policy wants to run.
            then: The picture that it was made from; None when that is not at hand.
            horizon: The world's limit on actions, over the whole run.
            read: The plan that was read beforehand, if this is where it has to run: it runs, or nothing does.
            again: Whether the policy may plan anew: an arm that failed is then brought out of the picture, but never where a
                plan was read, of which exactly its actions run.
            check: Asked after every subgoal but the last, where the policy may plan anew and no plan was read.
        """
        self.refusal = self.declined = None
        self._again = again and read is None
        self._age_limit_s = self._max_age_s if read is None or read.same_clock else None
        now, report = self._gate(decision, then, read)
        self._progress.passed_gate("before motion", report)
        if not report.admitted:
            self.refusal = report
            return self._refused_ending(report, read)
        self._progress.observed("before", now)
        return self._run_all(decision, then or now, now, horizon, read, check if self._again else None)

    def _refused_ending(self, report: GateReport, read: ReadPlan | None) -> RolloutEnd:
        if self.declined is not None and not (self.declined.because and read is None):
            by = f" ({self.declined.by})" if self.declined.by else ""
            why = f": {self.declined.because}" if self.declined.because else ""
            return RolloutEnd("failure", "gate", f"you declined{by}{why}; nothing moved", final=True)
        # A consent that was given beforehand is to one plan: no other plan could be admitted.
        final = read is not None or (isinstance(self._approval, Approval) and _only_consent(report))
        reason = "refused by the safety gate: " + "; ".join(report.reasons)
        return RolloutEnd("failure", "gate", reason, final=final)

    def _gate(self, decision: Act, then: Observation | None, read: ReadPlan | None) -> tuple[Observation, GateReport]:
        """The scene just before motion, and what the gate says."""
        if not callable(self._approval):
            page = read.page_hash if read is not None else ""
            return self._check(decision, then, read, self._approval, page)
        now, report = self._check(decision, then, read, None, "")
        if not report.admitted:
            # Nobody is asked to approve what would be refused anyway.
            return now, report
        self._progress.passed_gate("before the question", report)
        page_file = self._page() if self._page is not None else None
        picture = (then or now).hash
        proposal = Proposal(decision.plan, decision.actions, report, picture, page_file)
        answer = deadline.bounded("the question whether the plan may run", self._approval, proposal)
        said = Declined() if answer is None else answer
        if not isinstance(said, Approval | Declined):
            raise ConfigError(
                f"the approval function returned a {type(said).__name__}; valid: proposal.approve(by), "
                "proposal.decline(by, because) or None"
            )
        self.declined = said if isinstance(said, Declined) else None
        # The scene may have changed while she was reading: it is looked at again.
        return self._check(decision, then, read, said, file_hash(page_file))

    def _check(
        self,
        decision: Act,
        then: Observation | None,
        read: ReadPlan | None,
        approval: Approval | Declined | None,
        page: str,
    ) -> tuple[Observation, GateReport]:
        now, self._stages = self._world.observe(), []
        report = deadline.bounded(
            "the safety gate",
            partial(
                check_gate,
                decision.actions,
                vocabulary=self._world.vocabulary,
                limits=self._world.limits,
                plan=decision.plan,
                then=then,
                now=now,
                approval=approval,
                page=page,
                expected_plan_id=read.plan.id if read is not None else None,
                must_run=True,
                max_age_s=self._age_limit_s,
                stages=self._stages,
            ),
        )
        if read is None:
            return now, report
        read_checks = read_plan_checks(read, self._world.instruction, now, self._strict)
        return now, replace(report, checks=(*read_checks, *report.checks))

    def _run_all(
        self,
        decision: Act,
        then: Observation,
        now: Observation,
        horizon: int | None,
        read: ReadPlan | None,
        check: Check | None,
    ) -> RolloutEnd | None:
        actions, plan = decision.actions, decision.plan
        expected_change: list[Box] = []
        stages, self._stages = self._stages, []
        last = before = now
        reports: list[StepReport] = []
        expected = None if plan is None else Expectations(actions, plan, now, self._in_view)
        for index, planned in enumerate(actions):
            if horizon is not None and self._progress.executed >= horizon:
                self._close(actions[index - 1], before, last, reports)
                return RolloutEnd(
                    None, "execution", f"the world's horizon of {counted(horizon, 'action')} is reached", final=True
                )
            if index > 0 and not self._still_fresh(planned, index, plan, then, last, expected_change, stages[index]):
                self._close(actions[index - 1], before, last, reports)
                return RolloutEnd("failure", "gate", "; ".join(self._refused().reasons), final=read is not None)
            report = self._execute(planned, before, reports)
            seen = self._world.observe()
            if index + 1 < len(actions):
                expected_change += touched(planned, plan, last.main, seen.main)
            last = seen
            ends = index + 1 == len(actions) or actions[index + 1].step.subgoal != planned.step.subgoal
            if not report.executed:
                last = self._out_of_sight(planned, before, last, reports)
            if ends or not report.executed:
                run = self._close(planned, before, last, reports)
                before, reports = last, []
            if not report.executed:
                return RolloutEnd(
                    None, "execution", f"action {index + 1} did not run: {report.fault or 'the robot gave no reason'}"
                )
            if ends and check is not None and index + 1 < len(actions):
                doubts = expected.doubts(run, actions[index + 1 :], self._in_view) if expected is not None else ()
                stop = check(run, doubts)
                if stop:
                    self._leave(planned, last)
                    return RolloutEnd(None, "execution", f"stopped after {run.subgoal}: {stop}")
        return None

    def _execute(self, planned: PlannedAction, before: Observation, reports: list[StepReport]) -> StepReport:
        assert planned.action is not None, "the gate admits only actions in metres"
        try:
            report = self._world.execute(planned.action)
        except BaseException as error:
            # The part that ran stays in the record.
            report = StepReport(planned.action, False, fault=f"{type(error).__name__}: {error}")
            self._progress.ran_action(planned, report)
            self._progress.ran_subgoal(SubgoalRun(planned.step.subgoal, before, before, (*reports, report)))
            raise
        self._progress.ran_action(planned, report)
        reports.append(report)
        # Where an arm can go home, it stands before the scene until it does.
        self._in_view = Home.kind in self._world.vocabulary.kinds and not isinstance(planned.action, Home)
        return report

    def _leave(self, planned: PlannedAction, last: Observation) -> None:
        """Home after a subgoal at which a plan is stopped, where the arm is not there; told as more of that subgoal."""
        reports: list[StepReport] = []
        after = self._out_of_sight(planned, last, last, reports)
        if reports:
            self._close(planned, last, after, reports)

    def _out_of_sight(
        self, failed: PlannedAction, before: Observation, last: Observation, reports: list[StepReport]
    ) -> Observation:
        """Home with an empty hand where the plan ends early, through the gate like everything else: from there the whole scene is seen.

        What came to lie on something on its way down is let go of there, and so is what was gripped and could not be lifted. Where a
        person consents to plans, nothing moves that she has not read; whatever else is held stays where it is.
        """
        kinds = self._world.vocabulary.kinds
        lies = bool(reports) and (_lies_on_something(reports[-1]) or _never_lifted(reports))
        idle = last.robot is not None and (lies or not last.robot.holding) and not isinstance(failed.action, Home)
        if not (self._again and idle and self._approval is None and Home.kind in kinds):
            return last
        subgoal = failed.step.subgoal
        opened = PlannedAction(OpenStep(subgoal), Gripper("open"))
        leaving = (*((opened,) if lies else ()), PlannedAction(HomeStep(subgoal), Home()))
        report = check_gate(
            leaving,
            vocabulary=self._world.vocabulary,
            limits=self._world.limits,
            plan=None,
            then=None,
            now=last,
            must_run=True,
            max_age_s=self._age_limit_s,
        )
        self._progress.passed_gate(GOING_HOME, report)
        if not report.admitted:
            return last
        for planned in leaving:
            if not self._execute(planned, before, reports).executed:
                break
        return self._world.observe()

    def _still_fresh(
        self,
        planned: PlannedAction,
        index: int,
        plan: Plan | None,
        then: Observation,
        last: Observation,
        expected_change: Sequence[Box],
        stage: Stage,
    ) -> bool:
        """Compare with the plan's picture outside of what the plan itself changed, and with the last step's picture.

        What depth shows now decides whether the place is still free: an action before may have left something there.
        """
        now = self._world.observe()
        regions = watched((planned,), plan, now.main, first=index)
        checks = staleness_checks(then, now, regions, expected_change=expected_change, max_age_s=self._age_limit_s)
        checks += staleness_checks(last, now, regions, max_age_s=self._max_age_s)
        found = still_free_checks(stage, now.main, self._world.limits)
        report = GateReport((*checks, *(replace(check, action=index) for check in found)))
        self._progress.passed_gate(f"before action {index + 1}", report)
        self.refusal = None if report.admitted else report
        return report.admitted

    def _refused(self) -> GateReport:
        assert self.refusal is not None
        return self.refusal

    def _close(
        self, planned: PlannedAction, before: Observation, after: Observation, reports: Sequence[StepReport]
    ) -> SubgoalRun:
        run = SubgoalRun(planned.step.subgoal, before, after, tuple(reports))
        if reports:
            self._progress.observed(f"after {planned.step.subgoal}", after)
            self._progress.ran_subgoal(run)
        return run


def _lies_on_something(report: StepReport) -> bool:
    """Whether an arm was stopped on its way down as what it holds touched something."""
    told = report.measured
    return not report.executed and bool(told.get("holding")) and told.get("stopped_by") == "contact"


def _never_lifted(reports: Sequence[StepReport]) -> bool:
    """Whether what an arm holds stands where it was gripped: it may be jammed, or heavier than it looks."""
    last = reports[-1].measured
    close = next(
        (one for one in reversed(reports) if isinstance(one.action, Gripper) and one.action.state == "close"), None
    )
    gripped_m, now_m = (None if close is None else close.measured.get("tool_m")), last.get("tool_m")
    if reports[-1].executed or not last.get("holding") or gripped_m is None or now_m is None:
        return False
    return math.dist(gripped_m, now_m) <= LIFTED_M


def _only_consent(report: GateReport) -> bool:
    """Whether nothing but the consent is missing."""
    failed = [check.name for check in report.checks if not check.ok]
    return all(name.startswith("approv") for name in failed)
