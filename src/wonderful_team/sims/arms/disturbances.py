"""What happens to things without the planner's doing, as asked for by a task's name: "lid_box/one@nudge=1".

A kind and a count: so many times it happens in an episode. What is hit, when and how follow from the seed and from what the robot
does; every one is kept, for the truth and the tests.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from shapely import box
from shapely.affinity import translate

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import offers
from wonderful_team.errors import ConfigError
from wonderful_team.sims.arms.held import HeldTool
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.arms.scene import ROOM_M, ArmScene, Sorting
from wonderful_team.sims.tabletop.goals import Poses, footprint_of
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.seeds import generator

DISTURBANCES = {
    "nudge": "after a thing was let go, the next one that has to go somewhere is pushed by 3 to 6 cm",
    "hand": "after a thing was let go, a hand puts the next one that has to go somewhere at another free place",
    "remove": "after a thing was let go, the next one that has to go somewhere is taken off the table for good",
    "wrongbox": "after a thing was let go where it has to go, a hand puts it into or onto another container or area; where there is "
    "none, at a free place",
    "slip": "a thing slips out of the fingers 3 cm after it was lifted",
}
"""Every kind with what it does."""
NUDGE_M = (0.03, 0.06)
FAR_M = 0.1
"""A hand puts a thing at least so far from where it was [m]."""
GAP_M = 0.03
"""Free table round where a thing ends that was pushed or put elsewhere [m]."""
SLIPS_M = 0.03
LOOSE_S = 0.25
"""How long the fingers give way when something slips [s]."""
EVERY_STEPS = 10
GONE_M = (0.5, 1.4, -0.06)
"""Where things are that were taken away: on the floor beside the table [m]."""


@dataclass(frozen=True)
class Happened:
    """One disturbance.

    Attributes:
        kind: One of DISTURBANCES.
        thing: What it hit.
        from_m, to_m: Where that was, and where it was put (x, y) [m].
    """

    kind: str
    thing: str
    from_m: tuple[float, float]
    to_m: tuple[float, float]


class Disturbed(Protocol):
    """What is disturbed: a table with an arm at it."""

    seed: int
    things: Mapping[str, Thing]
    robot: Robot

    @property
    def time_s(self) -> float: ...
    def poses(self) -> Poses: ...
    def held(self) -> tuple[str, ...]: ...
    def wanted_things(self) -> tuple[str, ...]: ...
    def arrived(self, name: str) -> bool: ...
    def put(self, name: str, position_m: Array, yaw_rad: float) -> None: ...


def check_possible(task: str, scene: ArmScene, kinds: Iterable[str]) -> None:
    """Whether disturbances can happen in a scene at all: a trial that nothing disturbs would count as one that was.

    Raises:
        ConfigError: One of them cannot; says which can.
    """
    carries = offers(scene.work, Sorting) or any(goal.inside for phase in scene.phases for goal in phase)
    grips = not isinstance(scene.work, HeldTool)
    can = DISTURBANCES if carries else {"slip": ""} if grips else {}
    for kind in kinds:
        if kind not in can:
            why = "nothing has to go from one place to another" if grips else "the tool is held from the start"
            raise ConfigError(f"{task}@{kind}: {why}, so it never happens; valid: {', '.join(can) or 'no disturbance'}")


@dataclass
class Disturbances:
    """Disturbs one table.

    Attributes:
        left: How often each kind is still to happen.
        happened: Every one so far.
    """

    table: Disturbed
    left: dict[str, int]
    happened: list[Happened] = field(default_factory=list)
    _closed_at_m: float | None = None
    _loose_until_s: float | None = None
    _count: int = 0

    def let_go(self, released: Sequence[str]) -> None:
        """The fingers have opened, and these things were in them."""
        if not released:
            return
        for kind in ("nudge", "hand", "remove"):
            name = self._next(released) if self.left.get(kind) else None
            if name is not None and self._move(kind, name):
                self.left[kind] -= 1
        wanted = self.table.wanted_things() if self.left.get("wrongbox") else ()
        name = next((name for name in released if name in wanted and self.table.arrived(name)), None)
        if name is not None and self._move("wrongbox", name):
            self.left["wrongbox"] -= 1

    def _next(self, released: Sequence[str]) -> str | None:
        """The first thing that still has to go somewhere; where nothing has, what was just let go."""
        wanted = self.table.wanted_things()
        open_ones = [name for name in wanted if not self.table.arrived(name)]
        return next(iter(open_ones or [name for name in released if name in wanted]), None)

    def _move(self, kind: str, name: str) -> bool:
        table, poses = self.table, self.table.poses()
        rng = generator(table.seed, f"disturbance {kind}", len(self.happened))
        pose = poses[name]
        end: Array | None
        if kind == "remove":
            end = np.array(GONE_M)
        elif kind == "wrongbox" and (other := self._other_container(name, rng)) is not None:
            end = other
        else:
            end = self._place(name, pose, rng, NUDGE_M if kind == "nudge" else None)
        if end is None:
            return False
        height = float(pose.position_m[2]) if kind == "nudge" else float(end[2])
        yaw = float(pose.yaw_rad) if kind not in ("hand", "wrongbox") else float(rng.uniform(-math.pi, math.pi))
        before = (float(pose.position_m[0]), float(pose.position_m[1]))
        self.happened.append(Happened(kind, name, before, (float(end[0]), float(end[1]))))
        table.put(name, np.array([end[0], end[1], height]), yaw)
        return True

    def _other_container(self, name: str, rng: np.random.Generator) -> Array | None:
        """The middle of a container or area in or on which nothing lies, over its top, shape (3,) [m]; None where there is none."""
        table, poses = self.table, self.table.poses()
        others = [footprint_of(t, poses[n]).convex_hull for n, t in table.things.items() if not _holds(t)]
        free = []
        for other, thing in table.things.items():
            if _holds(thing) and all(footprint_of(thing, poses[other]).convex_hull.disjoint(one) for one in others):
                x, y, z = (float(value) for value in poses[other].position_m)
                free.append(np.array([x, y, z + thing.body.height_m]))
        return free[int(rng.integers(len(free)))] if free else None

    def _place(self, name: str, pose: Pose, rng: np.random.Generator, by_m: tuple[float, float] | None) -> Array | None:
        """A free place near by or anywhere else, shape (3,) [m]; None when none was found."""
        table, poses = self.table, self.table.poses()
        x, y = float(pose.position_m[0]), float(pose.position_m[1])
        own = translate(footprint_of(table.things[name], pose).convex_hull, -x, -y)
        others = [footprint_of(t, poses[n]).convex_hull for n, t in table.things.items() if n != name]
        room = box(*ROOM_M)
        for _ in range(200):
            if by_m is not None:
                turn, far = rng.uniform(-math.pi, math.pi), rng.uniform(*by_m)
                p, q = x + far * math.cos(turn), y + far * math.sin(turn)
            else:
                p, q = rng.uniform(ROOM_M[0], ROOM_M[2]), rng.uniform(ROOM_M[1], ROOM_M[3])
            placed = translate(own, p, q)
            far_enough = by_m is not None or math.dist((p, q), (x, y)) >= FAR_M
            if far_enough and room.covers(placed) and all(placed.distance(other) >= GAP_M for other in others):
                return np.array([p, q, 0.0])
        return None

    def step(self) -> None:
        """Called after every step of physics: lets a thing slip once it is in the air."""
        self._count += 1
        if not self.left.get("slip") and self._loose_until_s is None:
            return
        if self._count % EVERY_STEPS:
            return
        robot, now = self.table.robot, self.table.time_s
        if self._loose_until_s is not None:
            if now >= self._loose_until_s:
                robot.tighten()
                self._loose_until_s = None
            return
        if not robot.closed:
            self._closed_at_m = None
            return
        height = float(robot.tool_m[2])
        self._closed_at_m = height if self._closed_at_m is None else min(self._closed_at_m, height)
        held = self.table.held() if height > self._closed_at_m + SLIPS_M else ()
        if held:
            at = self.table.poses()[held[0]].position_m
            spot = (float(at[0]), float(at[1]))
            self.happened.append(Happened("slip", held[0], spot, spot))
            self.left["slip"] -= 1
            self._loose_until_s = now + LOOSE_S
            robot.loosen()


def _holds(thing: Thing) -> bool:
    return thing.body.kind in ("base", "area")


def both(*calls: Any) -> Any:
    """One function that calls several, in order."""

    def call() -> None:
        for one in calls:
            one()

    return call
