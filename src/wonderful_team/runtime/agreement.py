"""Is an action what it says that it is: a known kind with sane numbers, and do step, sources and numbers agree?"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from shapely import LineString, Point

from wonderful_team.core.actions import (
    ACTIONS,
    STEPS,
    Action,
    CloseStep,
    Gripper,
    OpenStep,
    PickPlaceStep,
    Place,
    PushStep,
    Vocabulary,
    places_of,
    steps_for,
)
from wonderful_team.core.geometry import wrap_angle
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Slide
from wonderful_team.core.values import (
    MAX_ACTIONS,
    MAX_SUBGOALS,
    MAX_TARGETS,
    GateCheck,
    NumberSource,
    Plan,
    PlannedAction,
    View,
    size_problem,
)

MOST_TURN_RAD = 2 * math.pi
"""Largest turn of one action [rad]: once round. A larger number is a mistake, and a robot might really turn so far."""
SAME_M = 1e-6
"""Numbers that differ by less are the same but for rounding [m]."""
SAME_RAD = 1e-6
SAME_PX = 3.0
"""How far the pixel of a source may be from where its metres show: half a window of depth, rounding [px]."""


def size_checks(actions: Sequence[PlannedAction], plan: Plan | None) -> list[GateCheck]:
    """A refusal of a plan with more parts than are allowed."""
    parts = {} if plan is None else {"subgoals": len(plan.subgoals), "targets": len(plan.targets)}
    problem = size_problem(actions=len(actions), **parts)
    limit = f"{MAX_SUBGOALS} subgoals, {MAX_TARGETS} targets, {MAX_ACTIONS} actions"
    return [GateCheck(None, "size of plan", False, problem, limit)] if problem else []


def repeat_checks(actions: Sequence[PlannedAction]) -> list[GateCheck]:
    """A refusal of every step that puts a thing where the plan has put it already: where it was picked up, nothing lies.

    A plan that names several things alike reads so. A thing that was put elsewhere in between, is turned, or was pushed may
    well go there again.
    """
    found, lies = [], dict[str, tuple[Place, int]]()
    for index, planned in enumerate(actions):
        match planned.step:
            case PickPlaceStep(pick=name, place=place, rotate_deg=turn):
                there, since = lies.get(name, (None, 0))
                if there == place and turn == 0:
                    value = f"{name} lies there since action {since + 1}"
                    found.append(
                        GateCheck(index, "picked again", False, value, "a thing that lies elsewhere, or is turned")
                    )
                lies[name] = (place, index)
            case PushStep(start=start):
                lies.pop(start.target, None)
    return found


def class_checks(actions: Sequence[PlannedAction]) -> list[GateCheck]:
    """A refusal for every action or step of a class that is not ours: nothing is known of what it would do."""
    known = ", ".join(kind.__name__ for kind in ACTIONS.values())
    found = []
    for index, planned in enumerate(actions):
        foreign = [
            part
            for part, ours in (
                (planned, (PlannedAction,)),
                (getattr(planned, "step", None), tuple(STEPS.values())),
                (getattr(planned, "action", None), (*ACTIONS.values(), type(None))),
            )
            if type(part) not in ours
        ]
        if foreign:
            limit = f"a PlannedAction with one of our steps and one of {known}"
            found.append(GateCheck(index, "class of action", False, type(foreign[0]).__name__, limit))
    return found


def form_checks(planned: PlannedAction, vocabulary: Vocabulary) -> list[GateCheck]:
    """Whether it is an action that the world runs, with numbers that mean something."""
    action, step = planned.action, planned.step
    kind, valid = (step.kind, vocabulary.step_kinds) if action is None else (action.kind, vocabulary.kinds)
    checks = [GateCheck(None, "vocabulary", kind in valid, kind, ", ".join(valid))]
    if action is not None:
        checks.append(_finite(action))
        if checks[1].ok:
            checks += _turns(action)
            checks += [GateCheck(None, name, ok, value, limit) for name, ok, value, limit in action.settings()]
    return checks


def _finite(action: Action) -> GateCheck:
    flat = np.concatenate([np.zeros(0), *_numbers(action)])
    bad = int((~np.isfinite(flat)).sum())
    return GateCheck(None, "numbers", bad == 0, f"{len(flat) - bad} of {len(flat)} finite", "all finite")


def _numbers(value: Any) -> Iterator[Array]:
    """Every number of an action, whatever its fields are called."""
    for item in fields(value):
        content = getattr(value, item.name)
        if is_dataclass(content):
            yield from _numbers(content)
        elif not isinstance(content, str):
            yield np.ravel(content)


def _turns(action: Action) -> list[GateCheck]:
    turns = action.turns_rad()
    if not turns:
        return []
    most = max(turns, key=abs)
    margin = MOST_TURN_RAD + SAME_RAD - abs(most)
    limit = f"[{-MOST_TURN_RAD:.3f}, {MOST_TURN_RAD:.3f}] rad"
    return [GateCheck(None, "turn", margin >= 0, f"{most:.3g} rad", limit, f"{margin:+.3g} rad")]


def agreement_checks(planned: PlannedAction, view: View, reach_px: float) -> list[GateCheck]:
    """Whether step, sources and numbers of one action say the same.

    Args:
        planned: A step with its action, and where each of its points came from.
        view: The main view, to which the sources' pixels belong.
        reach_px: How far the pixel of a place may be from where its metres show: a thing is held at its pick point and
            placed by its centre.
    """
    action, step = planned.action, planned.step
    if action is None:
        return _outside(planned.sources, view, ())
    kinds = steps_for(action.kind)
    said = GateCheck(
        None, "step and action", not kinds or step.kind in kinds, f"{step.kind} for {action.kind}", ", ".join(kinds)
    )
    checks = [said] if not said.ok else [*_turn_agrees(planned), *_grip_agrees(planned)]
    if planned.sources:
        checks += _sources(planned, view, reach_px)
    return checks or [said]


def _turn_agrees(planned: PlannedAction) -> list[GateCheck]:
    turns, said = (
        () if planned.action is None else planned.action.turns_rad(),
        getattr(planned.step, "rotate_deg", None),
    )
    if len(turns) != 1 or said is None:
        return []
    stated = -math.radians(said) if math.isfinite(said) else math.nan
    off = abs(wrap_angle(turns[0] - stated)) if math.isfinite(stated) else math.inf
    value = f"{math.degrees(-turns[0]):.3f} degrees clockwise"
    return [GateCheck(None, "turn of the step", off <= SAME_RAD, value, f"{said:.3f} degrees, as the step says")]


def _grip_agrees(planned: PlannedAction) -> list[GateCheck]:
    action, step = planned.action, planned.step
    if not isinstance(action, Gripper):
        return []
    wanted = (
        "open" if isinstance(step, OpenStep) else "tight" if isinstance(step, CloseStep) and step.tight else "close"
    )
    return [GateCheck(None, "grip of the step", action.state == wanted, repr(action.state), repr(wanted))]


def _sources(planned: PlannedAction, view: View, reach_px: float) -> list[GateCheck]:
    assert planned.action is not None
    points = planned.action.points()
    if not points:
        return [GateCheck(None, "sources", False, f"{len(planned.sources)}", f"none for {planned.action.kind}")]
    roles, wanted = [source.role for source in planned.sources], [role for role, _ in points]
    if roles != wanted:
        return [GateCheck(None, "sources", False, ", ".join(roles), ", ".join(wanted))]
    problems = [
        problem
        for source, (role, point) in zip(planned.sources, points, strict=True)
        for problem in _source(planned, source, role, point, view, reach_px)
    ]
    value = "; ".join(problems) or f"{len(roles)} of {len(roles)} agree"
    checks = [GateCheck(None, "sources", not problems, value, "targets, pixels and metres of the step and the action")]
    # A tool that pushes may come down just outside of the picture.
    start_outside = (roles[0],) if isinstance(planned.action.motion(None), Slide) else ()
    return [*checks, *_outside(planned.sources, view, start_outside)]


def _source(
    planned: PlannedAction, source: NumberSource, role: str, point: Array, view: View, reach_px: float
) -> list[str]:
    found = []
    named = {"waypoint": "place"}.get(role, role)
    place = dict(places_of(planned.step)).get(named)
    if place is not None and source.target != place.target:
        found.append(f"{role} of {source.target}, but the step says {place.target}")
    if source.position_m is None:
        return [*found, f"{role} has no metres, but the action has"]
    off_m = float(np.abs(np.asarray(source.position_m)[: len(point)] - point).max())
    if not off_m <= SAME_M:
        return [*found, f"{role} is {off_m:.3f} m from the action's"]
    if view.camera is None or len(point) != 3:
        return found
    # A tool over a place shows away from the place in a slanted view: the pixel lies between the point and the table.
    ends = np.array([point, (point[0], point[1], min(0.0, float(point[2])))])
    try:
        (ax, ay), (bx, by) = view.camera.project(ends)
    except ValueError:
        return [*found, f"{role} lies behind the camera"]
    off_px = float(LineString([(ax, ay), (bx, by)]).distance(Point(source.point_px)))
    limit = SAME_PX + (reach_px if role in ("place", "waypoint") else 0.0)
    if not off_px <= limit:
        found.append(f"{role} shows {off_px:.0f} px from its pixel (limit {limit:.0f} px)")
    return found


def _outside(sources: Sequence[NumberSource], view: View, but: tuple[str, ...]) -> list[GateCheck]:
    """Pixels that are not in the picture: nothing is known of them, and nothing can be watched there."""
    width, height = view.size_px
    lost = [
        source
        for source in sources
        if source.role not in but and not (0 <= source.point_px[0] <= width and 0 <= source.point_px[1] <= height)
    ]
    if not lost:
        return []
    x, y = lost[0].point_px
    value = f"{lost[0].role} at ({x:.0f}, {y:.0f}) px"
    return [GateCheck(None, "inside the picture", False, value, f"[0, {width}] x [0, {height}] px")]
