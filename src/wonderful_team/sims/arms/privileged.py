"""The truth of an arm's table, for scorers and simulated models only: never handed to a planner."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from wonderful_team.core.actions import Action
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.oracle import solve_things
from wonderful_team.sims.arms.scoring import score_things
from wonderful_team.sims.arms.table import ArmTable
from wonderful_team.sims.tabletop.truth import TableTruth


class ArmTruth(TableTruth[ArmTable]):
    """Implements the SceneTruth protocol for one table."""

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
            "disturbances": [to_jsonable(one) for one in table.disturbances.happened],
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
