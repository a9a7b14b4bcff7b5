"""One table in simulated time: its things, their physics and pictures, and what has happened on it. Holds the truth."""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Instruction
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop.appearance import look_of
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.judging import Happened
from wonderful_team.sims.tabletop.model import Thing, ToolName, build
from wonderful_team.sims.tabletop.moving import settle
from wonderful_team.sims.tabletop.options import Tiers
from wonderful_team.sims.tabletop.registering import TabletopTask, filled
from wonderful_team.sims.tabletop.renderer import Renderer
from wonderful_team.sims.tabletop.rules import Rules
from wonderful_team.sims.tabletop.showing import Studio
from wonderful_team.sims.tabletop.simulated_table import PoseReader, SimulatedTable
from wonderful_team.sims.tabletop.spatula import Spatula
from wonderful_team.sims.tabletop.suction import Picked, Suction


class Table(SimulatedTable):
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
        super().__init__(renderer)
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
            Spatula(self.built, self._state, PoseReader(self.built, self.things, self._state))
            if self.built.tool == "spatula"
            else Suction(self.built, self._state)
        )
        settle(self.built, self._state)
        self._state.time = 0.0
        self._start_qpos = self._state.qpos.copy()
        self._size_px = size_px
        poses = self.poses()
        self.history: list[Happened] = [Happened(poses, self.rules.start(poses, self.things))]

    @property
    def mover(self) -> Suction | Spatula:
        return self.tool

    @property
    def start(self) -> Poses:
        return self.history[0].poses

    def rest(self) -> None:
        settle(self.built, self._state)

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

    def body_picture(self, camera: str) -> Array:
        """Id of the body that each pixel of a view shows, shape (H, W)."""
        return self.renderer().bodies(self._state, camera)

    def slot_masks(self, slot: str, camera: str) -> dict[str, Array]:
        """Which pixels of an instruction's picture show each thing or prop, shape (H, W) bool by name."""
        return self._studio.masks(self.scene.pictures[slot], camera)

    def slot_stands(self, slot: str) -> list[tuple[Thing, Pose]]:
        """What an instruction's picture shows, props too, and where it stands in it."""
        return self._studio.stands(self.scene.pictures[slot])

    @cached_property
    def _studio(self) -> Studio:
        # The pictures that the table keeps hold the studio: it does not hold the table.
        own = weakref.ref(self)

        def renderer() -> Renderer | None:
            table = own()
            return None if table is None or table.closed else table.renderer()

        return Studio(self.built, self._start_qpos, self.scene.props, self._size_px, self._wanted_renderer, renderer)

    @cached_property
    def _instruction(self) -> Instruction:
        self.renderer()
        return Instruction(filled(self.task.instruction, self.scene.words), self._studio.slots(self.scene.pictures))

    def instruction(self) -> Instruction:
        """Words with their slots filled, and a picture for every picture slot, drawn when it is looked at."""
        return self._instruction

    def close(self) -> None:
        super().close()
        # Without pictures of the instruction there is no studio.
        studio = self.__dict__.get("_studio")
        if studio is not None:
            studio.close()
