"""A plan drawn over the main view: boxes of targets, numbered arrows of steps, arcs of turns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import PickPlaceStep
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point, PointMark, TurnMark
from wonderful_team.core.values import GroundedTarget, PlannedAction, View
from wonderful_team.images import swept_width
from wonderful_team.images.turn_marks import action_turns, stays


def plan_drawn(scene: SceneShown, grounded: Mapping[str, GroundedTarget], actions: Sequence[PlannedAction]) -> Picture:
    """The main view with every target's box and label, and the steps as numbered arrows.

    A turn is an arc with its degrees and the outline after it; of a thing that is turned where it lies there is no arrow.
    """
    view = scene.views[0]
    turns = {mark.label: _on(view, mark) for mark in action_turns(actions, grounded, scene.view)}
    arrows = []
    for number, action in enumerate(actions, start=1):
        path, label = _path(view, action), str(number)
        if len(path) >= 2 and not (label in turns and stays(path, turns[label])):
            carried = isinstance(action.step, PickPlaceStep)
            arrows.append(PathMark(path, label, _swept(scene, action), bowed=carried))
    drawn = mark_targets(replace(view, name=f"{view.name} with the plan"), scene.view, grounded)
    return drawn.marked(*arrows, *turns.values())


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
