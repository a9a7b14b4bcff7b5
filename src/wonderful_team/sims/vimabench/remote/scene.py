"""What stands on the table, from the physics engine: names, poses, outlines, and a point where a suction cup holds."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .outlines import corners_of, hull, middle_of

PX_PER_M = 250.98
COLUMN_0, ROW_0 = 128.0, 63.0
"""Top view, whole pixel numbers: column = 250.98 y + 128, row = 250.98 (x - 0.5) + 63; fitted to 45 objects."""

Pose = tuple[Any, Any]
"""Position (3,) [m] and rotation matrix (3, 3)."""


class Scene:
    """The things of one episode, each under a name of its own."""

    def __init__(self, env: Any, segm: Mapping[str, Any]) -> None:
        self._physics = importlib.import_module("pybullet")
        self._env = env
        self._infos = {int(body): info for body, info in env.meta_info["obj_id_to_info"].items()}
        self.names = _unique({body: _words(info) for body, info in self._infos.items()})
        self._corners = {body: corners_of(self._physics, body, env.client_id) for body in self._infos}
        self._kinds = {body: self._kind(body) for body in self._infos}
        self.start = self.things(segm["top"])
        self.props: dict[str, dict[str, str]] = {}
        self.shown = {str(slot): self._shown(str(slot), asset) for slot, asset in env.prompt_assets.items()}

    def name(self, body: int) -> str | None:
        """Of a thing; None for the table and what else is no thing."""
        return self.names.get(int(body))

    def pose(self, body: int) -> Pose:
        """Where a body stands now."""
        position, turned = self._physics.getBasePositionAndOrientation(body, physicsClientId=self._env.client_id)
        matrix = np.array(self._physics.getMatrixFromQuaternion(turned), dtype=float).reshape(3, 3)
        return np.array(position, dtype=float), matrix

    def poses(self) -> dict[str, Pose]:
        """Where everything stands now."""
        return {name: self.pose(body) for body, name in self.names.items()}

    def things(self, bodies: Any) -> list[dict[str, Any]]:
        """Everything on the table as plain values; `bodies` is the body picture of the top view."""
        return [self._thing(body, bodies) for body in self.names]

    def grasp_xy(self, body: int, bodies: Any) -> tuple[float, float]:
        """Where a cup coming straight down holds a thing: deep inside what is seen of it; its centre when unseen."""
        position, _ = self.pose(body)
        inside = middle_of(np.asarray(bodies) == body, (_row(position[0]), _column(position[1])))
        if inside is None:
            return float(position[0]), float(position[1])
        row, column = inside
        return 0.5 + (row - ROW_0) / PX_PER_M, (column - COLUMN_0) / PX_PER_M

    def under(self, bodies: Any, action: Mapping[str, Any]) -> dict[str, str | None]:
        """Names of what is seen at both points of an action before it runs."""
        found = {}
        for role, key in (("under_pick", "pose0_position"), ("under_place", "pose1_position")):
            x, y = (float(value) for value in action[key])
            row = min(max(int(round(_row(x))), 0), bodies.shape[0] - 1)
            column = min(max(int(round(_column(y))), 0), bodies.shape[1] - 1)
            found[role] = self.name(int(bodies[row, column]))
        return found

    def shown_things(self) -> dict[str, Any]:
        """What each picture of the instruction shows, and the props among it."""
        slots = {slot: [name for _, name in sorted(found.items())] for slot, found in self.shown.items()}
        return {"shown": slots, "props": self.props}

    def _thing(self, body: int, bodies: Any) -> dict[str, Any]:
        position, matrix = self.pose(body)
        corners = self._corners[body] @ matrix.T + position
        info, top = self._infos[body], float(corners[:, 2].max())
        return {
            "name": self.names[body],
            "words": _words(info),
            "kind": self._kinds[body],
            "shape": str(info["obj_name"]),
            "cover": str(info["texture_name"]),
            "position_m": [float(value) for value in position],
            "yaw_rad": math.atan2(matrix[1, 0], matrix[0, 0]),
            "height_m": top,
            "outline_m": hull(corners[:, :2]),
            "grasp_m": [*self.grasp_xy(body, bodies), top],
        }

    def _kind(self, body: int) -> str:
        if body not in self._env.obj_ids["fixed"]:
            return "object"
        solid = self._physics.getCollisionShapeData(body, -1, physicsClientId=self._env.client_id)
        return "container" if solid else "area"

    def _shown(self, slot: str, asset: Mapping[str, Any]) -> dict[int, str]:
        """Names of what a picture shows, by its body number there: things of the table, else props."""
        infos = asset["segm"]["obj_info"]
        infos = [infos] if isinstance(infos, Mapping) else infos
        free = dict(self.names)
        found: dict[int, str] = {}
        for number, info in enumerate(infos):
            shape, cover = str(info["obj_name"]), str(info["obj_color"])
            same = [body for body in free if self._looks_like(body, shape, cover)]
            if same:
                found[int(info["obj_id"])] = free.pop(same[0])
            else:
                prop = f"prop {slot} {number}"
                self.props[prop] = {"shape": shape, "texture": cover}
                found[int(info["obj_id"])] = prop
        return found

    def _looks_like(self, body: int, shape: str, cover: str) -> bool:
        info = self._infos[body]
        return (str(info["obj_name"]), str(info["texture_name"])) == (shape, cover)


def _words(info: Mapping[str, Any]) -> str:
    return f"{info['texture_name']} {info['obj_name']}"


def _unique(words: Mapping[int, str]) -> dict[int, str]:
    """The words themselves where nothing else is called so, numbered where something is."""
    said: Sequence[str] = list(words.values())
    met: dict[str, int] = {}
    names = {}
    for body, word in words.items():
        met[word] = met.get(word, 0) + 1
        names[body] = word if said.count(word) == 1 else f"{word} {met[word]}"
    return names


def _row(x_m: float) -> float:
    return PX_PER_M * (x_m - 0.5) + ROW_0


def _column(y_m: float) -> float:
    return PX_PER_M * y_m + COLUMN_0
