"""Motion: actions one after another, each behind the gate, with a new picture after every subgoal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.geometry import Box
from wonderful_team.interfaces import Act, World
from wonderful_team.runtime.approval import Approval, Approver
from wonderful_team.runtime.course import Stage, stages_of
from wonderful_team.runtime.freshness import freshness_checks, touched, watched
from wonderful_team.runtime.gate import check_gate
from wonderful_team.runtime.progress import Ending, Progress
from wonderful_team.runtime.seen_checks import still_free_checks
from wonderful_team.text import counted
from wonderful_team.types import GateReport, Observation, Plan, PlannedAction, StepReport, SubgoalRun


class Execution:
    """Runs what a policy decided, in one world.

    Attributes:
        refusal: The report of the gate that refused the last run; None when it was admitted.
    """

    def __init__(
        self,
        world: World,
        progress: Progress,
        approval: Approval | Approver | None,
        max_age_s: float | None,
        read_plan: Plan | None,
    ) -> None:
        self._world = world
        self._progress = progress
        self._approval = approval
        self._max_age_s = max_age_s
        self._read_plan = read_plan
        self.refusal: GateReport | None = None

    def run(
        self, decision: Act, then: Observation | None, horizon: int | None, *, expected: Plan | None
    ) -> Ending | None:
        """Gate and execute; None when all actions ran, else why not. `final` when no further attempt makes sense."""
        self.refusal = None
        now = self._world.observe()
        report = self._gate(decision, then, now, expected)
        self._progress.passed_gate("before motion", report)
        if not report.admitted:
            self.refusal = report
            return Ending("failure", "gate", "refused by the safety gate: " + "; ".join(report.reasons))
        self._progress.observed("before", now)
        return self._run_all(decision, then or now, now, horizon)

    def _gate(self, decision: Act, then: Observation | None, now: Observation, expected: Plan | None) -> GateReport:
        def check(approval: Approval | None, required: bool) -> GateReport:
            return check_gate(
                decision.actions,
                vocabulary=self._world.vocabulary,
                limits=self._world.limits,
                plan=decision.plan,
                then=then,
                now=now,
                approval=approval,
                approval_required=required,
                expected_plan_id=expected.id if expected is not None else None,
                must_run=True,
                max_age_s=self._max_age_s,
            )

        if not callable(self._approval):
            return check(self._approval, self._approval is not None)
        report = check(None, False)
        if not report.admitted:
            return report
        # Nobody is asked to approve what would be refused anyway.
        return check(self._approval(decision.plan, decision.actions, report), True)

    def _run_all(self, decision: Act, then: Observation, now: Observation, horizon: int | None) -> Ending | None:
        actions, plan = decision.actions, decision.plan
        excused: list[Box] = []
        stages = stages_of(actions, plan, now.main, self._world.limits)
        last = before = now
        reports: list[StepReport] = []
        for index, planned in enumerate(actions):
            if horizon is not None and self._progress.executed >= horizon:
                self._close(actions[index - 1], before, last, reports)
                return Ending(
                    None, "execution", f"the world's horizon of {counted(horizon, 'action')} is reached", final=True
                )
            if index > 0 and not self._still_fresh(planned, index, plan, then, last, excused, stages[index]):
                self._close(actions[index - 1], before, last, reports)
                return Ending("failure", "gate", "; ".join(self._refused().reasons))
            report = self._execute(planned, before, reports)
            seen = self._world.observe()
            excused += touched(planned, plan, last.main, seen.main)
            last = seen
            ends = index + 1 == len(actions) or actions[index + 1].step.subgoal != planned.step.subgoal
            if ends or not report.executed:
                self._close(planned, before, last, reports)
                before, reports = last, []
            if not report.executed:
                return Ending(
                    None, "execution", f"action {index + 1} did not run: {report.fault or 'the robot gave no reason'}"
                )
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
        return report

    def _still_fresh(
        self,
        planned: PlannedAction,
        index: int,
        plan: Plan | None,
        then: Observation,
        last: Observation,
        excused: Sequence[Box],
        stage: Stage,
    ) -> bool:
        """Compare with the plan's picture outside of what the plan itself changed, and with the last step's picture.

        What depth shows now decides whether the place is still free: an action before may have left something there.
        """
        now = self._world.observe()
        regions = watched((planned,), plan, now.main, first=index)
        checks = freshness_checks(then, now, regions, excused=excused, max_age_s=self._max_age_s)
        checks += freshness_checks(last, now, regions, max_age_s=self._max_age_s)
        found = still_free_checks(planned, stage, now.main, self._world.limits)
        report = GateReport((*checks, *(replace(check, action=index) for check in found)))
        self._progress.passed_gate(f"before action {index + 1}", report)
        self.refusal = None if report.admitted else report
        return report.admitted

    def _refused(self) -> GateReport:
        assert self.refusal is not None
        return self.refusal

    def _close(
        self, planned: PlannedAction, before: Observation, after: Observation, reports: Sequence[StepReport]
    ) -> None:
        if reports:
            run = SubgoalRun(planned.step.subgoal, before, after, tuple(reports))
            self._progress.observed(f"after {planned.step.subgoal}", after)
            self._progress.ran_subgoal(run)
