"""One table with an arm at it, in simulated time: physics, pictures, and what has happened. Holds the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any
from weakref import proxy

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import offers
from wonderful_team.core.values import Instruction
from wonderful_team.sims.arms.cameras import SIZE_PX, PinholeLens, lenses, moved, sensed
from wonderful_team.sims.arms.disturbances import Disturbances, both, check_possible
from wonderful_team.sims.arms.model import BuiltArm, build
from wonderful_team.sims.arms.options import Asked
from wonderful_team.sims.arms.reports import Moved
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.arms.rows import find_arm
from wonderful_team.sims.arms.scene import ArmScene, Sorting
from wonderful_team.sims.tabletop.appearance import PLAIN_LIGHT, Look
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses, footprint_of
from wonderful_team.sims.tabletop.model import TIMESTEP_S, Thing
from wonderful_team.sims.tabletop.registering import TabletopTask, filled
from wonderful_team.sims.tabletop.rules import Rules
from wonderful_team.sims.tabletop.seeds import generator
from wonderful_team.sims.tabletop.simulated_table import SimulatedTable

CALIBRATION_M, CALIBRATION_RAD = (0.002, 0.004, 0.008), (0.002, 0.004, 0.008)
"""How far off planners are told that the top camera stands, along both of its axes, and how it is rolled, by tier."""
QUIET_M_S = 0.01
REST_LIMIT_S = 1.5


@dataclass(frozen=True)
class Grip:
    """One closing of the fingers.

    Attributes:
        at: The thing under the tool's point, or None; the truth, which is not told to the robot.
        held: Things that both fingers touched afterwards.
    """

    at: str | None
    held: tuple[str, ...]


class ArmTable(SimulatedTable):
    """Everything that a world keeps from planners.

    Attributes:
        things: As they stood at the start, by name.
        grips: Every closing of the fingers so far.
    """

    def __init__(self, task: TabletopTask, seed: int, asked: Asked) -> None:
        super().__init__()
        self.task, self.seed, self.asked = task, seed, asked
        scene = task.scene(seed, made=partial(ArmScene, other_container="wrongbox" in asked.disturbances))
        assert isinstance(scene, ArmScene)
        check_possible(task.name, scene, asked.disturbances)
        self.scene, self.work = scene, scene.work
        self.things: Mapping[str, Thing] = {thing.name: thing for thing in scene.things}
        self.rules = Rules(
            tuple(tuple(phase) for phase in scene.phases if phase),
            (),
            task.horizon,
            ends_when_reached=False,
        )
        row = find_arm(asked.arm)
        self.built: BuiltArm = build(
            row,
            scene.things,
            Look(self._lenses(seed, asked), PLAIN_LIGHT),
            SIZE_PX,
            lambda thing: thing.body.kind != "area",
            None if self.work is None else self.work.furnish,
            None if self.work is None else self.work.decorate,
        )
        self._state = mj.MjData(self.built.model)
        mj.mj_forward(self.built.model, self._state)
        self.robot = Robot(self.built, self._state)
        self.rest()
        # What the robot and the built scene call holds these weakly: in a circle a world's memory would stay until the collector comes by.
        self.disturbances = Disturbances(proxy(self), dict(asked.disturbances))
        if self.work is not None:
            self.work.begin(proxy(self.built), self._state, proxy(self.robot))
            self.robot.each_step = self.work.step
            self.rest()
        if asked.disturbances:
            watched = [self.disturbances.step] if self.work is None else [self.work.step, self.disturbances.step]
            self.robot.each_step = both(*watched)
        self._state.time = 0.0
        self._start = self.poses()
        self.grips: list[Grip] = []
        self._looks = 0

    @staticmethod
    def _lenses(seed: int, asked: Asked) -> Any:
        found = lenses()
        if asked.camera:
            assert isinstance(found["top"], PinholeLens)
            found["top"] = moved(found["top"], generator(seed, "camera", asked.camera), asked.camera)
        if asked.calibration:
            rng, step = generator(seed, "calibration", asked.calibration), asked.calibration - 1
            signs = rng.choice([-1.0, 1.0], size=3)
            wrong_m = (CALIBRATION_M[step] * signs[0], CALIBRATION_M[step] * signs[1])
            found["top"] = replace(found["top"], wrong_m=wrong_m, wrong_rad=CALIBRATION_RAD[step] * signs[2])
        return found

    @property
    def mover(self) -> Robot:
        return self.robot

    @property
    def start(self) -> Poses:
        return self._start

    def held(self) -> tuple[str, ...]:
        """Things that both fingers touch now."""
        bodies = self.robot.held_bodies()
        return tuple(name for name in self.things if self.built.body_id(name) in bodies)

    def touched(self) -> tuple[str, ...]:
        """Things that anything of the robot touches now."""
        contact, bodies = self._state.contact, self.built.model.geom_bodyid
        pairs = bodies[contact.geom[: self._state.ncon]].reshape(-1, 2)
        met = {
            int(b if a in self.built.bodies else a)
            for a, b in pairs
            if (a in self.built.bodies) != (b in self.built.bodies)
        }
        return tuple(name for name in self.things if self.built.body_id(name) in met)

    def rest(self) -> None:
        """Let time pass until the things lie still, or the limit is reached."""
        quiet = 0
        for _ in range(round(REST_LIMIT_S / TIMESTEP_S / 10)):
            self.robot.rest(10 * TIMESTEP_S)
            speeds = [self._speed(thing) for thing in self.things.values()]
            quiet = quiet + 1 if max(speeds, default=0.0) < QUIET_M_S else 0
            if quiet >= 4:
                return

    def _speed(self, thing: Thing) -> float:
        body = self.built.body_id(thing.name)
        return float(np.linalg.norm(self._state.cvel[body][3:]))

    def grip(self, closed: bool, tight: bool) -> Moved:
        """Close or open the fingers, and keep in mind what came of it."""
        x, y, _ = self.robot.tool_m
        held = self.held() if self.robot.closed else ()
        moved = self.robot.grip(closed, tight)
        if closed:
            self.grips.append(Grip(self.thing_at(float(x), float(y)), self.held()))
        else:
            self.rest()
            self.disturbances.let_go(held)
        return moved

    def put(self, name: str, position_m: Array, yaw_rad: float) -> None:
        if offers(self.work, Sorting):
            self.work.placed_by_hand(name)
        super().put(name, position_m, yaw_rad)

    def wanted_things(self) -> tuple[str, ...]:
        """Things that have to go into or onto something, in the order in which the task names them."""
        if offers(self.work, Sorting):
            return self.work.wants
        return tuple(dict.fromkeys(goal.thing for goal in self.rules.goals if goal.inside))

    def arrived(self, name: str) -> bool:
        """Whether such a thing is where it has to go."""
        if offers(self.work, Sorting):
            return self.work.arrived(name, self.poses())
        return all(goal.met(self.poses(), self.things) for goal in self.rules.goals if goal.thing == name)

    def thing_at(self, x_m: float, y_m: float) -> str | None:
        """The highest thing over a point of the table."""
        from shapely import Point

        poses = self.poses()
        under = [
            (float(poses[name].position_m[2]) + thing.body.height_m, name)
            for name, thing in self.things.items()
            if footprint_of(thing, poses[name]).covers(Point(x_m, y_m))
        ]
        return max(under)[1] if under else None

    def look(self, camera: str) -> Callable[[], tuple[Array, Array]]:
        """Drawn at once, since ink and noise depend on when; the depth sensor has its faults."""
        drawn = self.draw(camera)
        depth_m = drawn.depth_m
        if self.asked.depth:
            self._looks += 1
            depth_m = sensed(depth_m, self.asked.depth, generator(self.seed, "depth", self._looks))
        return lambda: (drawn.rgb, depth_m)

    @cached_property
    def _instruction(self) -> Instruction:
        return Instruction(filled(self.task.instruction, self.scene.words))

    def instruction(self) -> Instruction:
        """Words with their slots filled."""
        return self._instruction
