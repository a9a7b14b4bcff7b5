"""What every world of a simulated table has: its looks, its film, its end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Generic, TypeVar

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Instruction, LaterView, Observation, RobotState
from wonderful_team.sims.tabletop.cameras import CAMERA_NAMES
from wonderful_team.sims.tabletop.simulated_table import SimulatedTable, Snapshot
from wonderful_team.sims.tabletop.truth import TableTruth

TableKind = TypeVar("TableKind", bound=SimulatedTable)
TruthKind = TypeVar("TruthKind", bound=TableTruth[Any])


class SimulatedWorld(ABC, Generic[TableKind, TruthKind]):
    """Looks at a table, the same way for everything that moves things on it."""

    _table: TableKind
    privileged: TruthKind
    _seen: tuple[Snapshot, Observation] | None = None

    @abstractmethod
    def _robot(self) -> RobotState:
        """What the robot knows of itself now."""

    @cached_property
    def instruction(self) -> Instruction:
        """Words and pictures; the pictures are drawn when they are first asked for."""
        return self._table.instruction()

    @property
    def renderer(self) -> str:
        """How pictures are drawn: egl, osmesa or rays."""
        return self._table.renderer().name

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know of how this world runs, such as a missing OpenGL."""
        return self._table.notes

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self._table.time_s

    def observe(self) -> Observation:
        """Both views of the table as it stands now; drawn again only when something moved."""
        table = self._table
        at = table.snapshot()
        if self._seen is not None and not table.closed:
            before, seen = self._seen
            if before.same_as(at) and seen.main.time_s == self.time_s:
                return seen
        views = {}
        for name in CAMERA_NAMES:
            lens = table.built.lenses[name]
            views[name] = LaterView(name, name, self.time_s, lens.size_px, table.look(name), lens.camera)
        observation = Observation(views, self._robot())
        self.privileged.saw(observation)
        self._seen = (at, observation)
        return observation

    def film(self, each: Callable[[Mapping[str, Array]], None] | None, every_s: float = 0.1) -> None:
        """Hand pictures of all cameras to `each` while an action runs; for people: no planner is shown them."""

        def picture() -> None:
            if each is not None:
                each({name: self._table.draw(name).rgb for name in CAMERA_NAMES})

        self._table.film(None if each is None else picture, every_s)

    def close(self) -> None:
        """Give everything back; safe to call twice."""
        self._table.close()
