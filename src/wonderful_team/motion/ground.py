"""ground_actions: steps that name targets become actions with numbers, each number with its source."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.core.actions import (
    CloseStep,
    FollowStep,
    HomeStep,
    MoveStep,
    NavigateStep,
    OpenStep,
    PickPlaceStep,
    PushStep,
    RotateGripperStep,
    Step,
)
from wonderful_team.core.pictures import PathPoint
from wonderful_team.core.values import GroundedTarget, Limits, PlannedAction, View
from wonderful_team.motion import arm
from wonderful_team.motion.deprojector import Deprojector
from wonderful_team.motion.follow import ground_follow
from wonderful_team.motion.pick_place import ground_pick_place
from wonderful_team.motion.places import Places
from wonderful_team.motion.push import ground_push
from wonderful_team.motion.sharing import shared_places
from wonderful_team.motion.state import MotionState


def ground_actions(
    steps: Sequence[Step],
    grounded: Mapping[str, GroundedTarget],
    view: View,
    limits: Limits,
    *,
    paths: Mapping[str, tuple[PathPoint, ...]] | None = None,
) -> tuple[PlannedAction, ...]:
    """Compute the numbers of every step.

    Pixels become metres by the depth that the view has at them, else on the table plane. Steps are followed in
    order: what an earlier step moved is looked for where it was put.

    Args:
        steps: In order of execution.
        grounded: By target id; boxes and points in pixels of `view`.
        view: The main view, the one that targets were grounded in.
        limits: Gives the clearance at which things are carried.
        paths: Points of helper functions [px of the view, and m up for a path that rises], by the id that follow steps name.

    Returns:
        One planned action for each step. Without a camera, actions that need metres are None (a plan in pixels), and
        their sources hold the pixels.

    Raises:
        GeometryError: A step needs a target, point, box or path that is not there, or a place with no room; names the
            step.
    """
    places = Places(grounded, Deprojector(view), limits, {} if paths is None else paths, shares=shared_places(steps))
    progress = MotionState()
    planned = []
    for number, step in enumerate(steps, start=1):
        action, progress = _ground(step, replace(places, step=number), progress)
        planned.append(action)
    return tuple(planned)


def _ground(step: Step, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    match step:
        case PickPlaceStep():
            return ground_pick_place(step, places, progress)
        case PushStep():
            return ground_push(step, places, progress)
        case MoveStep():
            return arm.ground_move(step, places, progress)
        case OpenStep():
            return arm.ground_open(step, places, progress)
        case CloseStep():
            return arm.ground_close(step, places, progress)
        case RotateGripperStep():
            return arm.ground_rotate(step, places, progress)
        case FollowStep():
            return ground_follow(step, places, progress, arm.surfaces_z_m(places))
        case HomeStep():
            return arm.ground_home(step, places, progress)
        case NavigateStep():
            return arm.ground_navigate(step, places, progress)
