"""Random tables, plans and edits, and rules of their own that say which of them nobody may admit.

The rules know the true blocks and nothing of the gate: exact rectangles instead of pixels of depth. They are the least
that a user relies on; the gate may be stricter.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from shapely import LineString, MultiPoint, Point, Polygon, affinity, box

from tests.runtime.gate_cases import CAMERA, CLEARANCE_M, HIGH, LOW, SIZE_PX, Block, Case, corners_of
from wonderful_team.core.actions import At, PickPlace, PickPlaceStep, Push, PushStep
from wonderful_team.core.values import PlannedAction

TOOL_M = 0.01
OVERLAP_M = 0.012
"""Two things overlap when a square of this side fits into what they share [m]: three pixels."""
SLACK_M = 1e-5
PUSHED_AWAY_M = 99.0
"""Where blocks count as lying once they have been pushed [m]: no rule knows where."""
SEEN = " (seen)"
"""Ends the names of rules that depth is needed for."""


def broken_rules(case: Case) -> list[str]:
    """Every rule that a case breaks; [] when there is none."""
    blocks, tool, found, places = list(case.blocks), case.tool_m, [], dict[int, str]()
    for number, planned in enumerate(case.actions, start=1):
        action = planned.action
        if not isinstance(action, PickPlace | Push):
            return [*found, f"{number}: not an action"]
        if isinstance(action, Push):
            problems, tool = _push(action, planned, blocks, tool, case)
        else:
            problems, tool = _pick_place(action, planned, blocks, tool, case, places)
        found += [f"{number}: {problem}" for problem in problems if case.depth or not problem.endswith(SEEN)]
        found += [f"{number}: {problem}" for problem in _sources(planned)]
    return found


def _pick_place(
    action: PickPlace, planned: PlannedAction, blocks: list[Block], tool: Any, case: Case, places: dict[int, str]
) -> tuple[list[str], Any]:
    found = _inside((action.pick_m, action.place_m))
    pick, place = action.pick_m, action.place_m
    carry = max(CLEARANCE_M, pick[2], place[2])
    if carry > HIGH[2] + SLACK_M or carry <= max(pick[2], place[2]):
        found.append("carried too low or too high")
    if abs(action.yaw_rad) > 2 * math.pi + SLACK_M:
        found.append("turns more than once round")
    step = planned.step
    stated = -math.radians(getattr(step, "rotate_deg", 0.0))
    if abs(math.remainder(action.yaw_rad - stated, 2 * math.pi)) > 1e-4:
        found.append("turns other than the step says")
    # At an edge it may be one block or another: of those that fit, and of what is surely below, the tool meets the highest first.
    over = [b for b in blocks if b.outline.buffer(0.008).contains(Point(pick[:2]))]
    sure = [b for b in over if b.outline.buffer(-0.008).contains(Point(pick[:2]))]
    unsure = [b for b in over if b not in sure and abs(pick[2] - b.top) <= 0.025]
    held = max([*unsure, *sure], key=lambda b: b.top, default=None)
    # Where something that was pushed lies no rule knows: it may be what is picked.
    pushed = any(b.x > PUSHED_AWAY_M / 2 for b in blocks)
    if held is not None and abs(pick[2] - held.top) > 0.025 and not pushed:
        found.append(f"picks at {pick[2]:.3f} m, the top is at {held.top:.3f} m{SEEN}")
    if not over and pick[2] > 0.025 and not pushed:
        found.append(f"picks in the air{SEEN}")
    shape = held.outline if held is not None else Point(pick[:2]).buffer(0.001)
    moved = affinity.rotate(shape, action.yaw_rad, origin=(pick[0], pick[1]), use_radians=True)
    moved = affinity.translate(moved, place[0] - pick[0], place[1] - pick[1])
    found += _keep_out(
        case, tool, (pick, place), MultiPoint([*corners_of(shape), *corners_of(moved)]).convex_hull, shape, moved
    )
    found += _in_the_way(action, planned, blocks, held, moved, carry, case, places)
    if held is not None:
        x, y = _centre(moved)
        places[blocks.index(held)] = planned.step.place.target if isinstance(planned.step, PickPlaceStep) else ""
        blocks[blocks.index(held)] = replace(held, x=x, y=y, yaw=held.yaw + action.yaw_rad, base=float(place[2]))
    return found, (float(place[0]), float(place[1]), carry)


def _in_the_way(
    action: PickPlace,
    planned: PlannedAction,
    blocks: list[Block],
    held: Block | None,
    moved: Any,
    carry: float,
    case: Case,
    places: dict[int, str],
) -> list[str]:
    """What stands where the thing goes, or on its way there."""
    step, pick, place, found = planned.step, action.pick_m, action.place_m, list[str]()
    others = [b for b in blocks if b is not held]
    name = step.place.target if isinstance(step, PickPlaceStep) else ""
    for other in others:
        # What a step names, and what the plan has put to the same named thing, share its room.
        number = blocks.index(other)
        shared = name.startswith("T") and isinstance(step, PickPlaceStep) and isinstance(step.place, At)
        meant = case.planned and (name == f"T{number}" or (shared and places.get(number) == name))
        if not meant and held is not None and _overlap(moved, other.outline) and other.top > place[2] + 0.015:
            found.append(f"puts it into a block of {other.top:.3f} m{SEEN}")
        unasked = case.planned and not meant and isinstance(step, PickPlaceStep) and isinstance(step.place, At)
        small = other.a < 0.07 and other.b < 0.07
        if unasked and small and held is not None and name.startswith("A") and abs(place[2] - other.top) < 0.005:
            if (
                other.top > 0.03
                and other.outline.buffer(-0.01).contains(Point(_centre(moved)))
                and _covers(moved, other)
            ):
                found.append(f"stacks it where nobody asked{SEEN}")
    support = max((b.top for b in others if b.outline.buffer(0.004).intersects(moved)), default=0.0)
    pushed = any(b.x > PUSHED_AWAY_M / 2 for b in others)
    if held is not None and not pushed and place[2] > support + 0.025:
        found.append(f"lets it go {place[2] - support:.3f} m over what is there{SEEN}")
    hanging = pick[2] - held.base if held is not None else 0.0
    way = LineString([pick[:2], place[:2]]) if math.dist(pick[:2], place[:2]) > 1e-9 else Point(pick[:2])
    for other in others:
        if other.outline.buffer(-0.012).intersects(way) and other.top > carry - hanging + 0.002:
            found.append(f"carries it against something{SEEN}")
    return found


def _push(action: Push, planned: PlannedAction, blocks: list[Block], tool: Any, case: Case) -> tuple[list[str], Any]:
    found = _inside((action.start_m, action.end_m))
    start, end = action.start_m, action.end_m
    name = planned.step.start.target if isinstance(planned.step, PushStep) else ""
    way = end[:2] - start[:2]
    length = float(np.linalg.norm(way))
    found += _keep_out(case, tool, (start, end), None, None, None)
    if length < 1e-6:
        return found, (float(end[0]), float(end[1]), CLEARANCE_M)
    landing = Point(start[:2] - way / length * TOOL_M).buffer(0.004)
    for index, other in enumerate(blocks):
        if not (case.planned and name == f"T{index}") and other.outline.buffer(-0.01).contains(landing):
            if other.top > start[2] + 0.02:
                found.append(f"comes down on a block{SEEN}")
    if case.planned and name.startswith("T"):
        # Where it comes to lie only a picture afterwards tells.
        number = int(name[1:])
        blocks[number] = replace(blocks[number], x=PUSHED_AWAY_M)
    return found, (float(end[0]), float(end[1]), CLEARANCE_M)


def _inside(points: Any) -> list[str]:
    ok = all(low - SLACK_M <= v <= high + SLACK_M for p in points for v, low, high in zip(p, LOW, HIGH, strict=True))
    return [] if ok else ["leaves the workspace"]


def _keep_out(case: Case, tool: Any, ends: Any, swept: Any, start: Any, end: Any) -> list[str]:
    found = []
    path = [ends[0][:2], ends[1][:2]]
    if tool is not None:
        path = [tool[:2], *path]
    line = LineString(path)
    for region in case.keep_out:
        shape = box(*region.box.as_tuple)
        if region.unit == "px":
            corners = CAMERA.on_plane(np.array(region.box.corners), 0.0)[:, :2]
            shape = Polygon(corners)
        if shape.distance(line) < TOOL_M - SLACK_M:
            found.append(f"the tool comes near {region.name}")
        # The load may be seen half a pixel smaller than it is.
        if swept is not None and any(part.buffer(-0.004).intersects(shape) for part in (start, end, swept)):
            found.append(f"the load enters {region.name}")
    return found


def _sources(planned: PlannedAction) -> list[str]:
    action, found = planned.action, []
    if not planned.sources:
        return []
    ends = (action.pick_m, action.place_m) if isinstance(action, PickPlace) else (action.start_m, action.end_m)  # type: ignore[union-attr]
    step = planned.step
    names = (step.pick, step.place.target) if isinstance(step, PickPlaceStep) else (step.start.target, step.end.target)  # type: ignore[union-attr]
    if len(planned.sources) != 2:
        return ["not two sources"]
    for source, end, name in zip(planned.sources, ends, names, strict=True):
        if source.position_m is None or np.abs(np.array(source.position_m) - end).max() > 1e-5:
            found.append("a source has other metres")
        if source.target != name:
            found.append("a source has another target")
        x, y = source.point_px
        inside = 0 <= x <= SIZE_PX[0] and 0 <= y <= SIZE_PX[1]
        if not inside and source.role != "push_start":
            found.append("a source is outside the picture")
        if math.dist(CAMERA.project([end])[0], source.point_px) > 40:
            found.append("a source shows elsewhere")
    return found


def _overlap(one: Any, other: Any) -> bool:
    return not one.intersection(other).buffer(-OVERLAP_M / 2).is_empty


def _covers(moved: Any, other: Block) -> bool:
    """Whether what is put there reaches over the edges of the block all round, so that it lies lower all round it."""
    return bool(moved.buffer(0.001).contains(other.outline))


def _centre(shape: Any) -> tuple[float, float]:
    return float(shape.centroid.x), float(shape.centroid.y)
