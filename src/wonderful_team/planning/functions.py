"""Helper functions: the Supervisor asks for a path, writes it as code, sees it drawn, and rewrites it if it is wrong.

What was accepted is kept for as long as the trial lasts, and may be called by the code of later steps. Whatever code calls, its path is
run, checked, drawn and reviewed for its own boxes. The code runs in the sandbox only. Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix C.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import FunctionCode, PathReview, ReviewPath, WriteFunction
from wonderful_team.core.pictures import BoxMark, PathMark, PathPoint, Picture, rises_of
from wonderful_team.core.together import together
from wonderful_team.core.values import FunctionBox, GroundedTarget, HelperFunction, Subgoal
from wonderful_team.errors import PlanError
from wonderful_team.motion.follow import carried_z_m, most_up_m, path_problem, seen_from
from wonderful_team.planning.function_library import code_by_name, in_a_line, next_name, purpose_key, with_function
from wonderful_team.planning.function_library import shown as functions_shown
from wonderful_team.planning.plan_loop import PlanState
from wonderful_team.planning.session import AgentSession
from wonderful_team.sandbox import SandboxError, run_path


async def write_functions(
    session: AgentSession, scene: SceneShown, state: PlanState, grounded: Mapping[str, GroundedTarget], about: str = ""
) -> dict[str, tuple[PathPoint, ...]]:
    """A path in view pixels for every subgoal that asks for one; with `about`, for those alone that need this target.

    Raises:
        PlanError: No version of a function was accepted within the bound.
    """
    asking = [subgoal for subgoal in state.subgoals if subgoal.function and (not about or about in subgoal.targets)]
    if asking and "follow" not in scene.vocabulary.step_kinds:
        session.warn(f"subgoal {asking[0].id} asks for a helper function, but this world follows no paths")
        return {}
    paths: dict[str, tuple[PathPoint, ...]] = {}
    for some in _in_turns(asking):
        written = await together([_write_one(session, scene, subgoal, grounded, state.advice) for subgoal in some])
        for subgoal, (made, path) in zip(some, written, strict=True):
            paths[subgoal.id] = path
            # Kept in the plan's order once all are done, not in that of finishing: what later ones are shown must not be a matter of
            # luck. So where one of them fails, nothing of its turn is kept.
            await _keep(session, subgoal, made)
    return paths


def _in_turns(asking: Sequence[Subgoal]) -> tuple[list[Subgoal], list[Subgoal]]:
    """Those that are written at once, and those that wait for them.

    Paths for different purposes have nothing to learn from each other, and each costs two waiting rounds or more: they are written
    side by side. Of those with the same purpose the first alone is written; the others need only call it, where side by side each
    would be written anew, perhaps differently, and reviewed as often as it is criticised.
    """
    first: dict[str, Subgoal] = {}
    for subgoal in asking:
        first.setdefault(purpose_key(subgoal.function, subgoal.targets), subgoal)
    return [*first.values()], [subgoal for subgoal in asking if subgoal not in first.values()]


async def _keep(session: AgentSession, subgoal: Subgoal, made: HelperFunction) -> None:
    """Offer an accepted function to later steps, and tell what became of it."""
    made = replace(made, name=next_name(session.functions))
    session.functions, became = await with_function(session.functions, made)
    session.stage("function", f"{subgoal.id}: accepted, {became} ({in_a_line(made.purpose)})")


async def _write_one(
    session: AgentSession,
    scene: SceneShown,
    subgoal: Subgoal,
    grounded: Mapping[str, GroundedTarget],
    advice: tuple[str, ...],
) -> tuple[HelperFunction, tuple[PathPoint, ...]]:
    """An accepted function, not yet numbered, and its path in view pixels."""
    view = scene.labelled
    boxes = {
        name: view.frame.box_to_picture(box)
        for name in subgoal.targets
        if name in grounded and (box := grounded[name].box) is not None
    }
    shown = view.marked(*(BoxMark(box, "target", name) for name, box in boxes.items()))
    mine = {name: target for name, target in grounded.items() if name in subgoal.targets}
    carried_m = carried_z_m(mine, scene.view, scene.limits)
    up_m = most_up_m(carried_m, scene.limits)
    known, earlier = code_by_name(session.functions), functions_shown(session.functions, subgoal)
    told = advice if earlier else ()
    error, code = "", ""
    criticised: list[str] = []
    for _ in range(session.config.bounds.functions):
        written: FunctionCode = await session.ask(
            WriteFunction(
                subgoal, shown, boxes, error, code, most_up_m=up_m, earlier=earlier, advice=told, facts=scene.task.facts
            ),
            stage="act",
            branch=subgoal.id,
        )
        code = written.code
        try:
            path = await asyncio.to_thread(run_path, code, boxes, earlier=known)
        except SandboxError as problem:
            error = str(problem)
            continue
        in_view = tuple((*view.frame.point_to_view(point[:2]), *point[2:]) for point in path)
        error = path_problem(in_view, scene.view, scene.limits, up_m)
        if error:
            continue
        seen = view.marked(PathMark(tuple(point[:2] for point in path), subgoal.id))
        sides = _from_the_sides(scene, in_view, carried_m, subgoal.id)
        review: PathReview = await session.ask(
            ReviewPath(subgoal, seen, rises_of(path), sides), stage="act", branch=subgoal.id
        )
        if review.accepted:
            if criticised:
                session.remember(
                    "supervisor",
                    "act",
                    f"The path for {subgoal.id} ({subgoal.function}) was criticised: {'; '.join(criticised)}",
                    f"A later version was accepted: {written.reasoning}",
                    branch=subgoal.id,
                )
            found = tuple(FunctionBox(name, grounded[name].target.words, box) for name, box in boxes.items())
            return HelperFunction(next_name(session.functions), subgoal.function or "", code, found, path), in_view
        error = f"the path was drawn and refused: {review.problem}"
        criticised.append(review.problem)
    raise PlanError(
        f"no helper function for {subgoal.id} was accepted in {session.config.bounds.functions} versions; "
        f"the last problem: {error}",
        stage="function",
    )


def _from_the_sides(scene: SceneShown, path: Sequence[PathPoint], carried_m: float, label: str) -> tuple[Picture, ...]:
    """A path that rises, drawn in the other views; () for one that does not."""
    if not any(rises_of(path)):
        return ()
    views = list(zip(scene.views, scene.observation.views.values(), strict=True))[1:]
    drawn = [(picture, seen_from(path, carried_m, scene.view, view)) for picture, view in views]
    return tuple(
        picture.marked(PathMark(tuple(picture.frame.point_to_picture(px) for px in points), label))
        for picture, points in drawn
        if points
    )
