"""What the Fetch world asks of a simulator, answered without one: a tool that goes where it is told, things that are held or fall.

Started by the real launcher in a process of its own. `FETCH_STAND_IN` says what goes wrong: stuck, crash, hang, nothing (numbers
that mean nothing), touch (something presses on the tool low over the table).
"""

from __future__ import annotations

import math
import os
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from typing import Any

import numpy as np

STEP_M, OPEN_M, FACE_M, TABLE_M = 0.05, 0.1, 0.0018, 0.4
NEAR_M = (0.02, 0.045)
BROKEN = os.environ.get("FETCH_STAND_IN", "")


class Bench:
    """Holds one table."""

    def ask(
        self, what: str, said: Mapping[str, Any], arrays: Mapping[str, Any]
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        answers = {
            "hello": self._hello, "open": self._open, "step": self._step, "look": self._look, "film": self._film, "poses": self._poses,
            "masks": self._masks, "track": self._track,
        }  # fmt: skip
        return answers[what](said, arrays) if what in answers else ({}, {})

    def _hello(self, said: Any, arrays: Any) -> Any:
        return {"versions": {"stand-in": "1"}}, {}

    def _open(self, said: Any, arrays: Any) -> Any:
        tree = ElementTree.fromstring(said["xml"])
        self.names = list(said["bodies"])
        bodies = {body.get("name"): body for body in tree.iter("body")}
        self.parts = {name: [_part(geom) for geom in bodies[name].iter("geom")] for name in self.names}
        self.at = {name: _numbers(bodies[name].get("pos")) for name in self.names}
        self.camera = next(camera for camera in tree.iter("camera") if camera.get("name") == "top")
        self.size = said["size_px"]
        self.tool, self.fingers, self.time_s = np.array([1.34, 0.75, 0.9]), 0.0, 0.0
        self.held: str | None = None
        self.track: list[Any] = []
        self.looks: list[Any] = []
        return {"versions": {"stand-in": "1"}, "step_s": 0.04, **self._measured()}, {}

    def _step(self, said: Any, arrays: Any) -> Any:
        if BROKEN == "crash" and len(self.track) > 60:
            os._exit(3)
        if BROKEN == "hang" and len(self.track) > 60:
            time.sleep(3600)
        action = np.asarray(arrays["action"], dtype=float)
        assert action.shape == (4,), "the environment's own actions have four numbers"
        assert np.abs(action).max() <= 1, "and all lie within -1 and 1"
        way = STEP_M * action[:3] * (0.0 if BROKEN == "stuck" else 1.0)
        self.tool, self.time_s = self.tool + way, self.time_s + 0.04
        self._grip(float(action[3]))
        if self.held is not None:
            self.at[self.held] = self.at[self.held] + way
        if BROKEN == "slip" and self.held is not None and self.tool[2] > TABLE_M + 0.2:
            self._drop(self.held)
            self.held, self.fingers = None, 0.0
        rows = [[*self.at[name], 1.0, 0.0, 0.0, 0.0, float(name == self.held)] for name in self.names]
        self.track.append(rows)
        return self._measured(), {}

    def _measured(self) -> Any:
        low = BROKEN == "touch" and self.tool[2] < TABLE_M + 0.15
        tool = [float(v) for v in self.tool[: 2 if BROKEN == "nothing" else 3]]
        return {
            "tool_m": tool, "fingers_m": self.fingers, "force_n": 20.0 if low else 0.0, "gripped": self.held is not None,
            "time_s": self.time_s,
        }  # fmt: skip

    def _grip(self, gripper: float) -> None:
        self.fingers = min(max(self.fingers + 4 * gripper, 0.0), OPEN_M)
        if gripper > 0 and self.held is not None:
            self._drop(self.held)
            self.held = None
        found = self._between()
        if gripper < 0 and found is not None and self.fingers <= found[1]:
            self.held, self.fingers = found

    def _between(self) -> tuple[str, float] | None:
        """What is between the fingers, and how wide it is."""
        for name in self.names:
            for half, middle in self.parts[name]:
                x, y, z = np.abs(self.at[name] + middle - self.tool)
                if name != "box" and x < NEAR_M[0] and y < NEAR_M[1] and z < half[2] + 0.015 and half[1] < NEAR_M[1]:
                    return name, 2 * float(half[1])
        return None

    def _drop(self, name: str) -> None:
        x, y, _ = self.at[name]
        over_box = bool((np.abs(self.at["box"][:2] - (x, y)) < (0.06, 0.08)).all())
        covered = bool(np.abs(self.at["lid"][:2] - self.at["box"][:2]).max() < 0.02) and name != "lid"
        z = TABLE_M + (0.093 if covered else 0.006) * over_box
        self.at[name] = np.array([x, y, z])

    def _look(self, said: Any, arrays: Any) -> Any:
        self.looks.append(dict(self.at))
        rgb, depth, _ = self._drawn(self.at)
        return {"look": len(self.looks) - 1}, {
            f"{kind}:{name}": picture for name in said["cameras"] for kind, picture in (("rgb", rgb), ("depth", depth))
        }

    def _film(self, said: Any, arrays: Any) -> Any:
        return {}, {name: self._drawn(self.at)[0] for name in said["cameras"]}

    def _drawn(self, at: Mapping[str, Any]) -> Any:
        """Upper faces of all parts as a camera straight above sees them: colour, depth, and which part each pixel shows."""
        width, height = self.size
        x, y, z = _numbers(self.camera.get("pos"))
        focal = height / 2 / math.tan(math.radians(float(str(self.camera.get("fovy")))) / 2)
        rgb, geoms = np.full((height, width, 3), 200, np.uint8), np.full((height, width), -1, np.int32)
        depth = np.full((height, width), z - TABLE_M, np.float32)
        faces = [(at[name] + middle, half) for name in self.names for half, middle in self.parts[name]]
        for number in sorted(range(len(faces)), key=lambda k: faces[k][0][2] + faces[k][1][2]):
            middle, half = faces[number]
            away = z - middle[2] - half[2]
            across, down = focal * (middle[1] - y) / away + width / 2, focal * (middle[0] - x) / away + height / 2
            sides = focal * half[1] / away, focal * half[0] / away
            rows = slice(max(0, round(down - sides[1])), max(0, round(down + sides[1])))
            columns = slice(max(0, round(across - sides[0])), max(0, round(across + sides[0])))
            rgb[rows, columns] = [(37 * number) % 200, (91 * number) % 200, (53 * number) % 200]
            depth[rows, columns], geoms[rows, columns] = away, number
        return rgb, depth, geoms

    def _poses(self, said: Any, arrays: Any) -> Any:
        at = self.at if said["look"] is None else self.looks[said["look"]]
        rows = np.array([[*at[name], 1.0, 0.0, 0.0, 0.0] for name in self.names])
        return {"touched": [] if self.held is None else [self.held]}, {"poses": rows}

    def _masks(self, said: Any, arrays: Any) -> Any:
        names = [f"{name}:{k}" for name in self.names for k in range(len(self.parts[name]))]
        return {"names": names}, {"geoms": self._drawn(self.looks[said["look"]])[2]}

    def _track(self, said: Any, arrays: Any) -> Any:
        return {}, {"track": np.array(self.track, dtype=float).reshape(-1, len(self.names), 8)}


def _numbers(text: Any) -> Any:
    return np.array([float(part) for part in str(text).split()])


def _part(geom: Any) -> Any:
    """Half sides and middle of a part; of a cylinder, of the box round it."""
    size, middle = _numbers(geom.get("size")), _numbers(geom.get("pos"))
    if geom.get("type") == "box":
        return size, middle
    half = [size[0], size[0], size[1]] if geom.get("euler") is None else [size[0], size[1], size[0]]
    return np.array(half), middle
