"""A suction cup over the table: picks, carries and puts down under physics."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from wonderful_team.core.actions import PickPlace
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.model import TABLE_GROUP, THING_GROUP, TIMESTEP_S, BuiltModel
from wonderful_team.sims.tabletop.moving import HOME_M, Tool, settle

DOWN = np.array([0.0, 0.0, -1.0])
HAIR_M = ((0.0, 0.0), (1.7e-4, 0.9e-4), (-1.3e-4, 1.1e-4))
CUP_RADIUS_M = 0.006
SEAL_M = 0.006
"""How much the surface under the rim of the cup may rise or fall for the cup to hold [m]."""
SEALED_SHARE = 0.5
LIFT_M = 0.16
"""How far things are lifted from where they are gripped, as far as the workspace reaches [m]."""
CARRY_SPEED_M_S = 1.0
TURN_SPEED_RAD_S = 4.0
LOWER_SPEED_M_S = 0.3


@dataclass(frozen=True, eq=False)
class Picked:
    """What happened to the thing; `thing` is the truth and is not told to the robot."""

    thing: str | None
    under_pick: str | None
    under_place: str | None
    measured: Mapping[str, Any]


class Suction(Tool):
    """Moves a MuJoCo state through pick-and-place actions."""

    def __init__(self, built: BuiltModel, state: Any) -> None:
        super().__init__(built, state)
        self._names = {built.body_id(thing.name): thing.name for thing in built.things}
        self._movable = {built.body_id(thing.name) for thing in built.things if thing.body.movable}
        self._body_of = built.model.geom_bodyid
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[[THING_GROUP, TABLE_GROUP]] = 1

    def thing_under(self, x_m: float, y_m: float) -> str | None:
        """Name of the highest thing at a point of the table, or None for bare table."""
        return self._names.get(self._look_down(x_m, y_m)[0])

    def pick_place(self, action: PickPlace) -> Picked:
        """Run one action to its end, things at rest again."""
        x, y = (float(v) for v in action.pick_m[:2])
        place = np.array([float(v) for v in action.place_m[:2]])
        under_pick, under_place = self.thing_under(x, y), self.thing_under(*place)
        body, contact_z = self._look_down(x, y)
        self.tool_m = touched = np.array([x, y, contact_z])
        if body not in self._movable or not self._seals(body, x, y, contact_z):
            self.tool_m = np.array([x, y, HOME_M[2]])
            return Picked(None, under_pick, under_place, self._measured(False, contact_z, None, action, touched))
        self._attach(body)
        self.holding = True
        carried_z = min(contact_z + LIFT_M, TABLE_HIGH_M[2])
        self._carry(np.array([x, y, carried_z]), 0.0, CARRY_SPEED_M_S)
        self._carry(np.array([*place, carried_z]), action.yaw_rad, CARRY_SPEED_M_S)
        self._lower(body, contact_z, action.yaw_rad)
        released = np.array(self.tool_m)
        self._release(body)
        settle(self._built, self._state)
        self.holding = False
        self.tool_m = np.array([*place, HOME_M[2]])
        measured = self._measured(True, contact_z, float(released[2]), action, touched, released)
        return Picked(self._names[body], under_pick, under_place, measured)

    def _measured(
        self, held: bool, contact_z: float, released_z: float | None, action: PickPlace, *touched: Array
    ) -> dict[str, Any]:
        """`touched`: where the tool touched the thing, and where it let it go."""
        return {
            "held": held,
            "contact_height_m": round(contact_z, 4),
            "release_height_m": None if released_z is None else round(released_z, 4),
            "tool_m": tuple(round(float(v), 4) for v in self.tool_m),
            "path_m": [tuple(round(float(v), 4) for v in point) for point in touched],
            "turned_rad": round(float(action.yaw_rad), 4) if held else 0.0,
        }

    def _look_down(self, x_m: float, y_m: float) -> tuple[int, float]:
        """Body and height of what a vertical ray meets first; the table is body 0.

        A ray that meets a corner shared by triangles may slip through, so three rays a hair apart are cast.
        """
        hit, found = np.zeros(1, dtype=np.int32), (0, 0.0)
        for dx, dy in HAIR_M:
            start = np.array([x_m + dx, y_m + dy, 0.6])
            distance = mj.mj_ray(self._model, self._state, start, DOWN, self._groups, 1, -1, hit)
            if distance >= 0 and 0.6 - distance > found[1]:
                found = int(self._model.geom_bodyid[hit[0]]), 0.6 - float(distance)
        return found

    def _seals(self, body: int, x_m: float, y_m: float, z_m: float) -> bool:
        angles = [2 * math.pi * k / 8 for k in range(8)]
        seen = [self._look_down(x_m + CUP_RADIUS_M * math.cos(a), y_m + CUP_RADIUS_M * math.sin(a)) for a in angles]
        tight = sum(other == body and abs(z - z_m) <= SEAL_M for other, z in seen)
        return tight >= SEALED_SHARE * len(seen)

    def _hold_id(self, body: int) -> int:
        return int(mj.mj_name2id(self._model, mj.mjtObj.mjOBJ_EQUALITY, f"hold {self._names[body]}"))

    def _attach(self, body: int) -> None:
        """Weld the thing to the tool as it stands now."""
        self._place_tool(self.tool_m, 0.0)
        mj.mj_forward(self._model, self._state)
        weld = self._hold_id(body)
        record = self._model.eq_data[weld]
        record[0:3] = 0.0
        record[3:6] = self._state.xpos[body] - self.tool_m
        record[6:10] = self._state.xquat[body]
        self._state.eq_active[weld] = 1

    def _release(self, body: int) -> None:
        self._state.eq_active[self._hold_id(body)] = 0
        start = int(self._model.jnt_dofadr[self._model.body_jntadr[body]])
        self._state.qvel[start : start + 6] = 0.0

    def _carry(self, goal_m: Array, yaw_rad: float, speed_m_s: float) -> None:
        """Move the tool in a straight line, slow at both ends, turning on the way; then wait for the thing to follow."""
        start = np.array(self.tool_m)
        seconds = max(float(np.linalg.norm(goal_m - start)) / speed_m_s, abs(yaw_rad) / TURN_SPEED_RAD_S, 0.02) * 1.5
        count = max(1, math.ceil(seconds / TIMESTEP_S))
        for k in range(1, count + 1):
            share = k / count
            eased = share * share * (3 - 2 * share)
            self._place_tool(start + eased * (goal_m - start), eased * yaw_rad)
            self._step()
        for _ in range(20):
            self._step()

    def _lower(self, body: int, contact_z: float, yaw_rad: float) -> None:
        """Lower the thing until it touches something, never below the height at which it was picked from the table."""
        x, y, z = (float(v) for v in self.tool_m)
        lowest = contact_z - max(0.0, self._lift_of(body, contact_z))
        while z > lowest and not self._touches(body):
            z = max(lowest, z - LOWER_SPEED_M_S * TIMESTEP_S)
            self._place_tool(np.array([x, y, z]), yaw_rad)
            self._step()

    def _lift_of(self, body: int, contact_z: float) -> float:
        """How high over the table the thing's origin stood when it was picked; it may go down by that much."""
        origin_below_tool = float(self._model.eq_data[self._hold_id(body)][5])
        return contact_z + origin_below_tool

    def _touches(self, body: int) -> bool:
        contact = self._state.contact
        ours = self._body_of[contact.geom[contact.dist < 0.0]] == body
        return bool((ours[:, 0] != ours[:, 1]).any())
