"""One Fetch of gymnasium-robotics in a scene of ours: stepped by its own 4-D actions, looked at, measured.

What a robot measures comes with every step; where things are, and how they came there, only where it is asked for.
"""

from __future__ import annotations

import importlib
import os
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .drawing import Drawing

ASSETS = "@ASSETS@"
"""Stands in our scenes for the folder of the package's own files."""
FINGERS = ("robot0:r_gripper_finger_link", "robot0:l_gripper_finger_link")
FINGER_JOINTS = ("robot0:r_gripper_finger_joint", "robot0:l_gripper_finger_joint")
SUBSTEPS, TOO_NEW = 20, (3, 12)
"""Of the package's own Fetch environments; and the first MuJoCo whose enumerations break the package."""
QPOS = {"robot0:slide0": 0.405, "robot0:slide1": 0.48, "robot0:slide2": 0.0}
"""Where the package's own environments put the robot's base, before the table."""

Reply = tuple[dict[str, Any], dict[str, Any]]


class Refused(Exception):  # noqa: N818  says what is the case
    """What was asked for cannot be done; `kind` tells the other side what to make of it."""

    def __init__(self, kind: str, text: str) -> None:
        super().__init__(text)
        self.kind = kind


def load() -> tuple[Any, Any]:
    """The modules `mujoco` and `gymnasium_robotics.envs.fetch.fetch_env`.

    Raises:
        Refused: One cannot be imported, or does not work with the other.
    """
    os.environ.setdefault("MUJOCO_GL", "egl")
    try:
        mujoco: Any = importlib.import_module("mujoco")
        fetch: Any = importlib.import_module("gymnasium_robotics.envs.fetch.fetch_env")
    except ImportError as error:
        raise Refused("missing", f"{error} ({sys.executable})") from error
    except AttributeError as error:
        raise _no_drawing(error) from error
    version = str(mujoco.__version__)
    if tuple(int(part) for part in version.split(".")[:2]) >= TOO_NEW:
        raise Refused("missing", f"mujoco {version} is too new for gymnasium-robotics: valid is below 3.12")
    return mujoco, fetch


def _no_drawing(error: Exception) -> Refused:
    how = os.environ.get("MUJOCO_GL", "")
    return Refused(
        "config",
        f"MuJoCo cannot draw with MUJOCO_GL={how!r} ({type(error).__name__}: {error}); valid is egl, which needs: apt-get install libegl1 libgl1-mesa-dri",
    )


def versions() -> dict[str, str]:
    """Of what the simulator runs on."""
    from importlib import metadata

    named = {name: metadata.version(name) for name in ("gymnasium-robotics", "gymnasium", "mujoco", "numpy")}
    return {"python": sys.version.split()[0], **named}


class Bench:
    """Holds at most one environment."""

    def __init__(self) -> None:
        self._env: Any = None

    def ask(self, what: str, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        """Answer one question.

        Raises:
            Refused: No such question, or none before "open".
        """
        known = {
            "hello": self._hello, "open": self._open, "step": self._step, "look": self._look, "film": self._film,
            "poses": self._poses, "masks": self._masks, "track": self._track, "close": self._close,
        }  # fmt: skip
        if what not in known or (self._env is None and what not in ("hello", "open", "close")):
            raise Refused("usage", f"cannot answer {what!r} now")
        return known[what](said, arrays)

    # -- what an agent may know ------------------------------------------------------------------------------------

    def _hello(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        load()
        return {"versions": versions()}, {}

    def _open(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        self._mujoco, fetch = load()
        assets = Path(fetch.__file__).parents[1] / "assets"
        width, height = (int(side) for side in said["size_px"])
        handle, name = tempfile.mkstemp(suffix=".xml")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(str(said["xml"]).replace(ASSETS, str(assets)))
        env = fetch.MujocoFetchEnv(
            model_path=name, has_object=True, block_gripper=False, n_substeps=SUBSTEPS, gripper_extra_height=0.4,
            target_in_the_air=True, target_offset=0.0, obj_range=0.15, target_range=0.15, distance_threshold=0.05,
            initial_qpos=QPOS, reward_type="sparse", width=width, height=height,
        )  # fmt: skip
        model, kinds = env.model, self._mujoco.mjtObj
        # Seen by people who train it, not by a camera: bars through the gripper, and marks of goals.
        model.geom_rgba[model.geom_bodyid == model.body("robot0:mocap").id, 3] = 0.0
        model.site_rgba[:, 3] = 0.0
        # Without a reset, which would throw object0 about: how far it is from a goal is nobody's question here.
        env.goal = np.zeros(3)
        self._env = env
        self._drawing: Drawing | None = None
        self._bodies = [str(one) for one in said["bodies"]]
        self._ids = np.array([model.body(one).id for one in self._bodies])
        robot, arm = model.body("robot0:base_link").id, model.body("robot0:shoulder_lift_link").id
        self._robot = {k for k in range(model.nbody) if model.body_rootid[k] == robot}
        self._arm = {k for k in self._robot if self._under(k, arm)}
        self._fingers = [model.body(one).id for one in FINGERS]
        self._slides = [int(model.jnt_qposadr[model.joint(one).id]) for one in FINGER_JOINTS]
        self._grip = self._mujoco.mj_name2id(model, kinds.mjOBJ_SITE, "robot0:grip")
        self._looks: list[Any] = []
        self._tracked: list[Any] = []
        return {"versions": versions(), **self._measured(), "step_s": float(env.dt)}, {}

    def _step(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        action = np.array(arrays["action"], dtype=np.float32)
        if not self._env.action_space.contains(action):
            raise Refused("bounds", f"the environment's action space does not hold {action!r}")
        self._env.step(action)
        touched = self._touched()
        data = self._env.data
        held = np.isin(self._ids, list(touched[0] & touched[1])).astype(float)
        self._tracked.append(np.column_stack([data.xpos[self._ids], data.xquat[self._ids], held]))
        return self._measured(), {}

    def _look(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        """Colour and depth of every camera that is named; how things are now is kept for questions about this look."""
        found = {}
        for name in said["cameras"]:
            found[f"rgb:{name}"], found[f"depth:{name}"] = self._draw().picture(self._env.data, str(name))
        self._looks.append(self._env.data.qpos.copy())
        return {"look": len(self._looks) - 1}, found

    def _film(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        return {}, {str(name): self._draw().picture(self._env.data, str(name))[0] for name in said["cameras"]}

    def _measured(self) -> dict[str, Any]:
        """What the robot feels: its tool, its fingers, what presses on it; whether both fingers press on something."""
        data = self._env.data
        touched = self._touched()
        tool = [float(value) for value in data.site_xpos[self._grip]]
        opening = float(sum(data.qpos[at] for at in self._slides))
        return {
            "tool_m": tool, "fingers_m": opening, "force_n": self._force(touched[0] & touched[1]),
            "gripped": bool(touched[0] & touched[1]), "time_s": float(data.time),
        }  # fmt: skip

    def _under(self, body: int, top: int) -> bool:
        while body not in (0, top):
            body = int(self._env.model.body_parentid[body])
        return body == top

    def _touched(self) -> list[set[int]]:
        """What each finger touches, bodies that do not belong to the robot."""
        data, bodies = self._env.data, self._env.model.geom_bodyid
        found: list[set[int]] = [set(), set()]
        for k in range(data.ncon):
            a, b = (int(bodies[geom]) for geom in data.contact.geom[k])
            for one, other in ((a, b), (b, a)):
                if one in self._fingers and other not in self._robot:
                    found[self._fingers.index(one)].add(other)
        return found

    def _force(self, held: set[int]) -> float:
        """Sum of the forces with which what does not belong to the robot presses on its arm or on what it holds [N]."""
        data, bodies = self._env.data, self._env.model.geom_bodyid
        own, total, force = self._arm | held, 0.0, np.zeros(6)
        for k in range(data.ncon):
            a, b = (int(bodies[geom]) for geom in data.contact.geom[k])
            if (a in own) != (b in own) and not {a, b} <= self._robot:
                self._mujoco.mj_contactForce(self._env.model, data, k, force)
                total += float(force[0])
        return total

    def _draw(self) -> Drawing:
        if self._drawing is None:
            try:
                self._drawing = Drawing(self._mujoco, self._env.model)
            except Exception as error:  # each way of drawing fails in its own way
                raise _no_drawing(error) from error
        return self._drawing

    # -- truth, for scorers and simulated models -------------------------------------------------------------------

    def _poses(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        """Position and quaternion of every thing now, or at a look, shape (bodies, 7); and which the robot touches."""
        data = self._env.data if said["look"] is None else self._at(int(said["look"]))
        touched = self._touched()
        robot = [name for k, name in enumerate(self._bodies) if int(self._ids[k]) in touched[0] | touched[1]]
        return {"touched": robot}, {"poses": np.column_stack([data.xpos[self._ids], data.xquat[self._ids]])}

    def _masks(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        """Which geometry each pixel showed at a look, as its place in `names`, shape (H, W); -1 for what is no thing's."""
        shown = self._draw().geoms(self._at(int(said["look"])), str(said["camera"]))
        model = self._env.model
        names = [model.geom(k).name for k in range(model.ngeom) if model.geom_bodyid[k] in self._ids]
        numbers = np.full(model.ngeom + 1, -1, dtype=np.int32)
        for place, name in enumerate(names):
            numbers[model.geom(name).id] = place
        return {"names": names}, {"geoms": numbers[shown]}

    def _track(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        """Position, quaternion and whether both fingers touched it, of every thing after every step, shape (N, bodies, 8)."""
        return {}, {"track": np.array(self._tracked, dtype=np.float64).reshape(-1, len(self._ids), 8)}

    def _at(self, look: int) -> Any:
        if not 0 <= look < len(self._looks):
            raise Refused("usage", f"look {look} of {len(self._looks)}")
        data = self._mujoco.MjData(self._env.model)
        data.qpos[:] = self._looks[look]
        self._mujoco.mj_forward(self._env.model, data)
        return data

    def _close(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        if self._env is not None:
            if self._drawing is not None:
                self._drawing.close()
            self._env.close()
            self._env = None
        return {}, {}
