"""What was computed for the steps, in words for whoever reviews them: heights, and the room beside and above."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from shapely import LineString, Polygon

from wonderful_team.core.actions import FollowStep, MoveTo, PickPlace, Push, Trajectory
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import GroundedTarget, Limits, PlannedAction, View
from wonderful_team.motion.deprojector import TABLE_Z_M, Deprojector

SAMPLES = 40
"""At how many points of its way the surface under a carried thing is looked up."""


def numbers_in_words(
    actions: Sequence[PlannedAction], grounded: Mapping[str, GroundedTarget], view: View, limits: Limits
) -> tuple[str, ...]:
    """One line for each step that goes somewhere; lengths in cm, heights over the table."""
    lines = []
    standing = {name: item for name, item in grounded.items() if item.target.kind == "object"}
    for number, planned in enumerate(actions, start=1):
        said = "; ".join(_told(planned, standing, Deprojector(view), limits))
        if said:
            lines.append(f"step {number}: {said}")
        # What was moved stands no longer where the picture shows it.
        standing = {name: item for name, item in standing.items() if name != _moved(planned)}
    return tuple(lines)


def _moved(planned: PlannedAction) -> str | None:
    """The target that an action moves, if it is one that carries or pushes."""
    moves = isinstance(planned.action, PickPlace | Push) and planned.sources
    return planned.sources[0].target if moves else None


def _told(
    planned: PlannedAction, standing: Mapping[str, GroundedTarget], lift: Deprojector, limits: Limits
) -> Iterator[str]:
    action = planned.action
    if action is None:
        if planned.sources:
            yield "no camera is known: heights and lengths cannot be computed"
    elif isinstance(action, PickPlace):
        yield from _carried(action, planned, lift, limits)
    elif isinstance(action, Push):
        yield from _pushed(action, planned, standing, lift, limits)
    elif isinstance(action, MoveTo):
        yield f"the tool goes to {_cm(float(action.pose.position_m[2]))} over the table"
    elif isinstance(action, Trajectory):
        heights = [float(point[2]) for point in action.waypoints_m]
        if isinstance(planned.step, FollowStep) and planned.step.contact == "surface":
            yield "lowered to the surface at its first point, lifted after its last"
            heights = heights[1:-1] or heights
        low, high = min(heights), max(heights)
        between = _cm(low) if high - low < 0.001 else f"{_cm(low)} to {_cm(high)}"
        yield f"{len(heights)} points at {between} over the table"
    if any("a guess" in source.how for source in planned.sources):
        yield "it goes on from where an earlier push should leave the thing: a guess, no picture shows it"


def _carried(action: PickPlace, planned: PlannedAction, lift: Deprojector, limits: Limits) -> Iterator[str]:
    if lift.view.depth_m is None:
        yield "no depth: heights are not known"
        return
    start, end = (source.point_px for source in planned.sources)
    way = [np.asarray(start) + (np.asarray(end) - np.asarray(start)) * share for share in np.linspace(0, 1, SAMPLES)]
    seen = [lift.surface((float(x), float(y)), "way").position_m for x, y in way if lift.inside((float(x), float(y)))]
    highest = max((float(at[2]) for at in seen if at is not None), default=TABLE_Z_M)
    yield f"held at {_cm(float(action.pick_m[2]))}, put down on a surface at {_cm(float(action.place_m[2]))}"
    carried_m = limits.carried_z_m(action.pick_m, action.place_m)
    yield f"the highest surface under its way is at {_cm(highest)}, and it is carried {_cm(carried_m)} over the table"


def _pushed(
    action: Push, planned: PlannedAction, standing: Mapping[str, GroundedTarget], lift: Deprojector, limits: Limits
) -> Iterator[str]:
    start, end = action.start_m[:2], action.end_m[:2]
    z_m, blade_m = float(action.start_m[2]), limits.blade_m
    yield f"{_cm(float(np.linalg.norm(end - start)))} along the surface at {_cm(z_m)}"
    boxes = {
        name: lift.camera.on_plane(np.array(target.box.corners), z_m)[:, :2]
        for name, target in standing.items()
        if target.box is not None and lift.camera is not None
    }
    thing = planned.sources[0].target
    across = _extent(boxes[thing], end - start) if thing in boxes else 0.0
    width_m = max(blade_m or 0.0, across)
    yield f"tool and thing sweep a strip {_cm(width_m)} wide" + (
        " (how wide the tool is, is not known)" if blade_m is None else ""
    )
    strip = LineString([start, end]).buffer(max(width_m, 1e-4) / 2, cap_style="flat")
    for name, corners in boxes.items():
        if name in {source.target for source in planned.sources}:
            continue
        apart = float(strip.distance(Polygon(corners)))
        if apart == 0:
            yield f"the strip crosses the box of {name}"
        elif apart < width_m:
            yield f"{_cm(apart)} between the strip and the box of {name}"


def _extent(corners: Array, way: Array) -> float:
    """How wide something is across a way [m]."""
    across = np.array([-way[1], way[0]]) / np.linalg.norm(way)
    return float(np.ptp(corners @ across))


def _cm(length_m: float) -> str:
    return f"{100 * length_m:.1f} cm"
