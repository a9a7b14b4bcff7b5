"""What every table in simulated time has, whatever moves things on it: poses, pictures, a renderer, earlier instants."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Instruction
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop.drawing import open_renderer
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.model import BuiltModel, Thing
from wonderful_team.sims.tabletop.moving import put_body
from wonderful_team.sims.tabletop.registering import TabletopTask
from wonderful_team.sims.tabletop.renderer import Drawn, Renderer

DRAWN_FROM = (
    *("qpos", "mocap_pos", "mocap_quat", "xpos", "xquat", "xmat", "xipos", "ximat", "geom_xpos", "geom_xmat"),
    *("site_xpos", "site_xmat", "cam_xpos", "cam_xmat", "light_xpos", "light_xdir"),
)
"""What MuJoCo keeps of poses: all that a picture of bodies depends on."""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Where everything stood at one instant: enough to draw it again, to the last bit.

    Attributes:
        kept: Copies of `DRAWN_FROM`, by name; poses that are worked out again from joint angles differ by rounding.
    """

    kept: Mapping[str, Array]

    def same_as(self, other: Snapshot) -> bool:
        """Whether nothing at all moved between the two."""
        return all(np.array_equal(self.kept[name], other.kept[name]) for name in ("qpos", "mocap_pos", "mocap_quat"))


def poses_of(built: BuiltModel, names: Iterable[str], state: Any) -> Poses:
    """Where some things stand in a state."""
    return PoseReader(built, names, state)()


class PoseReader:
    """Where some things stand in a state, again and again: the pose of what did not move is the same object as before."""

    def __init__(self, built: BuiltModel, names: Iterable[str], state: Any) -> None:
        self._names = tuple(names)
        self._bodies = [built.body_id(name) for name in self._names]
        self._state = state
        self._values = np.full((len(self._names), 7), np.nan)
        self._poses: dict[str, Pose] = {}

    def __call__(self) -> Poses:
        values = np.hstack([self._state.xpos[self._bodies], self._state.xquat[self._bodies]])
        moved = (values != self._values).any(axis=1)
        self._poses = {
            name: Pose(value[:3], value[3:]) if move else self._poses[name]
            for name, move, value in zip(self._names, moved, values, strict=True)
        }
        self._values = values
        return self._poses


class Mover(Protocol):
    """What moves things: a tool or an arm. `watch` is called again and again while it does."""

    watch: Callable[[], None] | None


class SimulatedTable(ABC):
    """A MuJoCo state and its pictures.

    Attributes:
        things: As they stood at the start, by name.
        built: The compiled model.
    """

    task: TabletopTask
    seed: int
    things: Mapping[str, Thing]
    built: BuiltModel
    _state: Any

    def __init__(self, renderer: str | None = None) -> None:
        self._wanted_renderer = renderer
        self._opened: Renderer | None = None
        self._notes: tuple[str, ...] = ()
        self.closed = False

    @property
    @abstractmethod
    def mover(self) -> Mover:
        """What moves things here."""

    @property
    @abstractmethod
    def start(self) -> Poses:
        """Where things stood once everything was at rest."""

    @abstractmethod
    def rest(self) -> None:
        """Let time pass until everything lies still."""

    @abstractmethod
    def instruction(self) -> Instruction:
        """What is asked; made once."""

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
        return poses_of(self.built, self.things, state)

    def put(self, name: str, position_m: Array, yaw_rad: float) -> None:
        """Set a thing down elsewhere, upright, and let everything come to rest."""
        put_body(self.built, self._state, name, Pose.at(position_m, yaw_rad))
        mj.mj_forward(self.built.model, self._state)
        self.rest()

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

    def look(self, camera: str) -> Callable[[], tuple[Array, Array]]:
        """Colours and depth that a camera sees now, drawn when they are asked for.

        Whatever has moved by then, and even once the table is closed.

        Raises:
            ConfigError: The table is closed.
        """
        self.renderer()
        at = self.snapshot()
        return lambda: self._drawn_at(at, camera)

    def _drawn_at(self, at: Snapshot, camera: str) -> tuple[Array, Array]:
        renderer = open_renderer(self.built, self._wanted_renderer)[0] if self.closed else self.renderer()
        try:
            drawn = renderer.draw(self._state_at(at), camera)
        finally:
            if self.closed:
                renderer.close()
        return drawn.rgb, drawn.depth_m

    def film(self, each: Callable[[], None] | None, every_s: float) -> None:
        """Call `each` about every `every_s` of simulated time while something is moved; None stops it."""
        due = [self.time_s]

        def watch() -> None:
            if each is not None and self.time_s >= due[0]:
                due[0] = self.time_s + every_s
                each()

        self.mover.watch = None if each is None else watch

    def snapshot(self) -> Snapshot:
        """Where everything stands now, kept."""
        return Snapshot({name: getattr(self._state, name).copy() for name in DRAWN_FROM})

    def masks_at(self, at: Snapshot, camera: str) -> dict[str, Array]:
        """Which pixels of a view showed each thing at an earlier instant, shape (H, W) bool by name."""
        ids = self.renderer().bodies(self._state_at(at), camera)
        return {name: ids == self.built.body_id(name) for name in self.things}

    def poses_at(self, at: Snapshot) -> Poses:
        """True pose of each thing at an earlier instant."""
        return self._poses(self._state_at(at))

    def _state_at(self, at: Snapshot) -> Any:
        state = mj.MjData(self.built.model)
        for name, values in at.kept.items():
            getattr(state, name)[:] = values
        return state

    def slot_masks(self, slot: str, camera: str) -> dict[str, Array]:
        """Which pixels of an instruction's picture show each thing or prop, shape (H, W) bool by name; {} without pictures."""
        return {}

    def slot_stands(self, slot: str) -> list[tuple[Thing, Pose]]:
        """What an instruction's picture shows, props too, and where it stands in it; [] without pictures."""
        return []

    def close(self) -> None:
        """Give the renderer back; safe to call twice."""
        self.closed = True
        if self._opened is not None:
            self._opened.close()
            self._opened = None
