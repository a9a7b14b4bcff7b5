"""One table in simulated time: its things, their physics and pictures, and what has happened on it. Holds the truth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from wonderful_team.actions import PickPlace
from wonderful_team.errors import ConfigError
from wonderful_team.geometry import Pose
from wonderful_team.geometry.arrays import Array
from wonderful_team.sims.tabletop.cameras import CAMERA_NAMES
from wonderful_team.sims.tabletop.drawing import Drawn, Renderer, open_renderer
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses, Rules
from wonderful_team.sims.tabletop.judging import Happened
from wonderful_team.sims.tabletop.model import Thing, build
from wonderful_team.sims.tabletop.registering import TabletopTask
from wonderful_team.sims.tabletop.suction import Picked, Suction
from wonderful_team.types import Instruction, Slot, View

ALONE_M = (0.5, 0.0, 0.0)
"""Where a thing stands for a picture of it alone."""
AWAY_M = 50.0
"""Where the others are then [m]."""


class Table:
    """Everything that a world keeps from planners.

    Attributes:
        things: As they stood at the start, by name.
        history: The start, then one entry per action that ran.
    """

    def __init__(
        self, task: TabletopTask, seed: int, size_px: tuple[int, int], recolour: int | None, renderer: str | None
    ) -> None:
        self.task, self.seed = task, seed
        self.scene = task.scene(seed, recolour)
        self.things: Mapping[str, Thing] = {thing.name: thing for thing in self.scene.things}
        self.rules = Rules(
            tuple(self.scene.goals), tuple(self.scene.distractors), task.horizon, self.scene.ends_when_reached
        )
        self.built = build(self.scene.things, size_px)
        self._state = mj.MjData(self.built.model)
        mj.mj_forward(self.built.model, self._state)
        self.suction = Suction(self.built, self._state)
        self.suction.settle()
        self._state.time = 0.0
        self._start_qpos = self._state.qpos.copy()
        self._wanted_renderer = renderer
        self._opened: Renderer | None = None
        self._notes: tuple[str, ...] = ()
        self.closed = False
        poses = self.poses()
        self.history: list[Happened] = [Happened(poses, self.rules.judge(poses, self.things))]

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return float(self._state.time)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the choice of a renderer has to say."""
        self.renderer()
        return self._notes

    def poses(self) -> Poses:
        """True pose of each thing now."""
        found = {}
        for name in self.things:
            body = self.built.body_id(name)
            found[name] = Pose(self._state.xpos[body].copy(), self._state.xquat[body].copy())
        return found

    def run(self, action: PickPlace) -> Picked:
        """Run one action under physics and judge what came of it."""
        picked = self.suction.pick_place(action)
        poses = self.poses()
        self.history.append(Happened(poses, self.rules.judge(poses, self.things), action, picked))
        return picked

    def put(self, name: str, position_m: Array, yaw_rad: float) -> None:
        """Set a thing down elsewhere, upright, and let everything come to rest."""
        _place(self.built.model, self._state, self.built.body_id(name), Pose.at(position_m, yaw_rad))
        mj.mj_forward(self.built.model, self._state)
        self.suction.settle()

    def renderer(self) -> Renderer:
        """What draws this table, opened when it is first needed."""
        if self.closed:
            raise ConfigError("this world is closed; make a new one")
        if self._opened is None:
            self._opened, self._notes = open_renderer(self.built, self._wanted_renderer)
        return self._opened

    def draw(self, camera: str) -> Drawn:
        """A picture of the table as it stands now."""
        return self.renderer().draw(self._state, camera)

    def body_picture(self, camera: str) -> Array:
        """Id of the body that each pixel of a view shows, shape (H, W)."""
        return self.renderer().bodies(self._state, camera)

    def instruction(self) -> Instruction:
        """Words with their slots filled, and a picture for every picture slot."""
        text = self.task.instruction
        for slot, word in self.scene.words.items():
            text = text.replace(f"{{{slot}}}", word)
        return Instruction(text, {slot: self._slot(slot, name) for slot, name in self.scene.pictures.items()})

    def close(self) -> None:
        """Give the renderer back; safe to call twice."""
        self.closed = True
        if self._opened is not None:
            self._opened.close()
            self._opened = None

    def _slot(self, slot: str, name: str | None) -> Slot:
        """Pictures of one thing alone, or of the whole table at the start."""
        state = mj.MjData(self.built.model)
        state.qpos[:] = self._start_qpos
        if name is not None:
            for k, other in enumerate(self.things):
                away = Pose.at((AWAY_M, AWAY_M + k, 0.0))
                _place(self.built.model, state, self.built.body_id(other), away if other != name else Pose.at(ALONE_M))
        mj.mj_forward(self.built.model, state)
        views = {}
        for camera in CAMERA_NAMES:
            drawn = self.renderer().draw(state, camera, alone=name is not None)
            views[camera] = View(f"slot:{slot}:{camera}", camera, 0.0, drawn.rgb)
        return Slot(slot, "scene" if name is None else "object", views)


def _place(model: Any, state: Any, body: int, pose: Pose) -> None:
    """Put a body somewhere in a state: a fixed one by its mocap slot, a free one by its joint, at rest."""
    slot = int(model.body_mocapid[body])
    if slot >= 0:
        state.mocap_pos[slot], state.mocap_quat[slot] = pose.position_m, pose.quaternion_wxyz
        return
    joint = int(model.body_jntadr[body])
    start, speed = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
    state.qpos[start : start + 3], state.qpos[start + 3 : start + 7] = pose.position_m, pose.quaternion_wxyz
    state.qvel[speed : speed + 6] = np.zeros(6)
