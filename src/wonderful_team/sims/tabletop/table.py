"""One table in simulated time: its things, their physics and pictures, and what has happened on it. Holds the truth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wonderful_team.actions import PickPlace, Push
from wonderful_team.errors import ConfigError
from wonderful_team.geometry import Pose
from wonderful_team.geometry.arrays import Array
from wonderful_team.sims.tabletop.drawing import Drawn, Renderer, open_renderer
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.judging import Happened
from wonderful_team.sims.tabletop.model import Thing, build
from wonderful_team.sims.tabletop.moving import put_body, settle
from wonderful_team.sims.tabletop.registering import TabletopTask, filled
from wonderful_team.sims.tabletop.rules import Rules
from wonderful_team.sims.tabletop.showing import Studio
from wonderful_team.sims.tabletop.spatula import Spatula
from wonderful_team.sims.tabletop.suction import Picked, Suction
from wonderful_team.types import Instruction


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
    ) -> None:
        self.task, self.seed = task, seed
        self.scene = scene = task.scene(seed, recolour, partition)
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
        )
        self.built = build(scene.things, size_px, "spatula" if "push" in task.vocabulary.kinds else "suction")
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
        found = {}
        for name in self.things:
            body = self.built.body_id(name)
            found[name] = Pose(self._state.xpos[body].copy(), self._state.xquat[body].copy())
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

    def body_picture(self, camera: str) -> Array:
        """Id of the body that each pixel of a view shows, shape (H, W)."""
        return self.renderer().bodies(self._state, camera)

    def instruction(self) -> Instruction:
        """Words with their slots filled, and a picture for every picture slot."""
        studio = Studio(self.built, self._start_qpos, self.scene.props, self._size_px, self._wanted_renderer)
        text = filled(self.task.instruction, self.scene.words)
        return Instruction(text, studio.slots(self.scene.pictures, self.renderer()))

    def close(self) -> None:
        """Give the renderer back; safe to call twice."""
        self.closed = True
        if self._opened is not None:
            self._opened.close()
            self._opened = None
