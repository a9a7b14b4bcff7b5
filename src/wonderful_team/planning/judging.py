"""After execution: the Replanner compares before and after, says what became of each subgoal, and gives advice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.agents import step_words
from wonderful_team.agents.plan_drawn import mark_targets
from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.contracts import Advice, JudgeOutcome, Outcome, Replan
from wonderful_team.core.values import Observation, Plan, StepReport, SubgoalRun, Verdict
from wonderful_team.planning.function_library import told as told_functions
from wonderful_team.planning.session import AgentSession


async def judge_outcome(
    session: AgentSession, scene: SceneShown, plan: Plan, now: Observation, executed: Sequence[SubgoalRun]
) -> tuple[Verdict, ...]:
    """A verdict per subgoal of the plan. `scene` is the one the plan was made from."""
    before = mark_targets(scene.views[0], scene.view, plan.grounded)
    task = replace(scene.task, views=(before, *scene.views[1:]))
    question = JudgeOutcome(
        task,
        plan.subgoals,
        plan.targets,
        tuple(step_words(step) for step in plan.steps),
        show_views(now, " after"),
        measured_lines(executed),
    )
    outcome: Outcome = await session.ask(question, stage="replan")
    verdicts = outcome.to_verdicts()
    session.stage("judge", ", ".join(f"{v.subgoal} {v.status.replace('_', ' ')}" for v in verdicts))
    return verdicts


def causes(verdicts: Sequence[Verdict]) -> str:
    """What is not done, and why, in one line."""
    return "; ".join(
        f"{v.subgoal} {v.status.replace('_', ' ')}: {v.cause or v.evidence}" for v in verdicts if v.status != "done"
    )


async def advise(
    session: AgentSession,
    scene_now: SceneShown,
    plan: Plan,
    verdicts: tuple[Verdict, ...],
    executed: Sequence[SubgoalRun],
    replans_left: int,
) -> Advice:
    """Whether to stop, and what the next plan should do differently."""
    known = told_functions(session.functions)
    question = Replan(scene_now.task, plan.subgoals, verdicts, measured_lines(executed), replans_left, known)
    advice: Advice = await session.ask(question, stage="replan")
    session.stage("replan", f"{advice.decision.replace('_', ' ')}: {advice.cause or 'all subgoals are done'}")
    return advice


def measured_lines(executed: Sequence[SubgoalRun]) -> tuple[str, ...]:
    """What the robot reported, one line per action."""
    return tuple(f"{run.subgoal}: {_measured(report)}" for run in executed for report in run.reports)


def _measured(report: StepReport) -> str:
    told = (_told(name, value) for name, value in report.measured.items())
    values = ", ".join(text for text in told if text)
    state = "executed" if report.executed else "not executed"
    fault = f", fault: {report.fault}" if report.fault else ""
    return f"{report.action.kind} {state}{': ' + values if values else ''}{fault}"


def _told(name: str, value: object) -> str:
    """One measured value in words and units that a picture is read with; "" for a position in the robot's own frame."""
    if name.endswith("_m") and isinstance(value, list | tuple):
        return ""
    words = name.replace("_", " ")
    if isinstance(value, float) and name.endswith("_m"):
        return f"{words[:-2]} = {100 * value:.1f} cm"
    if isinstance(value, float) and name.endswith("_rad"):
        return f"{words[:-4]} = {math.degrees(value):.0f} degrees"
    return f"{words} = {_short(value)}"


def _short(value: object) -> str:
    match value:
        case float():
            return f"{value:.3f}"
        case list() | tuple():
            return "(" + ", ".join(_short(item) for item in value) + ")"
        case _:
            return str(value)
