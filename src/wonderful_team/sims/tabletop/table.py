"""One table in simulated time: its things, their physics and pictures, and what has happened on it. Holds the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Instruction
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop.appearance import look_of
from wonderful_team.sims.tabletop.drawing import open_renderer
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.judging import Happened
from wonderful_team.sims.tabletop.model import Thing, ToolName, build
from wonderful_team.sims.tabletop.moving import put_body, settle
from wonderful_team.sims.tabletop.options import Tiers
from wonderful_team.sims.tabletop.registering import TabletopTask, filled
from wonderful_team.sims.tabletop.renderer import Drawn, Renderer
from wonderful_team.sims.tabletop.rules import Rules
from wonderful_team.sims.tabletop.showing import Studio
from wonderful_team.sims.tabletop.spatula import Spatula
from wonderful_team.sims.tabletop.suction import Picked, Suction


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Where every body stood at one instant: enough to draw it again."""

    qpos: Array
    mocap_pos: Array
    mocap_quat: Array

    def same_as(self, other: Snapshot) -> bool:
        """Whether nothing at all moved between the two."""
        return (
            np.array_equal(self.qpos, other.qpos)
            and np.array_equal(self.mocap_pos, other.mocap_pos)
            and np.array_equal(self.mocap_quat, other.mocap_quat)
        )


class Table:
    """Everything that a world keeps from planners.

    Attributes:
        things: As they stood at the start, by name.
        history: The start, then one entry per action that ran.
    """

    def __init__(
        self,
        task: TabletopTask,
        seed: int,
        size_px: tuple[int, int],
        *,
        recolour: int | None = None,
        renderer: str | None = None,
        partition: str | None = None,
        tiers: Tiers | None = None,
    ) -> None:
        self.task, self.seed = task, seed
        tiers = tiers or Tiers()
        self.scene = scene = task.scene(seed, recolour, partition, tiers)
        self.things: Mapping[str, Thing] = {thing.name: thing for thing in scene.things}
        self.rules = Rules(
            tuple(tuple(phase) for phase in scene.phases if phase),
            tuple(scene.distractors),
            task.horizon,
            scene.ends_when_reached,
            tuple(scene.counts),
            tuple(scene.nevers),
            scene.order,
            scene.distractors_matter,
            scene.goals_last,
        )
        tool: ToolName = "spatula" if "push" in task.vocabulary.kinds else "suction"
        self.built = build(scene.things, size_px, tool, look_of(seed, tiers, size_px))
        self._state = mj.MjData(self.built.model)
        mj.mj_forward(self.built.model, self._state)
        self.tool: Suction | Spatula = (
            Spatula(self.built, self._state, self.poses)
            if self.built.tool == "spatula"
            else Suction(self.built, self._state)
        )
        settle(self.built, self._state)
        self._state.time = 0.0
        self._start_qpos = self._state.qpos.copy()
        self._size_px, self._wanted_renderer = size_px, renderer
        self._opened: Renderer | None = None
        self._notes: tuple[str, ...] = ()
        self.closed = False
        poses = self.poses()
        self.history: list[Happened] = [Happened(poses, self.rules.start(poses, self.things))]

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
        return self._poses(self._state)

    def _poses(self, state: Any) -> Poses:
        found = {}
        for name in self.things:
            body = self.built.body_id(name)
            found[name] = Pose(state.xpos[body].copy(), state.xquat[body].copy())
        return found

    def run(self, action: PickPlace | Push) -> Mapping[str, Any]:
        """Run one action under physics, judge what came of it, and tell what the robot measured.

        Raises:
            ConfigError: The tool cannot do this.
        """
        before = self.history[-1]
        picked: Picked | None = None
        during: tuple[Poses, ...] = ()
        if isinstance(action, PickPlace) and isinstance(self.tool, Suction):
            picked = self.tool.pick_place(action)
            measured = picked.measured
        elif isinstance(action, Push) and isinstance(self.tool, Spatula):
            pushed = self.tool.push(action)
            during, measured = pushed.during, pushed.measured
        else:
            raise ConfigError(f"the {self.built.tool} cannot run {action.kind}")
        poses = self.poses()
        progress = self.rules.after(before.progress, during, poses, self.things)
        self.history.append(Happened(poses, progress, action, picked))
        return measured

    def put(self, name: str, position_m: Array, yaw_rad: float) -> None:
        """Set a thing down elsewhere, upright, and let everything come to rest."""
        put_body(self.built, self._state, name, Pose.at(position_m, yaw_rad))
        mj.mj_forward(self.built.model, self._state)
        settle(self.built, self._state)

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

    def film(self, each: Callable[[], None] | None, every_s: float) -> None:
        """Call `each` about every `every_s` of simulated time while the tool moves; None stops it."""
        due = [self.time_s]

        def watch() -> None:
            if each is not None and self.time_s >= due[0]:
                due[0] = self.time_s + every_s
                each()

        self.tool.watch = None if each is None else watch

    def body_picture(self, camera: str) -> Array:
        """Id of the body that each pixel of a view shows, shape (H, W)."""
        return self.renderer().bodies(self._state, camera)

    def snapshot(self) -> Snapshot:
        """Where everything stands now, kept."""
        state = self._state
        return Snapshot(state.qpos.copy(), state.mocap_pos.copy(), state.mocap_quat.copy())

    def masks_at(self, at: Snapshot, camera: str) -> dict[str, Array]:
        """Which pixels of a view showed each thing at an earlier instant, shape (H, W) bool by name."""
        ids = self.renderer().bodies(self._state_at(at), camera)
        return {name: ids == self.built.body_id(name) for name in self.things}

    def poses_at(self, at: Snapshot) -> Poses:
        """True pose of each thing at an earlier instant."""
        return self._poses(self._state_at(at))

    def _state_at(self, at: Snapshot) -> Any:
        state = mj.MjData(self.built.model)
        state.qpos[:], state.mocap_pos[:], state.mocap_quat[:] = at.qpos, at.mocap_pos, at.mocap_quat
        mj.mj_kinematics(self.built.model, state)
        mj.mj_comPos(self.built.model, state)
        mj.mj_camlight(self.built.model, state)
        return state

    def slot_masks(self, slot: str, camera: str) -> dict[str, Array]:
        """Which pixels of an instruction's picture show each thing or prop, shape (H, W) bool by name."""
        return self._studio.masks(self.scene.pictures[slot], camera, self.renderer())

    def slot_stands(self, slot: str) -> list[tuple[Thing, Pose]]:
        """What an instruction's picture shows, props too, and where it stands in it."""
        return self._studio.stands(self.scene.pictures[slot])

    @cached_property
    def _studio(self) -> Studio:
        return Studio(self.built, self._start_qpos, self.scene.props, self._size_px, self._wanted_renderer)

    @cached_property
    def _instruction(self) -> Instruction:
        text = filled(self.task.instruction, self.scene.words)
        return Instruction(text, self._studio.slots(self.scene.pictures, self.renderer()))

    def instruction(self) -> Instruction:
        """Words with their slots filled, and a picture for every picture slot; drawn once."""
        return self._instruction

    def close(self) -> None:
        """Give the renderer back; safe to call twice."""
        self.closed = True
        if self._opened is not None:
            self._opened.close()
            self._opened = None
