"""A sponge and a plate: what the sponge has pressed on is clean, and how much of the plate that is, is judged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from wonderful_team.core.actions import Action, Home, Trajectory
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.held import GRIP_HALF_M, HeldTool
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.shapes import PLATE_M

SPONGE_HALF_M = (0.03, 0.02, 0.008)
"""Half the sides of what wipes [m]."""
SOFT = (0.008, 1.5)
"""Time constant and damping of its contacts: it gives by about 3 mm, and does not chatter."""
CELL_M = 0.004
"""Side of the cells that the plate is counted in [m]."""
COVERED_SHARE = 0.9
"""So much of the plate has to be wiped."""
MOVED_M = 0.03
"""A plate that was pushed farther than this was not wiped but shoved [m]."""
EVERY_STEPS = 5
FLOOR_M = PLATE_M[1]
"""Height of the plate over the table [m]."""
DIRT_RGBA = (0.45, 0.3, 0.12, 1.0)
OVER_M = 0.2
LANE_M = 0.03
"""Distance of the lanes of the oracle's path: less than the sponge is wide [m]."""
EDGE_M = 0.018


class Wiping(HeldTool):
    """The sponge wipes a plate.

    Attributes:
        plate: What is wiped.
        radius_m: Of the part of the plate that counts, round its middle [m].
        clean: Which of the cells have been wiped, shape (N,) bool.
    """

    name = "sponge"
    below_m = GRIP_HALF_M[2] + 2 * SPONGE_HALF_M[2]
    facts = (
        "Tool: a sponge of 6 x 4 cm that the gripper holds from the start. Every position is that of the middle of its underside. It cleans what it "
        "is pressed on while it is led over it; in the air it cleans nothing. There is nothing to pick up, and the gripper must stay closed."
    )

    def __init__(self, plate: Thing, radius_m: float) -> None:
        self.plate, self.radius_m = plate, radius_m
        side = np.arange(-radius_m, radius_m + CELL_M, CELL_M)
        cells = np.array([(x, y) for x in side for y in side if np.hypot(x, y) <= radius_m])
        self._cells = cells
        self.clean = np.zeros(len(cells), dtype=bool)
        self._count = 0

    def add_end(self, body: Any) -> None:
        body.add_geom(
            name="sponge", type=mj.mjtGeom.mjGEOM_BOX, size=SPONGE_HALF_M, pos=(0.0, 0.0, -GRIP_HALF_M[2] - SPONGE_HALF_M[2]),
            mass=0.01, group=0, condim=3, friction=(0.3, 0.005, 0.0001), priority=2, solref=SOFT, rgba=(0.95, 0.85, 0.3, 1.0),
        )  # fmt: skip

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        super().begin(built, state, robot)
        self._sponge = int(mj.mj_name2id(built.model, mj.mjtObj.mjOBJ_GEOM, "sponge"))
        self._plate_body = built.body_id(self.plate.name)
        self._start = np.array(state.xpos[self._plate_body][:2])

    def step(self) -> None:
        """Clean the cells under the sponge while it presses on the plate."""
        self._count += 1
        if self._count % EVERY_STEPS:
            return
        state, bodies = self._state, self._built.model.geom_bodyid
        pairs = state.contact.geom[: state.ncon]
        mine = (pairs == self._sponge).any(axis=1)
        if not mine.any() or not (bodies[pairs[mine]] == self._plate_body).any():
            return
        centre, turn = state.geom_xpos[self._sponge], state.geom_xmat[self._sponge].reshape(3, 3)
        away = self._where() - centre[:2]
        self.clean |= (np.abs(away @ turn[:2, 0]) <= SPONGE_HALF_M[0]) & (
            np.abs(away @ turn[:2, 1]) <= SPONGE_HALF_M[1]
        )

    def _where(self) -> Array:
        """Where the cells lie now, shape (N, 2) [m]."""
        return np.asarray(self._cells + self._state.xpos[self._plate_body][:2])

    def decorate(self, scene: Any) -> None:
        """The dirt that is left."""
        z = float(self._state.xpos[self._plate_body][2]) + FLOOR_M + 0.0005
        for (x, y), clean in zip(self._where()[::3], self.clean[::3], strict=True):
            if clean:
                continue
            if scene.ngeom >= scene.maxgeom:
                return
            geom = scene.geoms[scene.ngeom]
            size = np.array([CELL_M * 0.7, CELL_M * 0.7, 0.0004])
            box = mj.mjtGeom.mjGEOM_BOX
            mj.mjv_initGeom(geom, box, size, np.array([x, y, z]), np.eye(3).ravel(), np.array(DIRT_RGBA, np.float32))
            scene.ngeom += 1

    @property
    def covered(self) -> float:
        """Share of the plate that has been wiped."""
        return float(self.clean.mean())

    def score(self, poses: Poses) -> Score:
        pushed = float(np.hypot(*(poses[self.plate.name].position_m[:2] - self._start_m(poses))))
        if pushed > MOVED_M:
            return Score(
                False, "execution", f"the plate was pushed {1000 * pushed:.0f} mm (at most {1000 * MOVED_M:.0f} mm)"
            )
        said = f"{100 * self.covered:.0f} % of the plate was wiped (at least {100 * COVERED_SHARE:.0f} %)"
        if self.covered >= COVERED_SHARE:
            return Score(True, None, said)
        return Score(False, "plan" if not self.clean.any() else "execution", said)

    def _start_m(self, poses: Poses) -> Array:
        start = getattr(self, "_start", None)
        return np.array([self.plate.x_m, self.plate.y_m]) if start is None else np.asarray(start)

    def oracle(self, poses: Poses) -> Sequence[Action]:
        if self.score(poses).success:
            return []
        path = lanes(poses[self.plate.name].position_m[:2], self.radius_m)
        low = np.column_stack([path, np.full(len(path), FLOOR_M)])
        over = np.array([0.0, 0.0, OVER_M])
        return [Trajectory(np.vstack([low[:1] + over, low, low[-1:] + over])), Home()]


def lanes(centre: ArrayLike, radius_m: float) -> Array:
    """To and fro over a round plate, shape (N, 2) [m]: what is pressed on is wider than the gaps between the lanes."""
    count = int(np.ceil(2 * (radius_m - EDGE_M) / LANE_M)) + 1
    points: list[tuple[float, float]] = []
    for k, x in enumerate(np.linspace(-radius_m + EDGE_M, radius_m - EDGE_M, count)):
        half = max(0.0, float(np.sqrt(radius_m**2 - min(abs(x) - 0.01, radius_m) ** 2)) - SPONGE_HALF_M[1])
        ends = [(float(x), -half), (float(x), half)]
        points += ends if k % 2 == 0 else ends[::-1]
    return np.asarray(np.array(points) + np.asarray(centre))
