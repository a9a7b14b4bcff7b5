"""What every table's truth says, whatever moves things on it: for scorers and simulated models only."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Generic, TypeVar

import numpy as np

from wonderful_team.core.values import GroundTruthView, Observation, TrueThing
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop.observation_log import ObservationLog, true_things
from wonderful_team.sims.tabletop.simulated_table import SimulatedTable

Kind = TypeVar("Kind", bound=SimulatedTable)


class TableTruth(Generic[Kind]):
    """The part of the SceneTruth protocol that follows from poses and looks."""

    def __init__(self, table: Kind) -> None:
        self._table = table
        self._sights = ObservationLog(table)

    def things(self) -> Mapping[str, TrueThing]:
        """Everything on the table as it stands now, by name."""
        return true_things(self._table.things, self._table.poses())

    def start(self) -> Mapping[str, TrueThing]:
        """The same, as it stood when the table was set."""
        return true_things(self._table.things, self._table.start)

    def observation_log(self, view_id: str) -> Sequence[GroundTruthView]:
        """What really was in every look at a view so far, newest first; one for an instruction's picture; () for an unknown id.

        Their masks are drawn when they are first asked for.
        """
        return self._sights.of(view_id)

    def saw(self, observation: Observation) -> None:
        """Told by the world of every look, so that it can say later what was really in it."""
        self._sights.keep(observation)

    def nudge(self, name: str, dx_m: float = 0.0, dy_m: float = 0.0, yaw_rad: float = 0.0) -> None:
        """Push a thing aside, as a person at the table might; things are at rest again afterwards.

        Raises:
            UnknownNameError: No such thing.
        """
        if name not in self._table.things:
            raise UnknownNameError("thing", name, self._table.things)
        pose = self._table.poses()[name]
        shift = np.array([dx_m, dy_m, 0.0])
        self._table.put(name, pose.position_m + shift, math.remainder(pose.yaw_rad + yaw_rad, 2 * math.pi))
