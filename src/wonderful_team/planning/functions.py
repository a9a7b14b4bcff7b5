"""Helper functions: the Supervisor asks for a path, writes it as code, sees it drawn, and rewrites it if it is wrong.

The code runs in the sandbox only. Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix C.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence

from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import FunctionCode, PathReview, ReviewPath, WriteFunction
from wonderful_team.core.pictures import BoxMark, PathMark, PathPoint, Picture, rises_of
from wonderful_team.core.together import together
from wonderful_team.core.values import GroundedTarget, Subgoal
from wonderful_team.errors import PlanError
from wonderful_team.motion.follow import carried_z_m, most_up_m, path_problem, seen_from
from wonderful_team.planning.session import AgentSession
from wonderful_team.sandbox import SandboxError, run_path


async def write_functions(
    session: AgentSession, scene: SceneShown, subgoals: Sequence[Subgoal], grounded: Mapping[str, GroundedTarget]
) -> dict[str, tuple[PathPoint, ...]]:
    """A path in view pixels for every subgoal that asks for one.

    Raises:
        PlanError: No version of a function was accepted within the bound.
    """
    asking = [subgoal for subgoal in subgoals if subgoal.function]
    if asking and "follow" not in scene.vocabulary.step_kinds:
        session.warn(f"subgoal {asking[0].id} asks for a helper function, but this world follows no paths")
        return {}
    paths = await together([_write_one(session, scene, subgoal, grounded) for subgoal in asking])
    return {subgoal.id: path for subgoal, path in zip(asking, paths, strict=True)}


async def _write_one(
    session: AgentSession, scene: SceneShown, subgoal: Subgoal, grounded: Mapping[str, GroundedTarget]
) -> tuple[PathPoint, ...]:
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
    error, code = "", ""
    criticised: list[str] = []
    for _ in range(session.config.bounds.functions):
        written: FunctionCode = await session.ask(
            WriteFunction(subgoal, shown, boxes, error, code, most_up_m=up_m), stage="act", branch=subgoal.id
        )
        code = written.code
        try:
            path = await asyncio.to_thread(run_path, code, boxes)
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
            return in_view
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
