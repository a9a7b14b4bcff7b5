"""A plan drawn over the main view: boxes of targets, numbered arrows of steps, arcs of turns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import CloseStep, MoveStep, OpenStep, PickPlaceStep
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point, PointMark, TurnMark
from wonderful_team.core.values import GroundedTarget, PlannedAction, View
from wonderful_team.images import swept_width
from wonderful_team.images.turn_marks import FROM_TO, action_turns, stays

SAME_PX = 12.0
"""What is put down nearer to where it was taken up is drawn as a dot [px of the picture]."""


def plan_drawn(scene: SceneShown, grounded: Mapping[str, GroundedTarget], actions: Sequence[PlannedAction]) -> Picture:
    """The main view with every target's box and label, and the steps as numbered arrows.

    A turn is an arc with its degrees and the turned box; of a thing that is turned where it lies there is no arrow, only a
    dot where it is held. What a gripper carries is one arrow.
    """
    view = scene.views[0]
    turns = {mark.label: _on(view, mark) for mark in action_turns(actions, grounded, scene.view)}
    arrows = []
    for number, action in enumerate(actions, start=1):
        path, label = _path(view, action), str(number)
        if len(path) < FROM_TO:
            continue
        if label in turns and stays(path, turns[label]):
            arrows.append(PathMark(path[:1]))
        else:
            carried = isinstance(action.step, PickPlaceStep)
            arrows.append(PathMark(path, label, _swept(scene, action), bowed=carried))
    arrows += gripped_ways(view, actions)
    drawn = mark_targets(view.named(f"{view.name} with the plan"), scene.view, grounded)
    return drawn.marked(*arrows, *turns.values())


def gripped_ways(picture: Picture, actions: Sequence[PlannedAction]) -> list[PathMark]:
    """What a gripper carries, from where it closes to where it next opens, labelled by the steps in which it goes down there.

    A dot alone where it closes and opens in the same place, or does not open again.
    """
    ways: list[PathMark] = []
    down: tuple[int, Point] | None = None
    held: tuple[int, Point] | None = None
    for number, action in enumerate(actions, start=1):
        step, path = action.step, _path(picture, action)
        if isinstance(step, MoveStep) and step.height == "at" and path:
            down = number, path[-1]
        elif isinstance(step, CloseStep) and held is None:
            held = down
        elif isinstance(step, OpenStep) and held is not None and down is not None:
            ways.append(_way(held, down))
            held = None
    return ways if held is None else [*ways, _way(held, held)]


def _way(held: tuple[int, Point], down: tuple[int, Point]) -> PathMark:
    (first, start), (last, end) = held, down
    if math.dist(start, end) < SAME_PX:
        return PathMark((start,), str(first))
    return PathMark((start, end), f"{first} to {last}", bowed=True)


def _on(picture: Picture, mark: TurnMark) -> TurnMark:
    """A turn [view px] in pixels of a picture."""
    at = picture.frame.point_to_picture
    return replace(mark, centre=at(mark.centre), corners=tuple(at(corner) for corner in mark.corners))


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
