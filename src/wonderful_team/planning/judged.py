"""What the Checker is shown of one target: its box and points on a crop, how exact they have to be, and what to compare with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.contracts import JudgeBox
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Picture, Point, PointMark
from wonderful_team.core.values import PointRole
from wonderful_team.images import crop, whole
from wonderful_team.planning.jobs import Job

THUMBNAIL_PX = 640
"""Longest side of the whole view beside a crop."""
BESIDE = 1.0
"""Points farther from the box than this share of its longer side do not show on its crop."""


def judge_box(job: Job, box: Box, points: Mapping[PointRole, Point], name: str = "crop") -> JudgeBox:
    """The question about one box [view px] and the points that were chosen with it [view px]; `name` is the crop's."""
    reach = BESIDE * max(box.width, box.height)
    near = box.grown(reach, reach, reach, reach)
    drawn = {role: point for role, point in points.items() if near.contains(point) and job.view_box.contains(point)}
    also = [Box.around(point, 1, 1) for point in drawn.values()]
    shown = _boxed(job, crop(job.scene.view, box, name, also=also), box)
    marks = [PointMark(shown.frame.point_to_picture(point), said_of(role)) for role, point in drawn.items()]
    goal = _goal(job, box, also, marks)
    # Of a scene whose part is shown, the rest tells nothing of this box.
    shown_part = {} if goal is None else {goal[0]: (goal[1],)}
    return JudgeBox(
        job.target,
        shown.marked(*marks),
        tuple(replace(slot, pictures=shown_part.get(slot.name, slot.pictures)) for slot in job.examples),
        tuple(drawn),
        _whole_view(job, box),
        _alike(job),
        None if goal is None else goal[1],
    )


def said_of(role: PointRole) -> str:
    """A use as it stands at a point."""
    return role.replace("_", " ")


def _boxed(job: Job, picture: Picture, box: Box) -> Picture:
    return picture.marked(job.view_axes, BoxMark(picture.frame.box_to_picture(box)))


def _whole_view(job: Job, box: Box) -> Picture | None:
    """The whole view with the box, where only its surroundings tell the target from others like it."""
    if not job.target.where:
        return None
    shown = whole(job.scene.view, f"whole view with the box of {job.target.id}", max_side_px=THUMBNAIL_PX)
    return shown.marked(BoxMark(shown.frame.box_to_picture(box)))


def _alike(job: Job) -> Picture | None:
    """Another target in the same words whose box the Checker accepted; pictures of the instruction serve better."""
    if job.examples:
        return None
    same = (job.target.words.strip().lower(), job.target.part)
    for other, box in job.accepted.values():
        if other.id != job.target.id and (other.words.strip().lower(), other.part) == same:
            return crop(job.scene.view, box, f"crop of {other.id}", margin=0.15, min_side_px=224)
    return None


def _goal(job: Job, box: Box, also: list[Box], marks: Sequence[PointMark]) -> tuple[str, Picture] | None:
    """The scene that defines an area, and the part of it that the crop shows, with the same marks.

    Only of a scene as large as the view.
    """
    arranged = job.scene.arranged(job.target)
    if arranged is None:
        return None
    name, view = arranged
    shown = crop(view, box, f"{{{name}}}, the same part as the crop of {job.target.id}", also=also)
    return name, _boxed(job, shown, box).marked(*marks)
