"""Low-level action generation: the Supervisor writes steps that name targets, code computes every number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.contracts import PlanReview, ReviewSteps, StepList, WriteSteps
from wonderful_team.core.actions import PickPlaceStep, Step
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point, PointMark
from wonderful_team.core.values import Critique, GroundedTarget, PlannedAction, View
from wonderful_team.motion import ground_actions
from wonderful_team.planning.plan_loop import PlanState
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
    checked: list[str] = []
    while True:
        actions = compute(scene, steps, grounded, paths)
        if not session.members.verification:
            return state, steps, actions
        shown = overview_picture(scene, grounded, actions)
        answer = await session.ask_whole(
            ReviewSteps(scene.task, state.subgoals, state.targets, steps, shown, tuple(checked)), stage="act"
        )
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
        checked.append(f"asked about step {doubt.about}: {doubt.question} Answer: {doubt.answer}")
        state, steps = replace(state, questions=(*state.questions, doubt)), revised


def overview_picture(
    scene: SceneShown, grounded: Mapping[str, GroundedTarget], actions: Sequence[PlannedAction]
) -> Picture:
    """The main view with every target's box and label, and the steps as numbered arrows."""
    plain = scene.views[0]
    return mark_targets(replace(plain, name=f"{plain.name} with the plan"), scene.view, grounded).marked(
        *(
            PathMark(path, str(number), bowed=isinstance(action.step, PickPlaceStep))
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
