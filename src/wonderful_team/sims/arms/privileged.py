"""The truth of an arm's table, for scorers and simulated models only: never handed to a planner."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wonderful_team.core.actions import Action
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.protocols import Score
from wonderful_team.core.values import GroundTruthView, Observation, TrueThing
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.arms.oracle import solve_things
from wonderful_team.sims.arms.scoring import score_things
from wonderful_team.sims.arms.table import ArmTable
from wonderful_team.sims.tabletop.observation_log import ObservationLog, true_things


class ArmTruth:
    """Implements the SceneTruth protocol for one table."""

    def __init__(self, table: ArmTable) -> None:
        self._table = table
        self._log = ObservationLog(table)

    def things(self) -> Mapping[str, TrueThing]:
        """Everything on the table as it stands now, by name."""
        return true_things(self._table.things, self._table.poses())

    def start(self) -> Mapping[str, TrueThing]:
        """The same, as it stood when the table was set."""
        return true_things(self._table.things, self._table.start)

    def observation_log(self, view_id: str) -> Sequence[GroundTruthView]:
        """What really was in every look at a view so far, newest first; () for an unknown id."""
        return self._log.of(view_id)

    def saw(self, observation: Observation) -> None:
        """Told by the world of every look, so that it can say later what was really in it."""
        self._log.keep(observation)

    def score(self) -> Score:
        """Success, or failure with its stage, judged from how things are now."""
        table = self._table
        if table.work is not None:
            return table.work.score(table.poses())
        return score_things(table.rules, table.poses(), table.things, table.touched(), table.grips)

    def truth(self) -> Mapping[str, Any]:
        """Things with true poses, what the fingers closed on, and the goals, as plain values."""
        table, poses = self._table, self._table.poses()
        things = {
            name: {
                "shape": thing.shape,
                "kind": thing.body.kind,
                "texture": thing.texture,
                "position_m": tuple(float(v) for v in poses[name].position_m),
                "yaw_rad": poses[name].yaw_rad,
                "height_m": thing.body.height_m,
            }
            for name, thing in table.things.items()
        }
        return {
            "task": table.task.name,
            "seed": table.seed,
            "arm": table.asked.arm,
            "things": things,
            "held": table.held(),
            "grips": [to_jsonable(grip) for grip in table.grips],
            "goals": [to_jsonable(goal) for goal in table.rules.goals],
            "words": dict(table.scene.words),
            "horizon": table.task.horizon,
        }

    def oracle(self) -> Sequence[Action]:
        """Actions that solve the scene from here; [] when it is solved, or no way is known."""
        table = self._table
        if table.work is not None:
            return table.work.oracle(table.poses())
        return solve_things(table.rules, table.poses(), table.things, table.built.row)

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
