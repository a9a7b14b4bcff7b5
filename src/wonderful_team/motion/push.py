"""Push: the tool starts beside a thing, on the side away from the end, and stops when the thing has arrived."""

from __future__ import annotations

from collections.abc import Mapping

from wonderful_team.core.actions import At, Place, Push, PushStep
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import NO_WORKSPACE, PlannedAction, PointRole
from wonderful_team.motion.beside import behind_px
from wonderful_team.motion.deprojector import ResolvedPoint
from wonderful_team.motion.places import Places
from wonderful_team.motion.sources import source
from wonderful_team.motion.state import MotionState, Moved

_TO_END: tuple[PointRole, ...] = ("push_end", "place", "pick", "grasp")


def ground_push(step: PushStep, places: Places, progress: MotionState) -> tuple[PlannedAction, MotionState]:
    """The action for one step: along the surface that the thing stands on.

    A chosen push_start or push_end point is used as it is. Otherwise the start is computed behind the thing's box and
    the end such that the thing's centre arrives at the place.
    """
    thing = step.start.target
    start_px = _given_start(step, places, progress)
    computed = start_px is None
    end_px, end_is_tool = _end(step, places, progress)
    box = places.box_now(thing, progress) if start_px is None or not end_is_tool else None
    start_how, end_how = f"{thing} push_start point", f"{step.end.target} push_end point"
    centre_end = end_px
    if box is not None:
        try:
            behind, short = behind_px(box, end_px)
        except ValueError as error:
            raise places.fail(f"push of {thing!r}: {error}") from error
        if start_px is None:
            start_px, start_how = behind, f"behind {thing}'s box, away from the end{progress.guessed(thing)}"
        if not end_is_tool:
            end_px, end_how = short, f"half of {thing}'s box short of {_named(step.end)}"
    assert start_px is not None
    z_m = places.support_z_m(thing)
    start = places.lift.at_height(start_px, z_m, f"{start_how}, at the height z = {z_m:.3f} m that it stands on")
    end = places.lift.at_height(end_px, z_m, f"{end_how}, at the same height")
    _check_inside(
        places, thing, {"end": end} if computed and _reachable(start, places) else {"start": start, "end": end}
    )
    action = None
    if start.position_m is not None and end.position_m is not None:
        action = Push(start.position_m, end.position_m)
    planned = PlannedAction(
        step, action, (source("push_start", thing, start), source("push_end", step.end.target, end))
    )
    if box is None:
        return planned, progress
    arrived = places.lift.at_height(centre_end, z_m, "pushed there")
    stood = places.lift.at_height(box.centre, z_m, f"centre of {thing}'s box")
    moved = Moved(places.step, stood.px, arrived.px, stood.position_m, arrived.position_m, pushed=True)
    return planned, progress.with_move(thing, moved)


def _given_start(step: PushStep, places: Places, progress: MotionState) -> Point | None:
    """The start that was chosen or named; None when it has to be computed."""
    if isinstance(step.start, At):
        target = places.target(step.start.target)
        if "push_start" not in target.points or progress.moved.get(step.start.target):
            # A point that was chosen beside a thing is stale once the thing has moved: the next push may go elsewhere.
            return None
        return places.spot(step.start.target, ("push_start",), progress)[1].px
    return places.destination(step.start, progress, None).px


def _end(step: PushStep, places: Places, progress: MotionState) -> tuple[Point, bool]:
    """The end, and whether it is meant for the tool itself rather than for the thing."""
    if isinstance(step.end, At):
        roles = ("push_end",) if step.end.target == step.start.target else _TO_END
        role, spot = places.spot(step.end.target, roles, progress)
        return spot.px, role == "push_end"
    return places.destination(step.end, progress, step.start.target).px, False


def _named(place: Place) -> str:
    return f"the place {place.target}"


def _reachable(start: ResolvedPoint, places: Places) -> bool:
    """Whether the robot's workspace is known and holds a point.

    A tool that comes down behind a thing at the picture's edge may do so just outside of the picture, where the workspace reaches.
    """
    if start.position_m is None or places.limits is NO_WORKSPACE:
        return False
    low, high = places.limits.low_m, places.limits.high_m
    return all(low[k] <= start.position_m[k] <= high[k] for k in (0, 1))


def _check_inside(places: Places, thing: str, spots: Mapping[str, ResolvedPoint]) -> None:
    width, height = places.lift.view.size_px
    for name, spot in spots.items():
        if not places.lift.inside(spot.px):
            raise places.fail(
                f"push of {thing!r}: its {name} at ({spot.px[0]:.0f}, {spot.px[1]:.0f}) px would lie outside the view of "
                f"{width} x {height} px"
            )
