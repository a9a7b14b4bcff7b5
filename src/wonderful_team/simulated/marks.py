"""ListSubtasks and ChooseMotion: subtasks named for a detector, and their motions by marks, from truth."""

from __future__ import annotations

import math
from typing import Any

from wonderful_team.contracts import ChooseMotion, ListSubtasks, MotionMarks, SubtaskDraft, SubtaskList
from wonderful_team.core.pictures import Point
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.draft import Meaning, Written
from wonderful_team.simulated.places import place_of, point_of
from wonderful_team.simulated.seeing import Seen


def answer_list_subtasks(context: Context, question: ListSubtasks) -> SubtaskList:
    """One subtask for each move that truth asks for.

    Raises:
        NotUnderstoodError: One of the pictures is not true.
    """
    task = context.task(question.task)
    if task is None:
        raise NotUnderstoodError("one of the pictures of this task shows nothing that was ever there")
    subtasks = []
    for draft, step in zip(task.plan.subgoals, task.plan.steps, strict=True):
        thing, place = _ends(task.plan, step)
        named, other = _words(task.main, thing), "" if place is None else _words(task.main, place)
        pushed = step["kind"] == "push"
        subtasks.append(
            SubtaskDraft(
                instruction=draft.text,
                object_grasped="" if pushed else named,
                object_unattached=named if pushed else other,
                motion_direction="along the table" if pushed else "",
            )
        )
    return SubtaskList(reasoning=f"{len(subtasks)} moves lead from this table to what is asked", subtasks=subtasks)


def answer_choose_motion(context: Context, question: ChooseMotion) -> MotionMarks:
    """The marks nearest to the true points; a tile where a place is no thing.

    Raises:
        NotUnderstoodError: The picture is not true, or the subtask is another's.
    """
    seen = context.see(question.view)
    if seen is None or not seen.current:
        raise NotUnderstoodError("the picture with the marks shows nothing that was ever there")
    plan = context.plans(seen)[0]
    texts = [draft.text for draft in plan.subgoals]
    if question.instruction not in texts:
        raise NotUnderstoodError(f"{question.instruction!r} is no subtask of this model's plan")
    step = plan.steps[texts.index(question.instruction)]
    thing, place = _ends(plan, step)
    if step["kind"] == "push":
        return _pushed(question, seen, thing, plan.meanings[step["end"]["target"]])
    marks = {"grasp_keypoint": _nearest(question, "P", _point(thing, "pick", seen))}
    if place is not None and place.thing is not None and question.object_unattached:
        marks["target_keypoint"] = _nearest(question, "Q", _point(place, "place", seen))
    elif place is not None:
        marks["post_contact_tile"] = _tile(question, _point(place, "place", seen))
    return _marks(step["rotate_deg"], **marks)


def _ends(plan: Written, step: dict[str, Any]) -> tuple[Meaning, Meaning | None]:
    """What a step moves, and where to; None where it stays."""
    if step["kind"] == "push":
        return plan.meanings[step["start"]["target"]], None
    thing, place = plan.meanings[step["pick"]], step["place"]
    stays = place["how"] == "origin" and place["target"] == step["pick"] and bool(step["rotate_deg"])
    return thing, None if stays else plan.meanings[place["target"]]


def _words(seen: Seen, meaning: Meaning) -> str:
    """What a detector is to find; "" for a place that is no thing."""
    thing = None if meaning.thing is None else seen.thing(meaning.thing)
    return "" if meaning.thing is None else meaning.thing if thing is None else thing.words


def _point(meaning: Meaning, role: Any, seen: Seen) -> Point:
    place = place_of(meaning, seen)
    if place is None:
        raise NotUnderstoodError("a place lies outside of the view")
    return point_of(place, role, seen)


def _nearest(question: ChooseMotion, letter: str, point: Point) -> str:
    points = question.keypoints(letter).points
    if not points:
        return ""
    best = min(range(len(points)), key=lambda k: math.dist(points[k], point))
    return f"{letter}{best + 1}"


def _tile(question: ChooseMotion, point: Point) -> str:
    size = question.view.size_px
    return min(question.grid.names, key=lambda name: math.dist(question.grid.tile(name, size).centre, point))


def _pushed(question: ChooseMotion, seen: Seen, thing: Meaning, end: Meaning) -> MotionMarks:
    """From the tile behind a thing over its middle to the tile where it ends."""
    middle, goal = _point(thing, "place", seen), _point(end, "place", seen)
    far = math.dist(middle, goal) or 1.0
    step = seen.picture.size_px[0] / question.grid.columns
    behind = tuple(a - (b - a) / far * step * 0.6 for a, b in zip(middle, goal, strict=True))
    return _marks(
        0.0,
        target_keypoint=_nearest(question, "Q", middle),
        pre_contact_tile=_tile(question, (behind[0], behind[1])),
        post_contact_tile=_tile(question, goal),
    )


def _marks(turn: float, **said: str) -> MotionMarks:
    marks = dict.fromkeys(
        ("grasp_keypoint", "function_keypoint", "target_keypoint", "pre_contact_tile", "post_contact_tile"), ""
    )
    marks.update(said)
    heights = {f"{name}_contact_height": "same" if marks[f"{name}_contact_tile"] else "" for name in ("pre", "post")}
    return MotionMarks.model_validate({"reasoning": "the nearest marks", **marks, **heights, "target_angle": turn})
