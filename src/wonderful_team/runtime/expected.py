"""Does the scene look as the plan expects, after a subgoal? From pictures before and after, and from what the robot reported.

Nothing here decides: it says where a closer look is worth its question. What is compared is what matters to the plan: where a
thing was taken and put there must be a change, and where later subgoals act, or earlier ones put things, there must be none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.actions import CloseStep, FollowStep, OpenStep, PickPlaceStep, PushStep, places_of
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import GroundedTarget, Observation, Plan, PlannedAction, SubgoalRun, View
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
    """

    touched: tuple[Box, ...]
    took: Spot | None = None
    put: Spot | None = None


class Expectations:
    """Follows one run of a plan, subgoal by subgoal.

    Args:
        actions, plan: What runs.
        start: The scene before it.
        in_view: Whether an arm that could be out of the picture stands in it.
    """

    def __init__(self, actions: Sequence[PlannedAction], plan: Plan, start: Observation, in_view: bool) -> None:
        self._plan, self._start = plan, start
        self._meant = {name: _meant(own, plan, start.main) for name, own in _by_subgoal(actions).items()}
        self._base: Observation | None = None if in_view else start
        self._since: list[Meant] = []
        self._earlier: list[Spot] = []

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
        self._earlier += [one.put for one in since if one.put is not None]
        return tuple(found)

    def _seen(self, before: View, after: View, since: Sequence[Meant], later: Sequence[PlannedAction]) -> Iterator[str]:
        touched = [box for one in since for box in one.touched]
        for one in since:
            if one.took is not None and not _changed(before, after, one.took.box):
                yield f"{one.took.what}: the picture there is as before, though it was to be taken from there"
            if one.put is not None and not _changed(before, after, one.put.box):
                yield f"{one.put.what}: the picture there is as before, though something was to be put there"
        for spot in (*self._earlier, *_used(later, self._plan, self._start.main)):
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


def _meant(own: Sequence[PlannedAction], plan: Plan, view: View) -> Meant:
    places = [place for planned in own for place in _places(planned, view)]
    thing = _carried(own, plan)
    held = None if thing is None else thing.box
    touched = _round(own, [_box_at(name, point, plan, view, held) for name, point in places])
    if thing is None or held is None or not places:
        return Meant(touched)
    name = f"{thing.target.id} ({thing.target.words})"
    took = Spot(name, held)
    put = Spot(f"where {name} was to be put", point_window(places[-1][1], held, view))
    # What is turned or shaken and put back leaves the picture as it was.
    return Meant(touched, took, put) if put.box.intersection(held) is None else Meant(touched)


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


def _carried(own: Sequence[PlannedAction], plan: Plan) -> GroundedTarget | None:
    """What a subgoal carries: what it picks, or what it goes to before the fingers close."""
    name, at = None, None
    closed = False
    for planned in own:
        step = planned.step
        if isinstance(step, PickPlaceStep):
            name = step.pick
        elif isinstance(step, CloseStep):
            name, closed = at, True
        elif isinstance(step, OpenStep) and closed:
            break
        elif not closed:
            at = next((place.target for _, place in places_of(step)), at)
    return None if name is None else plan.grounded.get(name)


def _box_at(name: str | None, point: Point, plan: Plan, view: View, carried: Box | None) -> Box:
    """The box of a thing at a point; elsewhere a window as large as what is carried there."""
    target = None if name is None else plan.grounded.get(name)
    if target is not None and target.box is not None and target.target.kind == "object" and target.box.contains(point):
        return target.box
    return point_window(point, carried, view)


def _used(later: Sequence[PlannedAction], plan: Plan, view: View) -> list[Spot]:
    """The things that the actions still to run rely on."""
    names = dict.fromkeys(place.target for planned in later for _, place in places_of(planned.step))
    found = []
    for name in names:
        item = plan.grounded.get(name)
        if item is not None and item.box is not None and item.target.kind == "object" and item.view_id == view.id:
            found.append(Spot(f"{name} ({item.target.words})", item.box))
    return found
