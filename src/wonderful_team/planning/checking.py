"""After a subgoal, while others are still to run: what became of it, and is the rest of the plan still worth running?

What the robot measured and what a comparison of the pictures shows costs nothing and comes first. `team` asks the Replanner where
that leaves a doubt, `thorough` after every subgoal. `team:paper` asks nothing here: the paper judges a whole attempt (its Replanning
Agent is "designed to address failures post-execution", and finding errors at once is named as future work).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents import step_words
from wonderful_team.agents.plan_drawn import mark_targets
from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.contracts import JudgeSubgoal, SubgoalOutcome
from wonderful_team.core.actions import Gripper, Home, PickPlace, RotateGripper
from wonderful_team.core.protocols import Checked, Situation
from wonderful_team.core.steps import carried_by
from wonderful_team.core.values import Plan, StepReport, SubgoalRun, Verdict
from wonderful_team.planning.judging import judge_outcome, measured_lines
from wonderful_team.planning.session import AgentSession

AS_EXPECTED = "the robot reports no fault, and a comparison of the pictures shows nothing that speaks against it"
NOT_BEGUN = "the plan was stopped before it"


class SubgoalChecks:
    """The checks of one plan while it runs.

    Attributes:
        stopped: Why it was stopped; "" where it was not.
    """

    def __init__(self) -> None:
        self.stopped = ""
        self._known: dict[str, Verdict] = {}

    @property
    def known(self) -> tuple[Verdict, ...]:
        """What was said of the subgoals so far."""
        return tuple(self._known.values())

    async def check(self, session: AgentSession, scene: SceneShown, plan: Plan, situation: Situation) -> Checked:
        """A verdict on the subgoal that ran last, and why to stop there, if at all. `scene` is the one the plan was made from."""
        run = situation.executed[-1]
        if session.config.sparing and not situation.doubts:
            verdict, self.stopped = Verdict(run.subgoal, "done", None, AS_EXPECTED), ""
            session.stage("check", f"{run.subgoal} as expected, nothing asked")
        else:
            outcome: SubgoalOutcome = await session.ask(_question(scene, plan, run, situation.doubts), stage="replan")
            verdict, self.stopped = outcome.to_verdict(run.subgoal), outcome.stop
            said = f"stopped: {outcome.stop}" if outcome.stop else "goes on"
            session.stage("check", f"{run.subgoal} {outcome.status.replace('_', ' ')}; {said}")
        self._known[run.subgoal] = verdict
        return Checked((verdict,), self.stopped)

    async def verdicts(
        self, session: AgentSession, scene: SceneShown, plan: Plan, situation: Situation
    ) -> tuple[Verdict, ...]:
        """A verdict on every subgoal after an attempt: asked, but where it was stopped, or the robot measured that it failed."""
        settled = stopped_verdicts(plan, self._known, self.stopped) if self.stopped else None
        if settled is None and session.config.sparing:
            settled = measured_verdicts(plan, situation.executed, self._known)
        if settled is not None:
            return settled
        return await judge_outcome(session, scene, plan, situation.observation, situation.executed)


def _question(scene: SceneShown, plan: Plan, run: SubgoalRun, doubts: tuple[str, ...]) -> JudgeSubgoal:
    before = replace(scene, observation=run.before)
    names = [subgoal.id for subgoal in plan.subgoals]
    first = names.index(run.subgoal) if run.subgoal in names else 0
    own = plan.subgoals[first]
    # A thing that an earlier subgoal carried does not lie in its box any more.
    moved = {carried_by([step for step in plan.steps if step.subgoal == name]) for name in names[:first]}
    used = {name for subgoal in plan.subgoals[first:] for name in subgoal.targets} - moved
    boxed = {name: item for name, item in plan.grounded.items() if name in used}
    after = show_views(run.after, " after")
    return JudgeSubgoal(
        replace(before.task, views=(mark_targets(before.views[0], scene.view, boxed), *before.views[1:])),
        own,
        plan.subgoals,
        plan.targets,
        tuple(step_words(step) for step in plan.steps if step.subgoal == run.subgoal),
        (mark_targets(after[0], scene.view, boxed), *after[1:]),
        measured_lines([run]),
        doubts,
    )


def stopped_verdicts(plan: Plan, known: Mapping[str, Verdict], stop: str) -> tuple[Verdict, ...]:
    """A verdict on every subgoal of a plan that was stopped, from those on the subgoals that ran."""
    because, found = stop, []
    for subgoal in plan.subgoals:
        verdict = known.get(subgoal.id)
        if verdict is None:
            verdict = Verdict(subgoal.id, "not_done", f"{NOT_BEGUN}: {because}" if because else NOT_BEGUN)
        # The reason is told once: with the subgoal that was missed, else with the first that was not begun.
        because = because if verdict.status == "done" else ""
        found.append(verdict)
    return tuple(found)


def measured_verdicts(
    plan: Plan, executed: Sequence[SubgoalRun], known: Mapping[str, Verdict]
) -> tuple[Verdict, ...] | None:
    """A verdict on every subgoal where what the robot measured settles it: an action failed before anything was put down, whether the
    fingers lost it, never had it, or still hold it.

    None where it does not, such as after a fault on the way home, or where an earlier subgoal was not judged.
    """
    if not executed:
        return None
    run = executed[-1]
    failed = next((report for report in run.reports if not report.executed), None)
    before = [subgoal.id for subgoal in plan.subgoals]
    earlier = before[: before.index(run.subgoal)] if run.subgoal in before else before
    if failed is None or not _never_put(run.reports, failed) or not all(name in known for name in earlier):
        return None
    missed = Verdict(run.subgoal, "not_done", failed.words, "as the robot measured")
    return stopped_verdicts(plan, {**known, run.subgoal: missed}, "")


def _never_put(reports: Sequence[StepReport], failed: StepReport) -> bool:
    """Whether a subgoal carried nothing to where it belongs: its thing was not taken, lost on the way, or is held still."""
    match failed.action:
        case PickPlace():
            return failed.measured.get("held") is False
        case Home():
            return False
    holds = failed.measured.get("holding")
    gripped = carried = False
    for report in reports:
        if report is failed:
            break
        if isinstance(report.action, Gripper):
            if report.action.state == "open" and carried:
                return False
            gripped = report.action.state != "open"
        # A grip that lets go where it closed has put nothing down: it centres the fingers.
        carried = gripped and (carried or not isinstance(report.action, Gripper | RotateGripper))
    closing = isinstance(failed.action, Gripper) and failed.action.state != "open"
    return isinstance(holds, bool) and (gripped or closing)


def done_subgoals(plan: Plan, verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    """What the Supervisor is told before it plans anew: what the last plan reached, one line each."""
    done = {verdict.subgoal for verdict in verdicts if verdict.status == "done"}
    return tuple(f"'{subgoal.text}': reached, as judged" for subgoal in plan.subgoals if subgoal.id in done)
