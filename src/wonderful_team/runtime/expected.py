"""Does the scene look as the plan expects, after a subgoal? From pictures before and after, and from what the robot reported.

Nothing here decides: it says where a closer look is worth its question. What is compared is what matters to the plan: where a
thing was taken and put there must be a change, and where later subgoals act, or earlier ones put things, there must be none.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.actions import FollowStep, PushStep, places_of
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.steps import carried_by
from wonderful_team.core.values import Observation, Plan, PlannedAction, SubgoalRun, View
from wonderful_team.images import CHANGED, region_change
from wonderful_team.runtime.staleness import point_window, points_px

MARGIN = 1.25
"""A carried thing may change this many times its own size, round where it was and where it went: its shadow, what it touches."""
LEAST_PX = 6.0
"""Strips of a spot beside what was meant to change tell nothing where they are narrower [px]."""


@dataclass(frozen=True)
class Spot:
    """A part of the main view that matters to a plan, and what it is, in words."""

    what: str
    box: Box


@dataclass(frozen=True)
class Meant:
    """What one subgoal was meant to change.

    Attributes:
        touched: Everything that it may change.
        took, put: Where it took a thing from and where it put it; None where it carried nothing, or put it back where it was.
        carried: Id of that thing.
    """

    touched: tuple[Box, ...]
    took: Spot | None = None
    put: Spot | None = None
    carried: str | None = None


class Expectations:
    """Follows one run of a plan, subgoal by subgoal.

    Args:
        actions, plan: What runs.
        start: The scene before it.
        in_view: Whether an arm that could be out of the picture stands in it.
    """

    def __init__(self, actions: Sequence[PlannedAction], plan: Plan, start: Observation, in_view: bool) -> None:
        self._plan, self._start = plan, start
        self._meant = _all_meant(actions, plan, start.main)
        self._base: Observation | None = None if in_view else start
        self._since: list[Meant] = []
        self._earlier: dict[str, Spot] = {}

    def doubts(self, run: SubgoalRun, later: Sequence[PlannedAction], in_view: bool) -> tuple[str, ...]:
        """What is not as the plan expects after this subgoal, one line each; () where nothing is.

        Args:
            run: The subgoal that ran last.
            later: The actions that are still to run.
            in_view: Whether an arm stands in the picture that could be out of it: then pictures are compared after a later subgoal.
        """
        found = [f"the robot reported: {report.fault}" for report in run.reports if report.fault]
        if run.subgoal in self._meant:
            self._since.append(self._meant[run.subgoal])
        if in_view:
            return tuple(found)
        base, since = self._base, self._since
        self._base, self._since = run.after, []
        if base is not None and base.main.size_px == run.after.main.size_px:
            found += self._seen(base.main, run.after.main, since, later)
        self._earlier |= {one.carried: one.put for one in since if one.carried is not None and one.put is not None}
        return tuple(found)

    def _seen(self, before: View, after: View, since: Sequence[Meant], later: Sequence[PlannedAction]) -> Iterator[str]:
        touched = [box for one in since for box in one.touched]
        for one in since:
            if one.took is not None and not _changed(before, after, one.took.box):
                yield f"{one.took.what}: the picture there is as before, though it was to be taken from there"
            if one.put is not None and not _changed(before, after, one.put.box):
                yield f"{one.put.what}: the picture there is as before, though something was to be put there"
        again = {one.carried for one in since}
        put = [spot for name, spot in self._earlier.items() if name not in again]
        for spot in (*put, *_used(later, self._plan, self._start.main, self._earlier)):
            if any(_changed(before, after, part) for part in _without(spot.box, touched)):
                yield f"{spot.what}: the picture there has changed, though nothing was to touch it"


def _by_subgoal(actions: Sequence[PlannedAction]) -> Mapping[str, list[PlannedAction]]:
    found: dict[str, list[PlannedAction]] = {}
    for planned in actions:
        found.setdefault(planned.step.subgoal, []).append(planned)
    return found


def _changed(before: View, after: View, box: Box) -> bool:
    """Whether a part of the picture has changed; what lies outside of it is not known to have."""
    seen = box.intersection(Box(0, 0, *before.size_px))
    return seen is not None and region_change(before.rgb, after.rgb, seen) >= CHANGED


def _without(box: Box, others: Sequence[Box]) -> list[Box]:
    """What is left of a box beside others, in upright strips and lying ones."""
    left = [box]
    for other in others:
        left = [part for one in left for part in _beside(one, other)]
    return [part for part in left if min(part.width, part.height) >= min(LEAST_PX, box.width, box.height)]


def _beside(box: Box, other: Box) -> list[Box]:
    """A box without what it shares with another: up to four boxes."""
    shared = box.intersection(other)
    if shared is None:
        return [box]
    cut = (
        (box.x0, box.y0, shared.x0, box.y1),
        (shared.x1, box.y0, box.x1, box.y1),
        (shared.x0, box.y0, shared.x1, shared.y0),
        (shared.x0, shared.y1, shared.x1, box.y1),
    )
    return [Box(*sides) for sides in cut if sides[0] < sides[2] and sides[1] < sides[3]]


def _all_meant(actions: Sequence[PlannedAction], plan: Plan, view: View) -> Mapping[str, Meant]:
    """What every subgoal is meant to change; what was carried before is taken from where it was put."""
    lies: dict[str, Box] = {}
    found = {}
    for name, own in _by_subgoal(actions).items():
        carried = carried_by([planned.step for planned in own])
        found[name] = _meant(own, plan, view, carried, lies)
        thing = None if carried is None else plan.grounded.get(carried)
        places = [point for planned in own for _, point in _places(planned, view)]
        if carried is not None and thing is not None and thing.box is not None and places:
            lies[carried] = point_window(places[-1], thing.box, view)
    return found


def _meant(own: Sequence[PlannedAction], plan: Plan, view: View, carried: str | None, lies: Mapping[str, Box]) -> Meant:
    thing = None if carried is None else plan.grounded.get(carried)
    places = [place for planned in own for place in _places(planned, view)]
    held = None if thing is None else thing.box
    boxes = [_box_at(name, point, plan, view, held) for name, point in places]
    if thing is None or held is None or carried is None or not places:
        return Meant(_round(own, boxes))
    stood = lies.get(carried, held)
    touched = _round(own, [*boxes, stood])
    name = f"{carried} ({thing.target.words})"
    took = Spot(name, stood)
    put = Spot(f"where {name} was to be put", point_window(places[-1][1], held, view))
    # What is turned or shaken and put back leaves the picture as it was.
    apart = put.box.intersection(stood) is None
    return Meant(touched, took if apart else None, put if apart else None, carried)


def _round(own: Sequence[PlannedAction], boxes: Sequence[Box]) -> tuple[Box, ...]:
    """Boxes with their margin; of a push all that lies between them, too."""
    if boxes and any(isinstance(planned.step, PushStep | FollowStep) for planned in own):
        return (Box.bounding([corner for box in boxes for corner in box.scaled(MARGIN).corners]),)
    return tuple(box.scaled(MARGIN) for box in boxes)


def _places(planned: PlannedAction, view: View) -> list[tuple[str | None, Point]]:
    """Where an action acts: ids of targets, and pixels of the main view."""
    names = dict(places_of(planned.step))
    found = points_px(planned, view)
    if not found and isinstance(planned.step, FollowStep) and planned.action is not None and view.camera is not None:
        points = np.array([point for _, point in planned.action.points()])
        return [(None, (float(x), float(y))) for x, y in view.camera.project(points)]
    only = next(iter(names.values())).target if len(names) == 1 else None
    return [(names[role].target if role in names else only, point) for role, point in found]


def _box_at(name: str | None, point: Point, plan: Plan, view: View, carried: Box | None) -> Box:
    """The box of a thing at a point; elsewhere a window as large as what is carried there."""
    target = None if name is None else plan.grounded.get(name)
    if target is not None and target.box is not None and target.target.kind == "object" and target.box.contains(point):
        return target.box
    return point_window(point, carried, view)


def _used(later: Sequence[PlannedAction], plan: Plan, view: View, moved: Container[str]) -> list[Spot]:
    """The things that the actions still to run rely on, but for those that lie elsewhere by now."""
    names = dict.fromkeys(place.target for planned in later for _, place in places_of(planned.step))
    found = []
    for name in names:
        item = None if name in moved else plan.grounded.get(name)
        if item is not None and item.box is not None and item.target.kind == "object" and item.view_id == view.id:
            found.append(Spot(f"{name} ({item.target.words})", item.box))
    return found
