"""Low-level action generation: the Supervisor writes steps that name targets, code computes every number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.contracts import PlanReview, ReviewSteps, StepList, WriteSteps
from wonderful_team.core.actions import Step
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point, PointMark
from wonderful_team.core.values import Critique, GroundedTarget, PlannedAction, View
from wonderful_team.images import swept_width
from wonderful_team.motion import ground_actions
from wonderful_team.motion.in_words import numbers_in_words
from wonderful_team.planning.plan_loop import PlanState, settled_lines
from wonderful_team.planning.scene import SceneShown
from wonderful_team.planning.session import AgentSession


async def write_steps(
    session: AgentSession, scene: SceneShown, state: PlanState, functions: Sequence[str], doubt: str = ""
) -> tuple[Step, ...]:
    """The Supervisor's steps."""
    question = WriteSteps(
        scene.task, scene.vocabulary.step_kinds, state.subgoals, state.targets, tuple(functions), doubt
    )
    written: StepList = await session.ask(question, stage="act")
    return written.to_steps()


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
) -> tuple[PlanState, tuple[Step, ...], tuple[PlannedAction, ...]]:
    """Verification's look at the steps, drawn over the view; doubts send them back within the bound."""
    while True:
        actions = compute(scene, steps, grounded, paths)
        if not session.members.verification:
            return state, steps, actions
        shown = overview_picture(scene, grounded, actions)
        question = ReviewSteps(
            scene.task,
            state.subgoals,
            state.targets,
            steps,
            shown,
            settled_lines(state.questions),
            numbers_in_words(actions, grounded, scene.view, scene.limits),
        )
        answer = await session.ask_whole(question, stage="act")
        review: PlanReview = answer.value
        if review.doubt is None:
            return state, steps, actions
        if len(state.questions) >= session.config.bounds.questions:
            session.warn(f"Verification still doubts the steps: {review.doubt.question}")
            return replace(state, verified=False), steps, actions
        revised = await write_steps(session, scene, state, tuple(paths), review.doubt.question)
        doubt = Critique(
            f"step {review.doubt.about}",
            review.doubt.kind,
            review.doubt.question,
            "steps rewritten" if revised != steps else "steps kept",
            revised != steps,
            answer.provenance,
        )
        state, steps = replace(state, questions=(*state.questions, doubt)), revised


def overview_picture(
    scene: SceneShown, grounded: Mapping[str, GroundedTarget], actions: Sequence[PlannedAction]
) -> Picture:
    """The main view with every target's box and label, and the steps as numbered arrows."""
    return mark_targets(scene.views[0], scene.view, grounded).marked(
        *(
            PathMark(path, str(number), _swept(scene, action))
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


def _swept(scene: SceneShown, action: PlannedAction) -> float:
    """How wide a strip the tool sweeps, in pixels of the shown view."""
    width = swept_width(action.action, scene.limits.blade_m, scene.view.camera)
    return width / float(scene.views[0].frame.T_view_picture[0, 0])


def _path(picture: Picture, action: PlannedAction) -> tuple[Point, ...]:
    return tuple(picture.frame.point_to_picture(source.point_px) for source in action.sources)
