"""Random tables with blocks, plans for them, and edits of plans, for the safety gate."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from shapely import Polygon, affinity, box

from wonderful_team.core.actions import PICK_PLACE, At, OriginOf, PickPlace, PickPlaceStep, Push, PushStep
from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.values import (
    GateReport,
    GroundedTarget,
    Instruction,
    KeepOut,
    Limits,
    NumberSource,
    Observation,
    Plan,
    PlannedAction,
    RobotState,
    Target,
    View,
)
from wonderful_team.runtime import check_gate

PX_PER_M = 256.0
SIZE_PX = (256, 128)
LOW, HIGH = (0.25, -0.5, 0.0), (0.75, 0.5, 0.3)
CLEARANCE_M = 0.2
CAMERA = AffineCamera(
    np.array([[0, PX_PER_M, 0, 0.5 * PX_PER_M], [PX_PER_M, 0, 0, -0.25 * PX_PER_M], [0, 0, -1.0, 1.0]])
)


@dataclass(frozen=True)
class Block:
    """A box on the table: centre, sides, how it is turned, where its underside is [m, rad]."""

    x: float
    y: float
    a: float
    b: float
    height: float
    yaw: float = 0.0
    base: float = 0.0

    @property
    def outline(self) -> Polygon:
        flat = box(-self.a / 2, -self.b / 2, self.a / 2, self.b / 2)
        return affinity.translate(affinity.rotate(flat, self.yaw, origin=(0, 0), use_radians=True), self.x, self.y)

    @property
    def top(self) -> float:
        return self.base + self.height


@dataclass(frozen=True, eq=False)
class Case:
    """A table and what somebody wants to run on it."""

    blocks: tuple[Block, ...]
    keep_out: tuple[KeepOut, ...]
    tool_m: tuple[float, float, float] | None
    actions: tuple[PlannedAction, ...]
    planned: bool
    depth: bool = True

    @property
    def limits(self) -> Limits:
        return Limits(LOW, HIGH, self.keep_out, CLEARANCE_M)

    @property
    def plan(self) -> Plan | None:
        if not self.planned:
            return None
        grounded = {f"T{k}": _target(k, block) for k, block in enumerate(self.blocks)}
        for planned in self.actions:
            place = getattr(planned.step, "place", getattr(planned.step, "end", None))
            if isinstance(place, At) and place.target.startswith("A"):
                grounded[place.target] = GroundedTarget(Target(place.target, "area", "free space"), "found", "top")
        seen = self.observation
        return Plan(Instruction("tidy up"), "planned", actions=self.actions, grounded=grounded, scene_hash=seen.hash)

    @cached_property
    def observation(self) -> Observation:
        robot = None if self.tool_m is None else RobotState(np.array(self.tool_m))
        heights = _heights(self.blocks) if self.depth else np.zeros((SIZE_PX[1], SIZE_PX[0]))
        grey = np.clip(120 + 1000 * heights, 0, 255).astype(np.uint8)
        rgb = np.repeat(grey[..., None], 3, axis=2)
        return Observation({"top": View("top", "top", 0.0, rgb, 1.0 - heights if self.depth else None, CAMERA)}, robot)


def judged(case: Case) -> GateReport:
    """What the gate says."""
    seen = case.observation
    words = replace(PICK_PLACE, kinds=("pick_place", "push"))
    return check_gate(
        case.actions, vocabulary=words, limits=case.limits, plan=case.plan, then=seen, now=seen, must_run=True
    )


def _target(number: int, block: Block) -> GroundedTarget:
    corners = [(x, y, block.top) for x, y in corners_of(block.outline)]
    pixels = [(float(u), float(v)) for u, v in CAMERA.project(corners)]
    name = f"T{number}"
    u, v = CAMERA.project([(block.x, block.y, block.top)])[0]
    return GroundedTarget(
        Target(name, "object", f"block {number}"), "found", "top", Box.bounding(pixels), {"pick": (float(u), float(v))}
    )


def _pixels() -> Any:
    columns, rows = np.meshgrid(np.arange(SIZE_PX[0]) + 0.5, np.arange(SIZE_PX[1]) + 0.5)
    return CAMERA.on_plane(np.column_stack([columns.ravel(), rows.ravel()]), 0.0)


_TABLE = _pixels()


def _heights(blocks: tuple[Block, ...]) -> Any:
    heights = np.zeros(len(_TABLE))
    for block in blocks:
        c, s = math.cos(block.yaw), math.sin(block.yaw)
        dx, dy = _TABLE[:, 0] - block.x, _TABLE[:, 1] - block.y
        hit = (np.abs(c * dx + s * dy) <= block.a / 2) & (np.abs(-s * dx + c * dy) <= block.b / 2)
        heights[hit] = np.maximum(heights[hit], block.top)
    return heights.reshape(SIZE_PX[1], SIZE_PX[0])


def random_case(rng: np.random.Generator, depth: bool = True) -> Case:
    """A table with two to five blocks, up to two keep-out regions, and one to three actions; about half are sound.

    Without depth, what stands where is not to be seen, and the rules about it are left out.
    """
    blocks = _random_blocks(rng)
    keep_out = tuple(_random_region(rng, k) for k in range(int(rng.choice([0, 0, 0, 1, 2]))))
    tool = None if rng.random() < 0.7 else tuple(float(v) for v in rng.uniform((0.3, -0.4, 0.15), (0.7, 0.4, 0.29)))
    planned = bool(rng.random() < 0.7)
    state, actions = list(blocks), []
    for number in range(int(rng.integers(1, 4))):
        action = _random_action(rng, state, number, planned, actions)
        actions.append(action)
    return Case(blocks, keep_out, tool, tuple(actions), planned, depth)  # type: ignore[arg-type]


def _random_blocks(rng: np.random.Generator) -> tuple[Block, ...]:
    blocks: list[Block] = []
    for _ in range(int(rng.integers(2, 6))):
        a, b = rng.uniform(0.03, 0.09, 2)
        x, y = rng.uniform((0.32, -0.42), (0.68, 0.42))
        block = Block(
            float(x), float(y), float(a), float(b), float(rng.uniform(0.02, 0.12)), float(rng.uniform(0, math.pi))
        )
        if all(block.outline.distance(other.outline) > 0.012 for other in blocks):
            blocks.append(block)
    return tuple(blocks)


def _random_region(rng: np.random.Generator, number: int) -> KeepOut:
    if rng.random() < 0.5:
        x, y = rng.uniform((0.25, -0.5), (0.7, 0.4))
        w, h = rng.uniform(0.01, 0.15, 2)
        return KeepOut(f"region {number}", Box(x, y, x + w, y + h), "m")
    x, y = rng.uniform((0, 0), (220, 100))
    w, h = rng.uniform(3, 40, 2)
    return KeepOut(f"region {number}", Box(x, y, x + w, y + h), "px")


def _random_action(
    rng: np.random.Generator, state: list[Block], number: int, planned: bool, before: list[PlannedAction]
) -> PlannedAction:
    index = int(rng.integers(len(state)))
    block = state[index]
    if rng.random() < 0.12:
        return _random_push(rng, block, index, number, planned)
    offset = rng.uniform(-0.25, 0.25, 2) * (block.a, block.b)
    c, s = math.cos(block.yaw), math.sin(block.yaw)
    pick = np.array([block.x + c * offset[0] - s * offset[1], block.y + s * offset[0] + c * offset[1], block.top])
    rotate = float(rng.choice([0.0, 0.0, 90.0, -45.0, 360.0]))
    kind = rng.choice(["free", "free", "free", "onto", "origin", "on top"])
    goal = rng.uniform((0.27, -0.48), (0.73, 0.48))
    place: Any = At(f"A{number}")
    height = 0.0
    if kind in ("onto", "on top"):
        other = int(rng.integers(len(state)))
        goal, height = np.array([state[other].x, state[other].y]), state[other].top
        place = At(f"T{other}") if kind == "onto" and other != index else place
        height = state[other].top if other != index else block.base
    elif kind == "origin":
        first = next((a for a in before if getattr(a.step, "pick", "") == f"T{index}"), None)
        start = None if first is None else first.action
        goal = np.array([block.x, block.y]) if start is None else start.pick_m[:2]  # type: ignore[union-attr]
        place = OriginOf(f"T{index}")
    yaw = -math.radians(rotate)
    shift = np.array([block.x, block.y]) - pick[:2]
    cy, sy = math.cos(yaw), math.sin(yaw)
    put = goal - np.array([cy * shift[0] - sy * shift[1], sy * shift[0] + cy * shift[1]])
    target = np.array([put[0], put[1], height])
    step = PickPlaceStep(f"G{number}", f"T{index}", place, rotate)
    action = PickPlace(pick, target, yaw)
    state[index] = replace(block, x=float(goal[0]), y=float(goal[1]), yaw=block.yaw + yaw, base=float(height))
    sources = (
        _source("pick", step.pick, pick, pick),
        _source("place", place.target, target, np.array([goal[0], goal[1], height])),
    )
    return PlannedAction(step, action, sources if planned else ())


def _random_push(rng: np.random.Generator, block: Block, index: int, number: int, planned: bool) -> PlannedAction:
    angle = rng.uniform(0, 2 * math.pi)
    way = np.array([math.cos(angle), math.sin(angle)])
    start = np.array([block.x, block.y]) - way * (math.hypot(block.a, block.b) / 2 + rng.uniform(-0.01, 0.03))
    end = start + way * rng.uniform(0.02, 0.3)
    first, last = np.append(start, block.base), np.append(end, block.base)
    step = PushStep(f"G{number}", At(f"T{index}"), At(f"A{number}"))
    sources = (_source("push_start", f"T{index}", first, first), _source("push_end", f"A{number}", last, last))
    return PlannedAction(step, Push(first, last), sources if planned else ())


def _source(role: str, target: str, point: Any, shown: Any) -> NumberSource:
    u, v = CAMERA.project([shown])[0]
    return NumberSource(role, target, (float(u), float(v)), tuple(float(x) for x in point), "random")  # type: ignore[arg-type]


def edited(case: Case, rng: np.random.Generator) -> tuple[str, Case]:
    """The same case with one thing changed, as a person or a program might change a plan: what, and the case."""
    index = int(rng.integers(len(case.actions)))
    planned = case.actions[index]
    action = planned.action
    what = str(
        rng.choice(
            [
                "pick",
                "place",
                "yaw",
                "height",
                "source px",
                "source m",
                "source target",
                "step",
                "region",
                "drop",
                "swap",
            ]
        )
    )
    if what in ("pick", "place") and isinstance(action, PickPlace):
        far = rng.normal(0, 0.15, 3) * (1, 1, 0.2)
        changed = {f"{what}_m": getattr(action, f"{what}_m") + far}
        planned = _agreeing(replace(planned, action=replace(action, **changed)), rng)
    elif what == "yaw" and isinstance(action, PickPlace):
        turn = float(rng.choice([1e300, 1e4, 7.0, -9.0, 0.3, math.pi]))
        planned = replace(planned, action=replace(action, yaw_rad=turn))
    elif what == "height" and isinstance(action, PickPlace):
        lift = np.array([0, 0, float(rng.choice([-0.05, 0.06, 0.15, 0.5]))])
        planned = _agreeing(replace(planned, action=replace(action, pick_m=action.pick_m + lift)), rng)
    elif what.startswith("source") and planned.sources:
        first, *rest = planned.sources
        if what == "source px":
            first = replace(first, point_px=(first.point_px[0] + 500, first.point_px[1]))
        elif what == "source m" and first.position_m is not None:
            x, y, z = first.position_m
            first = replace(first, position_m=(x + 0.05, y, z))
        else:
            first = replace(first, target="T99")
        planned = replace(planned, sources=(first, *rest))
    elif what == "step" and isinstance(planned.step, PickPlaceStep):
        planned = replace(planned, step=replace(planned.step, rotate_deg=planned.step.rotate_deg + 33.0))
    elif what == "region" and action is not None:
        at = action.place_m if isinstance(action, PickPlace) else action.end_m  # type: ignore[union-attr]
        region = KeepOut("added", Box(at[0] - 0.02, at[1] - 0.02, at[0] + 0.02, at[1] + 0.02), "m")
        return what, replace(case, keep_out=(*case.keep_out, region))
    elif what == "drop" and len(case.actions) > 1:
        return what, replace(case, actions=case.actions[:index] + case.actions[index + 1 :])
    elif what == "swap" and len(case.actions) > 1:
        return what, replace(case, actions=case.actions[::-1])
    actions = (*case.actions[:index], planned, *case.actions[index + 1 :])
    return what, replace(case, actions=actions)


def _agreeing(planned: PlannedAction, rng: np.random.Generator) -> PlannedAction:
    """Half of the time the sources are changed as well, so that only what is seen speaks against it."""
    if not planned.sources or rng.random() < 0.5 or not isinstance(planned.action, PickPlace):
        return planned
    pick, place = planned.action.pick_m, planned.action.place_m
    first, last = planned.sources
    return replace(
        planned, sources=(_source("pick", first.target, pick, pick), _source("place", last.target, place, place))
    )


def corners_of(shape: Any) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in shape.exterior.coords]
