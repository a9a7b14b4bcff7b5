"""A pen and its ink: where its tip touches, a line is left, and the line is what is judged."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from shapely import LineString, MultiLineString

from wonderful_team.core.actions import Action, Home, Trajectory
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.held import GRIP_HALF_M, STIFF, HeldTool
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses, footprint_of
from wonderful_team.sims.tabletop.model import Thing

TIP_M, LINE_M, FELT_M = 0.0025, 0.003, 1e-4
"""Radius of the tip, width of the line, and how far a felt tip gives and still leaves ink: the tip of the model is hard [m]."""
EVERY_M, LIFTED_S = 0.001, 0.03
"""The line is kept as points this far apart; a tip that touches nothing for so long has been lifted [s]."""
DRAWN_EVERY_M = 0.003
INK_RGBA = (0.08, 0.1, 0.45, 1.0)
OVER_M = 0.2


class Drawing(HeldTool):
    """The pen draws on a paper.

    Attributes:
        strokes: Lines of ink, each as points of the table in the base frame [m].
    """

    name = "pen"
    below_m = 0.055
    facts = (
        "Tool: a pen that the gripper holds from the start, its tip down. Every position is that of the tip. It leaves a line of ink, "
        f"{1000 * LINE_M:.0f} mm wide, wherever the tip touches; in the air it leaves none. There is nothing to pick up, and the gripper must "
        "stay closed."
    )

    def __init__(self, paper: Thing, judge: Callable[[Sequence[Array]], str], goal: Callable[[Poses], Array]) -> None:
        """A drawing.

        Args:
            paper: What is drawn on.
            judge: What is wrong with strokes, each of shape (N, 2) [m]; "" when nothing is.
            goal: A right path for how things stand, shape (N, 2) [m].
        """
        self.paper, self._judge, self._goal = paper, judge, goal
        self.strokes: list[list[tuple[float, float]]] = []
        self._touched_s = -math.inf

    def add_end(self, body: Any) -> None:
        middle = (self.below_m + GRIP_HALF_M[2]) / 2
        body.add_geom(
            name="pen shaft", type=mj.mjtGeom.mjGEOM_CYLINDER, size=(0.004, (self.below_m - GRIP_HALF_M[2]) / 2, 0),
            pos=(0.0, 0.0, -middle), mass=0.005, group=0, contype=0, conaffinity=0, rgba=(0.1, 0.12, 0.5, 1.0),
        )  # fmt: skip
        body.add_geom(
            name="pen tip", type=mj.mjtGeom.mjGEOM_SPHERE, size=(TIP_M, 0, 0), pos=(0.0, 0.0, -self.below_m + TIP_M),
            mass=0.001, group=0, condim=3, friction=(0.2, 0.005, 0.0001), priority=2, solref=STIFF, margin=FELT_M,
            gap=FELT_M, rgba=INK_RGBA,
        )  # fmt: skip

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        super().begin(built, state, robot)
        self._tip = int(mj.mj_name2id(built.model, mj.mjtObj.mjOBJ_GEOM, "pen tip"))

    def step(self) -> None:
        """Leave ink where the tip touches something."""
        state = self._state
        touches = (state.contact.geom[: state.ncon] == self._tip).any(axis=1)
        if not touches.any():
            return
        x, y, _ = (float(v) for v in state.contact.pos[: state.ncon][touches][0])
        now = float(state.time)
        if now - self._touched_s > LIFTED_S:
            self.strokes.append([])
        self._touched_s = now
        line = self.strokes[-1]
        if not line or math.dist(line[-1], (x, y)) >= EVERY_M:
            line.append((x, y))

    def decorate(self, scene: Any) -> None:
        """The ink, as MuJoCo draws it."""
        for line in self.strokes:
            kept = [line[0]] if line else []
            for point in line[1:]:
                if math.dist(kept[-1], point) >= DRAWN_EVERY_M:
                    kept.append(point)
            for one, other in zip(kept, kept[1:], strict=False):
                if scene.ngeom >= scene.maxgeom:
                    return
                geom = scene.geoms[scene.ngeom]
                capsule = mj.mjtGeom.mjGEOM_CAPSULE
                mj.mjv_initGeom(geom, capsule, np.zeros(3), np.zeros(3), np.zeros(9), np.array(INK_RGBA, np.float32))
                mj.mjv_connector(geom, capsule, LINE_M / 2, np.array([*one, 0.001]), np.array([*other, 0.001]))
                scene.ngeom += 1

    @property
    def ink(self) -> list[Array]:
        """Strokes of more than a dot, shape (N, 2) each [m]."""
        return [np.array(line) for line in self.strokes if len(line) > 1]

    def score(self, poses: Poses) -> Score:
        ink = self.ink
        if not ink:
            return Score(False, "execution" if self.strokes else "plan", "there is no line of ink")
        lines = MultiLineString([LineString(stroke) for stroke in ink])
        beyond = lines.difference(footprint_of(self.paper, poses[self.paper.name])).length
        if beyond > LINE_M:
            return Score(False, "execution", f"{1000 * beyond:.0f} mm of the line lie outside the paper")
        problem = self._judge(ink)
        return Score(not problem, "execution" if problem else None, problem or "the ink is as asked")

    def oracle(self, poses: Poses) -> Sequence[Action]:
        if self.score(poses).success or self.ink:
            # What was drawn wrong cannot be made undone.
            return []
        path = self._goal(poses)
        low = np.column_stack([path, np.full(len(path), 0.001)])
        over = np.array([0.0, 0.0, OVER_M])
        return [Trajectory(np.vstack([low[:1] + over, low, low[-1:] + over])), Home()]
