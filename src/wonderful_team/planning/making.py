"""One plan, from its draft over checks and grounding to its actions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.pictures import PathPoint
from wonderful_team.core.text import counted
from wonderful_team.core.together import both
from wonderful_team.core.values import GroundedTarget, Plan
from wonderful_team.errors import GeometryError, NotFoundError
from wonderful_team.planning import acting, endings, grounding, plan_loop
from wonderful_team.planning.functions import write_functions
from wonderful_team.planning.jobs import read_scene
from wonderful_team.planning.plan_loop import PlanState
from wonderful_team.planning.session import AgentSession

Until: TypeAlias = Literal["draft", "checked", "grounded", "actions"]
UNTIL: tuple[Until, ...] = ("draft", "checked", "grounded", "actions")


@dataclass
class Progress:
    """The best so far: what a bound or a cap leaves behind."""

    plan: Plan


async def make(
    session: AgentSession, scene: SceneShown, progress: Progress, until: Until, advice: tuple[str, ...]
) -> Plan:
    """A plan for a scene; what went wrong with it goes back to the Supervisor, within its bound.

    `progress` gets the best so far; `advice` is what went wrong before, or was said against the last plan.
    """
    absent: list[GroundedTarget] = []
    failed: GeometryError | NotFoundError | None = None
    last: PlanState | None = None
    asked = advice
    for turn in range(1 + session.config.bounds.returns):
        state = await plan_loop.draft(session, scene, advice)
        progress.plan = endings.with_state(progress.plan, state, "draft")
        if until == "draft":
            return progress.plan
        if until == "actions":
            state = await plan_loop.verify_where_needed(session, scene, state, failed=bool(advice))
        else:
            state = await plan_loop.verify(session, scene, state)
        progress.plan = endings.with_state(progress.plan, state, "checked")
        if _not_approved(session, state):
            return endings.refused(progress.plan, "plan")
        if until == "checked":
            return progress.plan
        state = await plan_loop.extract_targets(session, scene, state)
        if (absent and not endings.asks_anew(state, absent)) or (last is not None and endings.same_plan(state, last)):
            break
        progress.plan = endings.with_state(progress.plan, state, "checked")
        if not state.subgoals:
            return endings.nothing_to_do(progress.plan)
        try:
            plan, absent = await _carry_out(session, scene, progress, state, until)
        except GeometryError as error:
            failed, absent, last = error, [], state
            told: tuple[str, ...] = (f"The plan could not be carried out as it was written: {error}.",)
        else:
            if not absent:
                return plan
            failed, last = NotFoundError(endings.not_found(absent)), None
            told = tuple(endings.told_not_found(item) for item in absent)
        advice = (*asked, *told)
        if turn < session.config.bounds.returns:
            session.warn("; ".join(one.rstrip(".") for one in told) + ". The plan goes back to the Supervisor.")
    assert failed is not None
    try:
        raise failed
    finally:
        # An error holds this frame: they would hold each other in a circle, with all that was seen.
        failed = None


def _not_approved(session: AgentSession, state: PlanState) -> bool:
    """Whether a plan ends here, because nothing may run that Verification did not approve."""
    by_itself = state.reviewed or not session.config.members.verification
    return session.config.strict and by_itself and not state.verified


async def _carry_out(
    session: AgentSession, scene: SceneShown, progress: Progress, state: PlanState, until: Until
) -> tuple[Plan, list[GroundedTarget]]:
    """Ground a plan and write its actions; anew when its last check changed the plan itself."""
    while True:
        plan, absent, changed = await _ground_and_act(session, scene, progress, state, until)
        if changed is None:
            return plan, absent
        # Each change has used up a question, so this ends at their bound.
        state = await plan_loop.verify(session, scene, changed)
        progress.plan = endings.with_state(progress.plan, state, "checked")
        if _not_approved(session, state):
            return endings.refused(progress.plan, "plan"), []
        if not state.subgoals:
            return endings.nothing_to_do(progress.plan), []


async def _ground_and_act(
    session: AgentSession, scene: SceneShown, progress: Progress, state: PlanState, until: Until
) -> tuple[Plan, list[GroundedTarget], PlanState | None]:
    session.notebooks.begin_plan()
    jobs = grounding.make_jobs(session, scene, state.targets, state.subgoals)
    lean = session.config.mode == "lean" and session.config.grounded_by == "team"
    needs_paths = any(subgoal.function for subgoal in state.subgoals)
    steps = acting.steps_of_plan(session, scene, state) if until == "actions" else None
    if lean:
        reading, provenance = await read_scene(jobs)
        await session.memory.barrier()
        settling = grounding.settle_reading(jobs, reading, provenance)
        unwritten = until == "actions" and steps is None and not needs_paths
        if unwritten and all(item.found for item in reading.targets):
            # Steps name targets, not numbers: they are written while the boxes are judged.
            grounded, steps = await both(settling, acting.write_steps(session, scene, state, ()))
        else:
            grounded = await settling
    else:
        grounded = await grounding.ground(jobs)
    progress.plan = replace(progress.plan, grounded=grounded, status="grounded")
    session.stage("grounded", "   ".join(f"{name} {endings.named(item)}" for name, item in grounded.items()))
    absent = [item for item in grounded.values() if item.status != "found"]
    if absent or until == "grounded":
        return progress.plan, absent, None
    if not lean:
        await session.memory.barrier()
    paths: dict[str, tuple[PathPoint, ...]] = await write_functions(session, scene, state, grounded)
    if steps is None:
        steps = await acting.write_steps(session, scene, state, tuple(paths))
    progress.plan = replace(progress.plan, steps=steps)
    acted = await acting.check_steps(session, scene, state, steps, grounded, paths, jobs)
    progress.plan = replace(progress.plan, grounded=acted.grounded, questions=acted.state.questions)
    if acted.changed:
        return progress.plan, [], acted.state
    if acted.actions is None:
        return progress.plan, [item for item in acted.grounded.values() if item.status != "found"], None
    actions = acted.actions
    acting.remember_angles(session, scene, acted.state, acted.steps)
    plan = replace(endings.with_state(progress.plan, acted.state, "planned"), steps=acted.steps, actions=actions)
    if session.config.strict and not acted.state.verified:
        plan = endings.refused(plan, "steps")
    pixels = " (no camera given: pixels only)" if any(item.action is None for item in actions) else ""
    session.stage("actions", counted(len(actions), "action") + pixels)
    return plan, [], None
