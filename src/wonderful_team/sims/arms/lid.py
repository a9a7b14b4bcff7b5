"""A closed box: the lid has to be lifted off by its handle before anything goes in, and that is watched while it happens.

Done means, as things lie at the end: the box stands upright; the lid was lifted by the fingers, lies flat on the table and off
the box; every wanted thing lies wholly in the room inside the walls, below the rim, let go; nothing else is in or on the box.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from shapely import box
from shapely.affinity import translate

from wonderful_team.core.actions import Action, PickPlace
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.held import STIFF
from wonderful_team.sims.arms.model import BuiltArm, upright
from wonderful_team.sims.arms.oracle import arm_actions, grasp_yaw
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.arms.scene import ROOM_M
from wonderful_team.sims.arms.scoring import lying
from wonderful_team.sims.tabletop.goals import Poses, footprint_of, off_table
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.oracle import grasp_point
from wonderful_team.sims.tabletop.shapes import BOX_M

LIFTED_M = 0.01
"""Held so high over the rim, the lid is lifted; so far below the rim without that, it was pushed off [m]."""
STILL = 0.01
"""What turns and moves no faster than this lies still [rad/s, m/s]."""
LEANS_RAD = math.radians(10)
SLACK_M, DEPTH_M = 0.002, 0.01
"""What is in the box may touch its walls; its lowest point lies so far below the rim [m]."""
FLAT_M = 0.01
"""What lies on the table has its lowest point no higher than this [m]."""
EVERY_STEPS = 10
APART_M = 0.033
"""From the middle of the box to each of two things in it [m]."""
SPACES_M, STEP_M = (0.06, 0.02), 0.01
"""Free table that the oracle leaves round what it puts aside, where there is so much, or at least; how finely it looks for a place [m]."""


def corners_m(thing: Thing, pose: Pose) -> Array:
    """Corners of a thing as it lies, shape (N, 3) [m]."""
    a, b = shapely.get_coordinates(thing.body.footprint.convex_hull.exterior).T
    low = np.column_stack([-b, a, np.zeros_like(a)])
    return np.asarray(pose.apply(np.vstack([low, low + (0.0, 0.0, thing.body.height_m)])))


class ClosedBox:
    """The box, its lid and what is to go in: implements the Work and Sorting protocols; the robot keeps its gripper.

    Attributes:
        wants: Names of what has to go in.
        lifted: The fingers have lifted the lid off the rim since it last lay there.
        pushed: The lid has left the box without being lifted: for good.
        held: Names of everything that the fingers have held.
    """

    facts = ""

    def __init__(self, box_: Thing, lid: Thing, wanted: Sequence[Thing], others: Sequence[Thing]) -> None:
        self.box, self.lid, self.wanted, self.others = box_, lid, tuple(wanted), tuple(others)
        self.wants = tuple(thing.name for thing in wanted)
        self.things: Mapping[str, Thing] = {t.name: t for t in (box_, lid, *wanted, *others)}
        self.lifted = self.pushed = self.closed_once = False
        self.held: set[str] = set()
        self._count = 0

    def furnish(self, spec: Any) -> None:
        """A lid that does not sink into the rim it falls on: plate and walls are so thin that it would stick there, pushed from both sides."""
        for geom in (*spec.body(self.lid.name).geoms, *spec.body(self.box.name).geoms):
            if geom.contype:
                geom.solref[:2] = STIFF

    def decorate(self, scene: Any) -> None:
        """Nothing is left behind."""

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        self._built, self._state, self._robot = built, state, robot
        self._bodies = {built.body_id(name): name for name in self.things}

    def arrived(self, name: str, poses: Poses) -> bool:
        """Whether it is in there."""
        return self.is_in(name, poses)

    def placed_by_hand(self, name: str) -> None:
        """Somebody else has moved a thing: where the lid is now says nothing of how the robot took it off."""
        if name == self.lid.name:
            self.lifted = True

    def step(self) -> None:
        """Watch how the lid leaves the box."""
        self._count += 1
        if self._count % EVERY_STEPS:
            return
        held: set[str] = set()
        if self._robot.closed:
            self.closed_once = True
            held = {self._bodies[body] for body in self._robot.held_bodies() if body in self._bodies}
            self.held |= held
        of_box, of_lid = (self._built.body_id(thing.name) for thing in (self.box, self.lid))
        high = float(self._state.xpos[of_lid][2] - self._state.xpos[of_box][2]) - BOX_M[3]
        speed = float(np.abs(self._state.cvel[of_lid]).max())
        if self.lid.name in held and high > LIFTED_M:
            self.lifted = True
        elif high < -LIFTED_M:
            self.pushed |= not self.lifted
        elif self.lid.name not in held and abs(high) < LIFTED_M / 2 and speed < STILL:
            # It lies on the rim again: dropped there, it has to be lifted anew.
            self.lifted = False

    # Where things are.

    def is_in(self, name: str, poses: Poses) -> bool:
        """Whether a thing lies wholly in the room inside the walls, below the rim."""
        local = self._in_box(name, poses)
        room = BOX_M[0] + SLACK_M
        return bool((np.abs(local[:, :2]) <= room).all() and local[:, 2].min() < BOX_M[3] - DEPTH_M)

    def is_over(self, name: str, poses: Poses) -> bool:
        """Whether a thing covers any of the box, seen from above."""
        hull = shapely.MultiPoint(self._in_box(name, poses)[:, :2]).convex_hull
        return bool(hull.intersects(box(*(-BOX_M[2],) * 2, *(BOX_M[2],) * 2)))

    def _in_box(self, name: str, poses: Poses) -> Array:
        """Corners of a thing in the frame of the box, shape (N, 3) [m]."""
        away = corners_m(self.things[name], poses[name]) - poses[self.box.name].position_m
        yaw = poses[self.box.name].yaw_rad
        c, s = math.cos(yaw), math.sin(yaw)
        return np.column_stack([away[:, 0] * c + away[:, 1] * s, away[:, 1] * c - away[:, 0] * s, away[:, 2]])

    def touched(self) -> set[str]:
        """Things that any part of the robot touches now."""
        contact, bodies = self._state.contact, self._built.model.geom_bodyid
        pairs = bodies[contact.geom[: self._state.ncon]].reshape(-1, 2)
        met = {int(x) for pair in pairs if any(int(b) in self._built.bodies for b in pair) for x in pair}
        return {self._bodies[body] for body in met if body in self._bodies}

    # Judging.

    def score(self, poses: Poses) -> Score:
        missing = [*self._missing(poses)]
        if not missing:
            return Score(True, None, "the lid was lifted off and lies on the table; what was asked for is in the box")
        return Score(False, self._stage(poses), "; ".join(missing))

    def _missing(self, poses: Poses) -> Iterator[str]:
        """What is not as it should be, one reason after the other."""
        leans = upright(poses[self.box.name].quaternion_wxyz)
        if leans > LEANS_RAD:
            yield f"the box leans over by {math.degrees(leans):.0f} degrees (at most {math.degrees(LEANS_RAD):.0f})"
        touched = self.touched()
        wrong = self._lid_problem(poses)
        if wrong:
            yield wrong
        yield from (f"the {t.name} was not let go" for t in (self.lid, *self.wanted) if t.name in touched)
        for thing in self.wanted:
            if not self.is_in(thing.name, poses):
                lies = "on the box or leans on it" if self.is_over(thing.name, poses) else "not in the box"
                yield f"the {thing.name} is {lies}"
        for thing in self.others:
            if off_table(poses[thing.name]):
                yield f"the {thing.name} fell off the table"
            elif self.is_over(thing.name, poses):
                yield f"the {thing.name} is in or on the box and does not belong there"

    def _lid_problem(self, poses: Poses) -> str:
        """What is wrong with where the lid is, or with how it came there; "" when nothing is."""
        pose = poses[self.lid.name]
        lowest = float(corners_m(self.lid, pose)[:, 2].min())
        if off_table(pose):
            return "the lid fell off the table"
        if self.is_over(self.lid.name, poses):
            return "the lid is still on the box"
        if self.pushed or not self.lifted:
            return "the lid was pushed off the box, not lifted"
        if lowest > FLAT_M or upright(pose.quaternion_wxyz) > LEANS_RAD:
            return f"the lid does not lie flat on the table (its lowest point is {1000 * lowest:.0f} mm high)"
        return ""

    def _stage(self, poses: Poses) -> str:
        if any(self.is_over(thing.name, poses) and thing.name in self.held for thing in self.others):
            return "wrong object"
        if not self.held:
            return "grounding" if self.closed_once else "plan"
        return "execution" if self.lid.name in self.held else "plan"

    # Solving.

    def oracle(self, poses: Poses) -> Sequence[Action]:
        """What is in the way goes aside, the lid too; then what is wanted goes in. [] when it is done, or lost."""
        if self.pushed or upright(poses[self.box.name].quaternion_wxyz) > LEANS_RAD or self.score(poses).success:
            return []
        # What leans over is taken by its middle: where it would be held if it stood shows something else.
        fallen = {t.name for t in (*self.wanted, *self.others) if upright(poses[t.name].quaternion_wxyz) > LEANS_RAD}
        believed = {**poses, **{name: pose for name, pose in lying(poses, self.things).items() if name in fallen}}
        actions = list[Action]()
        asides = [t for t in (*self.wanted, *self.others) if self.is_over(t.name, poses)]
        asides = [t for t in asides if t not in self.wanted or not self.is_in(t.name, poses)]
        lid_aside = self.is_over(self.lid.name, poses) or corners_m(self.lid, poses[self.lid.name])[:, 2].min() > FLAT_M
        for thing in (*asides, *([self.lid] if lid_aside else [])):
            spot = self._free(thing, believed)
            if spot is None:
                return []
            actions += self._carry(thing, spot, believed)
        for thing, place in zip(self.wanted, self._places(believed), strict=True):
            if not self.is_in(thing.name, poses):
                actions += self._carry(thing, place, believed)
        return actions

    def _places(self, poses: Poses) -> list[tuple[float, float]]:
        """Where in the box each of the wanted things goes."""
        x, y, _ = (float(v) for v in poses[self.box.name].position_m)
        apart = APART_M if len(self.wanted) > 1 else 0.0
        return [(x, y + (2 * k - 1) * apart) for k in range(len(self.wanted))]

    def _carry(self, thing: Thing, to: tuple[float, float], believed: dict[str, Pose]) -> list[Action]:
        pose = believed[thing.name]
        pick, place = np.array(grasp_point(thing, pose)), np.array([*to, 0.0])
        if thing is self.lid:
            # Across the narrow sides of its handle.
            yaw: float | None = math.remainder(pose.yaw_rad + math.pi / 2, math.pi)
        else:
            yaw = grasp_yaw(thing, believed, self.things, self._built.row)
        believed[thing.name] = Pose.at(place, pose.yaw_rad)
        return arm_actions(PickPlace(pick, place, 0.0), yaw or 0.0, thing.body.height_m)

    def _free(self, thing: Thing, poses: Poses) -> tuple[float, float] | None:
        """The middle of a free place for a thing, turned as it is, the nearest to it."""
        x, y, _ = (float(v) for v in poses[thing.name].position_m)
        own = translate(footprint_of(thing, poses[thing.name]).convex_hull, -x, -y)
        others = [footprint_of(t, poses[n]).convex_hull for n, t in self.things.items() if n != thing.name]
        low_x, low_y, high_x, high_y = own.bounds
        room = (ROOM_M[0] - low_x, ROOM_M[1] - low_y, ROOM_M[2] - high_x, ROOM_M[3] - high_y)
        spots = [
            (float(p), float(q))
            for p in np.arange(room[0], room[2], STEP_M)
            for q in np.arange(room[1], room[3], STEP_M)
        ]
        nearest = sorted(spots, key=lambda spot: math.dist(spot, (x, y)))
        for space in SPACES_M:
            for p, q in nearest:
                placed = translate(own, p, q)
                if all(placed.distance(other) >= space for other in others):
                    return p, q
        return None
