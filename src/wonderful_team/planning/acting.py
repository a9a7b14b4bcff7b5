"""Low-level action generation: the Supervisor writes steps that name targets, code computes every number."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from wonderful_team.agents import step_words
from wonderful_team.agents.plan_drawn import plan_drawn
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import (
    GROUNDING_KINDS,
    PlanReview,
    ReviewSteps,
    StepList,
    WalkedReview,
    WriteSteps,
    steps_of_moves,
)
from wonderful_team.core.actions import Step
from wonderful_team.core.pictures import PathPoint, Picture
from wonderful_team.core.text import counted
from wonderful_team.core.values import Critique, GroundedTarget, PlannedAction
from wonderful_team.motion import ground_actions
from wonderful_team.motion.in_words import numbers_in_words
from wonderful_team.planning.functions import write_functions
from wonderful_team.planning.grounding import ground_again
from wonderful_team.planning.jobs import ENDS, Job
from wonderful_team.planning.notes import steps_note
from wonderful_team.planning.plan_loop import PlanState, remember_doubt, resolve, settled_lines, told
from wonderful_team.planning.session import AgentSession
from wonderful_team.planning.spending import inferred_turns, steps_said
from wonderful_team.planning.turns import settle_turns


async def ask_steps(
    session: AgentSession, scene: SceneShown, state: PlanState, functions: Sequence[str], doubt: str = ""
) -> StepList:
    """The Supervisor's answer: steps, and what decided them."""
    question = WriteSteps(
        scene.task, scene.vocabulary.step_kinds, state.subgoals, state.targets, tuple(functions), doubt
    )
    written: StepList = await session.ask(question, stage="act")
    return written


async def write_steps(
    session: AgentSession, scene: SceneShown, state: PlanState, functions: Sequence[str]
) -> tuple[Step, ...]:
    """The Supervisor's steps."""
    return (await ask_steps(session, scene, state, functions)).to_steps()


def steps_of_plan(session: AgentSession, scene: SceneShown, state: PlanState) -> tuple[Step, ...] | None:
    """`lean`: the steps of a plan that says everything they need; None where the Supervisor has to write them."""
    kinds = scene.vocabulary.step_kinds
    if not session.config.sparing or not steps_said(state.subgoals, state.targets, state.moves, kinds):
        return None
    session.skip("WriteSteps", "the plan states them")
    session.note("supervisor", "WriteSteps", steps_note(state.moves))
    return steps_of_moves(state.moves, kinds)


def remember_angles(session: AgentSession, scene: SceneShown, state: PlanState, steps: Sequence[Step]) -> None:
    """Let Memory keep why something is turned as far as it is, where no words of the instruction say how far."""
    turned = [step_words(step) for step in inferred_turns(steps, scene.instruction.text)]
    because = f" Because: {state.reasoning}" if state.reasoning else ""
    if turned:
        session.remember("supervisor", "act", "How far is what turned, and why?", f"{'; '.join(turned)}.{because}")


def compute(
    scene: SceneShown,
    steps: Sequence[Step],
    grounded: Mapping[str, GroundedTarget],
    paths: Mapping[str, tuple[PathPoint, ...]],
) -> tuple[PlannedAction, ...]:
    """The numbers of all steps, each with its source."""
    return ground_actions(steps, grounded, scene.view, scene.limits, paths=paths)


@dataclass(frozen=True, eq=False)
class Acted:
    """Steps with their numbers as they stand after Verification's look at them.

    Attributes:
        grounded: Targets as they are used; one that was doubted may have been found elsewhere, or not at all.
        actions: None when a doubted target was not found again, or the plan was changed.
        changed: A doubt changed the plan itself: it is a new one, and has to be checked and grounded.
    """

    state: PlanState
    steps: tuple[Step, ...]
    grounded: Mapping[str, GroundedTarget]
    actions: tuple[PlannedAction, ...] | None
    changed: bool = False


async def check_steps(
    session: AgentSession,
    scene: SceneShown,
    state: PlanState,
    steps: tuple[Step, ...],
    grounded: Mapping[str, GroundedTarget],
    paths: Mapping[str, tuple[PathPoint, ...]],
    jobs: Sequence[Job],
) -> Acted:
    """Verification's look at the steps, drawn over the view, and at the plan where nobody has looked at it by itself.

    A doubt about a step or a subgoal sends steps or plan back to the Supervisor, one about a point or a box sends its target
    back to grounding, all within their bounds.

    Raises:
        GeometryError: The numbers of a step cannot be computed.
    """
    settled = await settle_turns(session, scene, steps, grounded)
    steps, grounded = settled.steps, settled.grounded
    looks: Counter[str] = Counter()
    while True:
        actions = compute(scene, steps, grounded, paths)
        if not session.members.verification:
            return Acted(state, steps, grounded, actions)
        shown = plan_drawn(scene, grounded, actions)
        question = _review_question(session, scene, state, steps, shown, grounded, actions, settled.told)
        answer = await session.ask_whole(question, stage="act")
        review: PlanReview | WalkedReview = answer.value
        if review.doubt is None:
            if not state.reviewed:
                state = replace(state, verified=True)
                session.stage("checked", f"plan and steps together: {told(state)}")
            return Acted(state, steps, grounded, actions)
        about, kind, said = review.doubt.about, review.doubt.kind, review.doubt.question
        of_target, most = kind in GROUNDING_KINDS, session.config.bounds.regrounds
        if len(state.questions) >= session.config.bounds.questions or (of_target and looks[about] >= most):
            what = about if of_target else "the steps" if state.reviewed else "the plan and its steps"
            bound = f" after it was looked for {counted(looks[about], 'time')} more" if of_target else ""
            session.warn(f"Verification still doubts {what}{bound}: {said}")
            return Acted(replace(state, verified=False), steps, grounded, actions)
        if not of_target and about in {"plan", *(subgoal.id for subgoal in state.subgoals)}:
            asked = Critique(about, kind, said, provenance=answer.provenance)
            state, answered = await resolve(session, scene, state, asked)
            if answered.changed:
                return Acted(state, steps, grounded, None, changed=True)
            continue
        doubt, why = Critique(about if of_target else f"step {about}", kind, said, provenance=answer.provenance), ""
        if of_target:
            looks[about] += 1
            grounded, doubt = await _look_again(jobs, grounded, doubt)
            if grounded[about].status != "found":
                return Acted(replace(state, questions=(*state.questions, doubt)), steps, grounded, None)
            if paths:
                paths = {**paths, **await write_functions(session, scene, state, grounded, about)}
        else:
            written = await ask_steps(session, scene, state, tuple(paths), said)
            revised, why = written.to_steps(), written.reasoning
            done = "steps rewritten" if revised != steps else "steps kept"
            steps, doubt = revised, replace(doubt, answer=done, changed=revised != steps)
        remember_doubt(session, "act", doubt, why)
        state = replace(state, questions=(*state.questions, doubt))


async def _look_again(
    jobs: Sequence[Job], grounded: Mapping[str, GroundedTarget], doubt: Critique
) -> tuple[dict[str, GroundedTarget], Critique]:
    """A doubted target, grounded once more; and the doubt with what came of it."""
    job = next(job for job in jobs if job.target.id == doubt.about)
    before = grounded[doubt.about]
    goal = None if job.goal is None else grounded.get(job.goal)
    job.towards = None if goal is None else next((goal.points[role] for role in ENDS if role in goal.points), None)
    after = await ground_again(job, before, doubt)
    moved = (after.box, dict(after.points)) != (before.box, dict(before.points))
    what = "the point" if doubt.kind == "wrong_point" else "the box"
    if after.status != "found":
        answer = f"{doubt.about} was looked for again and not found"
    elif moved:
        answer = f"{what} was chosen anew; judge it as it is drawn now"
    else:
        answer = f"{doubt.about} was looked for again and {what} is the same"
    job.session.stage("grounded", f"{doubt.about} doubted by Verification: {answer.partition(';')[0]}")
    return {**grounded, doubt.about: after}, replace(doubt, answer=answer, changed=moved)


def _review_question(
    session: AgentSession,
    scene: SceneShown,
    state: PlanState,
    steps: tuple[Step, ...],
    shown: Picture,
    grounded: Mapping[str, GroundedTarget],
    actions: Sequence[PlannedAction],
    turns_told: Sequence[str],
) -> ReviewSteps:
    task = scene.task
    if session.config.sparing:
        # The drawn plan takes the place of the main view, which it shows.
        task = replace(task, views=(shown, *task.views[1:]))
    return ReviewSteps(
        task,
        state.subgoals,
        state.targets,
        steps,
        shown,
        checked=(*turns_told, *settled_lines(state.questions)),
        numbers=numbers_in_words(actions, grounded, scene.view, scene.limits),
        plan_checked=state.reviewed,
        step_kinds=() if state.reviewed else scene.vocabulary.step_kinds,
    )
