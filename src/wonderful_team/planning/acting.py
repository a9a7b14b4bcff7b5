"""Low-level action generation: the Supervisor writes steps that name targets, code computes every number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents import step_words
from wonderful_team.contracts import PlanReview, ReviewSteps, StepList, WriteSteps
from wonderful_team.core.actions import Step
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point, PointMark
from wonderful_team.core.values import Critique, GroundedTarget, PlannedAction, View
from wonderful_team.motion import ground_actions
from wonderful_team.planning.notes import steps_note
from wonderful_team.planning.plan_loop import PlanState, remember_doubt, resolve, settled_lines, told
from wonderful_team.planning.scene import SceneShown
from wonderful_team.planning.session import AgentSession
from wonderful_team.planning.spending import inferred_turns, steps_said


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
    return state.moves


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
    paths: Mapping[str, tuple[Point, ...]],
) -> tuple[PlannedAction, ...]:
    """The numbers of all steps, each with its source."""
    return ground_actions(steps, grounded, scene.view, scene.limits, paths=paths)


async def check_steps(
    session: AgentSession,
    scene: SceneShown,
    state: PlanState,
    steps: tuple[Step, ...],
    grounded: Mapping[str, GroundedTarget],
    paths: Mapping[str, tuple[Point, ...]],
) -> tuple[PlanState, tuple[Step, ...], tuple[PlannedAction, ...] | None]:
    """Verification's look at the steps, drawn over the view; doubts send them back within the bound.

    A plan that nobody has looked at by itself is checked here too.

    Returns:
        The plan, its steps and their numbers. No numbers (None) when a doubt changed the plan: then the plan is a new one,
        and has to be checked and grounded.
    """
    while True:
        actions = compute(scene, steps, grounded, paths)
        if not session.members.verification:
            return state, steps, actions
        shown = overview_picture(scene, grounded, actions)
        question = _review_question(session, scene, state, steps, shown)
        answer = await session.ask_whole(question, stage="act")
        review: PlanReview = answer.value
        if review.doubt is None:
            if not state.reviewed:
                state = replace(state, verified=True)
                session.stage("checked", f"plan and steps together: {told(state)}")
            return state, steps, actions
        if len(state.questions) >= session.config.bounds.questions:
            what = "steps" if state.reviewed else "plan and its steps"
            session.warn(f"Verification still doubts the {what}: {review.doubt.question}")
            return replace(state, verified=False), steps, actions
        if review.doubt.about in {subgoal.id for subgoal in state.subgoals}:
            asked = Critique(review.doubt.about, review.doubt.kind, review.doubt.question, provenance=answer.provenance)
            state, answered = await resolve(session, scene, state, asked)
            if answered.changed:
                return state, steps, None
            continue
        written = await ask_steps(session, scene, state, tuple(paths), review.doubt.question)
        revised = written.to_steps()
        doubt = Critique(
            f"step {review.doubt.about}",
            review.doubt.kind,
            review.doubt.question,
            "steps rewritten" if revised != steps else "steps kept",
            revised != steps,
            answer.provenance,
        )
        remember_doubt(session, "act", doubt, written.reasoning)
        state, steps = replace(state, questions=(*state.questions, doubt)), revised


def _review_question(
    session: AgentSession,
    scene: SceneShown,
    state: PlanState,
    steps: tuple[Step, ...],
    shown: Picture,
) -> ReviewSteps:
    task = scene.task
    if session.config.sparing:
        # The drawn plan takes the place of the main view, which it shows.
        task = replace(task, views=(shown, *task.views[1:]))
    kinds = () if state.reviewed else scene.vocabulary.step_kinds
    return ReviewSteps(
        task, state.subgoals, state.targets, steps, shown, settled_lines(state.questions), state.reviewed, kinds
    )


def overview_picture(
    scene: SceneShown, grounded: Mapping[str, GroundedTarget], actions: Sequence[PlannedAction]
) -> Picture:
    """The main view with every target's box and label, and the steps as numbered arrows."""
    return mark_targets(scene.views[0], scene.view, grounded).marked(
        *(
            PathMark(path, str(number))
            for number, action in enumerate(actions, start=1)
            if len(path := _path(scene.views[0], action)) >= 2
        )
    )


def mark_targets(picture: Picture, view: View, grounded: Mapping[str, GroundedTarget]) -> Picture:
    """A whole view with the box (or point) and the id of every target found in that view."""
    marks: list[BoxMark | PointMark] = []
    for name, item in grounded.items():
        if item.view_id != view.id:
            continue
        if item.box is not None:
            marks.append(BoxMark(picture.frame.box_to_picture(item.box), "target", name))
        elif item.points:
            marks.append(PointMark(picture.frame.point_to_picture(next(iter(item.points.values()))), name))
    return picture.marked(*marks)


def _path(picture: Picture, action: PlannedAction) -> tuple[Point, ...]:
    return tuple(picture.frame.point_to_picture(source.point_px) for source in action.sources)
