"""Bottles with screw caps: a hinge with friction, coupled to a slide by the pitch of the thread, until the cap comes free.

The model of the thread: a small body on each bottle turns about its axis against friction and rises with every turn, and the cap is
welded to it. Once it has been turned anticlockwise by `FREE_RAD`, the weld is let go for good: the thread is through, and the cap is a free
body that lies loosely on the neck. Clockwise it is screwed down already. Nothing else keeps the bottle but its weight and its rubber foot.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from shapely import Point

from wonderful_team.core.actions import Action, RotateGripper
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.bottle import OFF_M, Bottles
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.arms.scene import ROOM_M
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses, footprint_of, off_table
from wonderful_team.sims.tabletop.model import Thing

FREE_RAD = math.radians(240.0)
"""So far a cap has to be turned anticlockwise before it comes free."""
PITCH_M = 0.003
"""How far it rises in one turn [m]."""
FRICTION_N_M = 0.06
"""Torque that turns it: a cap that was closed by hand, loosely [N m]."""
BOTTLE_KG, FOOT = 0.6, (1.1, 0.01, 0.0001)
"""A full bottle, and the friction of its rubber foot."""
GAP_M = 0.0003
"""A cap that is screwed down does not rub on the neck [m]."""
STRIPE_M = 0.0004
"""Half the thickness of the stripe on a cap, by which its turning is seen [m]."""
STAYS_M = 0.05
"""The bottle may be pushed this far while it is opened [m]."""
ON_M = 0.03
"""A cap whose middle is no farther from the bottle's axis lies on the bottle [m]."""
TURN_DEG, GRASP_M = 270.0, 0.017
"""How far the oracle turns, and how far below the cap's top it grips [m]."""
STIFF, MOST_DEG = (0.004, 1.0), 3600.0
"""How stiffly thread and cap hang together, and the end of the hinge's range, which nothing reaches [degrees]."""


class Capped(Bottles):
    """One of the bottles is opened.

    Attributes:
        caps: The cap of each bottle, by the bottle's name.
        free: Bottles whose cap has come off its thread.
    """

    facts = (
        f"A screw cap opens anticlockwise, seen from above, and comes free after {math.degrees(FREE_RAD):.0f} degrees; then it lifts off. "
        "The bottle stands by its own weight and is not held."
    )

    def __init__(self, wanted: Thing, caps: Mapping[str, Thing], things: Sequence[Thing]) -> None:
        super().__init__(wanted, things)
        self.caps = caps
        self.free: set[str] = set()

    def furnish(self, spec: Any) -> None:
        """A thread for every cap, and bottles that are full."""
        for bottle in self.bottles:
            body, cap = spec.body(bottle.name), self.caps[bottle.name]
            pieces = [geom for geom in body.geoms if geom.contype]
            for geom in pieces:
                geom.mass, geom.friction[:] = BOTTLE_KG / len(pieces), FOOT
            spec.body(cap.name).add_geom(
                type=mj.mjtGeom.mjGEOM_BOX, size=(0.0015, cap.body.radius_m - 0.002, STRIPE_M), mass=0.0, contype=0, conaffinity=0,
                pos=(0.0, 0.0, cap.body.height_m), rgba=(0.25, 0.25, 0.28, 1.0),
            )  # fmt: skip
            thread = body.add_body(name=f"thread {bottle.name}", pos=(0.0, 0.0, cap.z_m))
            thread.add_geom(
                type=mj.mjtGeom.mjGEOM_SPHERE, size=(0.005, 0, 0), mass=0.005, group=3, contype=0, conaffinity=0, rgba=(0, 0, 0, 0)
            )  # fmt: skip
            rise, turn = f"rise {bottle.name}", f"turn {bottle.name}"
            thread.add_joint(name=rise, type=mj.mjtJoint.mjJNT_SLIDE, axis=(0, 0, 1), armature=0.001)
            thread.add_joint(
                name=turn, type=mj.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1), armature=1e-4, damping=1e-3,
                frictionloss=FRICTION_N_M, limited=True, range=(0.0, MOST_DEG),
            )  # fmt: skip
            screw = spec.add_equality(
                type=mj.mjtEq.mjEQ_JOINT, objtype=mj.mjtObj.mjOBJ_JOINT, name1=rise, name2=turn, solref=STIFF
            )
            screw.data[:] = 0.0
            screw.data[1] = PITCH_M / (2 * math.pi)
            weld = spec.add_equality(
                name=f"cap of {bottle.name}", type=mj.mjtEq.mjEQ_WELD, objtype=mj.mjtObj.mjOBJ_BODY,
                name1=f"thread {bottle.name}", name2=cap.name, solref=STIFF,
            )  # fmt: skip
            weld.data[:] = 0.0
            weld.data[6] = weld.data[10] = 1.0

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        super().begin(built, state, robot)
        model, obj = built.model, mj.mjtObj
        self._turns, self._welds = {}, {}
        for bottle in self.bottles:
            joint = int(mj.mj_name2id(model, obj.mjOBJ_JOINT, f"turn {bottle.name}"))
            self._turns[bottle.name] = int(model.jnt_qposadr[joint])
            self._welds[bottle.name] = int(mj.mj_name2id(model, obj.mjOBJ_EQUALITY, f"cap of {bottle.name}"))

    def turned_rad(self, bottle: str) -> float:
        """How far a bottle's thread was turned anticlockwise [rad]."""
        return float(self._state.qpos[self._turns[bottle]])

    def watch(self) -> None:
        """Let go of caps whose thread is through."""
        super().watch()
        for bottle, weld in self._welds.items():
            if bottle not in self.free and self.turned_rad(bottle) >= FREE_RAD:
                self._state.eq_active[weld] = 0
                self.free.add(bottle)

    def score(self, poses: Poses) -> Score:
        name, cap = self.wanted.name, self.caps[self.wanted.name]
        others = self.free - {name}
        if others:
            return Score(False, "wrong object", f"the {', '.join(sorted(others))} was opened")
        wrong = self.disturbed(poses)
        if wrong is not None:
            return wrong
        problem = self._bottle_problem(poses) or self._cap_problem(cap, poses)
        if not problem:
            return Score(True, None, "the cap is off, and the bottle stands")
        tried = name in self.free or self.turned_rad(name) > math.radians(5.0) or name in self.lifted
        return Score(False, "execution" if tried or self.fallen(name, poses) else "plan", problem)

    def _bottle_problem(self, poses: Poses) -> str:
        name, moved_m = self.wanted.name, self.moved_m(self.wanted.name, poses)
        if self.fallen(name, poses):
            return f"the {name} has fallen"
        if name in self.lifted:
            return f"the {name} was lifted off the table"
        if moved_m > STAYS_M:
            return f"the {name} was pushed {1000 * moved_m:.0f} mm (at most {1000 * STAYS_M:.0f} mm)"
        return ""

    def _cap_problem(self, cap: Thing, poses: Poses) -> str:
        name, at = self.wanted.name, poses[cap.name].position_m
        if name not in self.free:
            said = f"{math.degrees(self.turned_rad(name)):z.0f} of {math.degrees(FREE_RAD):.0f} degrees"
            return f"the cap of the {name} is on its thread: it was turned {said}"
        if off_table(poses[cap.name]) or float(at[2]) < -OFF_M:
            return f"the cap of the {name} fell off the table"
        if self.held(cap.name):
            return f"the cap of the {name} was not let go"
        away_m = float(np.hypot(*(at - poses[name].position_m)[:2]))
        if away_m <= ON_M or float(at[2]) > self.wanted.body.height_m / 2:
            return f"the cap of the {name} is loose, and still lies on it"
        return ""

    def oracle(self, poses: Poses) -> Sequence[Action]:
        cap = self.caps[self.wanted.name]
        if self.score(poses).success or self._bottle_problem(poses):
            return []
        at, yaw, grip = self.grasp(cap, poses, GRASP_M, tight=True)
        loose = self.wanted.name in self.free
        turn = 0.0 if loose else math.radians(TURN_DEG) - self.turned_rad(self.wanted.name)
        end = np.array([*self._free_place(cap, poses), cap.body.height_m - GRASP_M + 0.004])
        up = self.to(at, yaw + turn, 0.12)
        return [*grip, *([] if loose else [RotateGripper(turn)]), up, *self.put(end, yaw + turn)]

    def _free_place(self, cap: Thing, poses: Poses) -> Array:
        """A point of the table with room for the cap and the fingers, the nearest to the bottle, shape (2,) [m]."""
        low_x, low_y, high_x, high_y = ROOM_M
        taken = [footprint_of(thing, poses[name]) for name, thing in self.things.items() if thing is not cap]
        xs, ys = np.meshgrid(np.linspace(low_x, high_x, 9), np.linspace(low_y, high_y, 15))
        places = np.column_stack([xs.ravel(), ys.ravel()])
        room = np.array([min(Point(place).distance(shape) for shape in taken) for place in places])
        away = np.linalg.norm(places - poses[self.wanted.name].position_m[:2], axis=1)
        return np.asarray(places[np.argmin(away + 10.0 * np.maximum(0.0, 0.1 - room))])
