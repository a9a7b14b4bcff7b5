"""A spatula over the table: its blade pushes what can be moved along a straight line, under physics."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.actions import Push
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses, footprint_of
from wonderful_team.sims.tabletop.model import BLADE_HALF_M, TIMESTEP_S, BuiltModel, Thing
from wonderful_team.sims.tabletop.moving import HOME_M, Tool, settle

OVER_TABLE_M = 0.001
"""How far over the table the blade's lower edge moves [m]."""
SPEED_M_S = 0.16
BACK_OFF_M = 0.06
"""How far behind its start the blade may come down where the start itself is taken [m]."""
LOOK_M = 0.002
SAMPLE_STEPS = 8
RESISTANCE_M = 0.005
"""How far the blade may dig into a thing before it counts as stuck [m]."""
SHORTEST_M = 0.005


@dataclass(frozen=True, eq=False)
class Pushed:
    """What happened; `during` is the truth on the way and is not told to the robot."""

    during: tuple[Poses, ...]
    measured: Mapping[str, Any]


class Spatula(Tool):
    """Moves a MuJoCo state through pushes: the front of the blade travels from the start to the end."""

    def __init__(self, built: BuiltModel, state: Any, poses: Callable[[], Poses]) -> None:
        super().__init__(built, state)
        self._poses = poses
        self._blade = int(mj.mj_name2id(built.model, mj.mjtObj.mjOBJ_GEOM, "blade"))

    def push(self, action: Push) -> Pushed:
        """Run one action to its end, things at rest again."""
        start, end = action.start_m[:2].copy(), action.end_m[:2].copy()
        way = (end - start) / np.linalg.norm(end - start)
        landed = self._landing(start, way)
        if landed is None:
            return Pushed((), self._measured(None, None, action))
        reach = self._free_way(landed, way, float((end - landed) @ way))
        during, travelled = self._sweep(landed, way, reach)
        self._place_tool(np.array([*HOME_M]), 0.0)
        settle(self._built, self._state)
        return Pushed(tuple(during), self._measured(landed, landed + travelled * way, action))

    def _landing(self, start: Array, way: Array) -> Array | None:
        """Where the blade can come down: at the start, or a little behind it."""
        things = self._things()
        taken = shapely.unary_union([footprint_of(t, p) for t, p in things if t.body.kind != "area"])
        places = start - np.arange(0.0, BACK_OFF_M, LOOK_M)[:, None] * way
        free = np.flatnonzero(~shapely.intersects(blade_outlines(places, way), taken))
        return np.asarray(places[free[0]]) if len(free) else None

    def _free_way(self, start: Array, way: Array, wanted: float) -> float:
        """How far the blade can go before it meets something fixed [m]."""
        walls: BaseGeometry = shapely.unary_union(
            [footprint_of(t, p) for t, p in self._things() if not t.body.movable and t.body.kind != "area"]
        )
        reaches = np.arange(0.0, wanted, LOOK_M)
        met = np.flatnonzero(shapely.intersects(blade_outlines(start + reaches[:, None] * way, way), walls))
        return float(max(0.0, reaches[met[0]] - LOOK_M)) if len(met) else wanted

    def _sweep(self, start: Array, way: Array, reach: float) -> tuple[list[Poses], float]:
        yaw = math.atan2(way[1], way[0])
        height = BLADE_HALF_M[2] + OVER_TABLE_M
        count = max(1, math.ceil(reach / SPEED_M_S / TIMESTEP_S))
        during: list[Poses] = []
        for k in range(count + 1):
            travelled = reach * k / count
            at = start + (travelled - BLADE_HALF_M[0]) * way
            self._place_tool(np.array([*at, height]), yaw)
            self._step()
            if k % SAMPLE_STEPS == 0:
                during.append(self._poses())
                if self._stuck():
                    return during, travelled
        return during, reach

    def _stuck(self) -> bool:
        contact = self._state.contact
        return bool(((contact.geom == self._blade).any(axis=1) & (contact.dist < -RESISTANCE_M)).any())

    def _things(self) -> list[tuple[Thing, Pose]]:
        poses = self._poses()
        return [(thing, poses[thing.name]) for thing in self._built.things]

    def _measured(self, start: Array | None, end: Array | None, action: Push) -> dict[str, Any]:
        short = None if end is None else float(np.linalg.norm(action.end_m[:2] - end))
        return {
            "lowered": start is not None,
            "start_m": None if start is None else tuple(round(float(v), 4) for v in start),
            "end_m": None if end is None else tuple(round(float(v), 4) for v in end),
            "path_m": [
                (*(round(float(v), 4) for v in point), OVER_TABLE_M) for point in (start, end) if point is not None
            ],
            "short_of_end_m": None if short is None else round(short, 4),
        }


def blade_outlines(fronts: Array, way: Array) -> Array:
    """What the blade covers of the table when the middle of its front is at each of the points, shape (N, 2), moving along a unit vector."""
    across = np.array([-way[1], way[0]]) * BLADE_HALF_M[1]
    backs = fronts - 2 * BLADE_HALF_M[0] * way
    corners = [fronts + across, fronts - across, backs - across, backs + across]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)))
