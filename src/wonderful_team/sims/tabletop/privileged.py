"""The truth of a table, for scorers and simulated models only: never handed to a planner."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from wonderful_team.core.actions import Action
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.protocols import Score
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop import oracle as _oracle
from wonderful_team.sims.tabletop import oracle_push
from wonderful_team.sims.tabletop.judging import reached_of, score_of
from wonderful_team.sims.tabletop.table import Table
from wonderful_team.sims.tabletop.truth import TableTruth


class TabletopTruth(TableTruth[Table]):
    """Implements the SceneTruth protocol for one table."""

    def score(self) -> Score:
        """Success, or failure with its stage, judged from the true poses after every action."""
        return score_of(self._table.rules, self._table.history, self._table.things)

    def subgoals_reached(self) -> int:
        """How many goals were met, and things gathered, after some action within the horizon and not before the first."""
        return reached_of(self._table.rules, self._table.history)

    @property
    def failed(self) -> bool:
        """Whether nothing that happens from here on can make it a success."""
        table = self._table
        return table.history[-1].verdict.state == "failure" or len(table.history) > table.rules.horizon

    def truth(self) -> Mapping[str, Any]:
        """Things with true poses, what each picture slot shows, and the goals, as plain values.

        `slots` names the thing that a picture shows alone (None: a picture of the table); `pictures` says everything.
        """
        poses = self._table.poses()
        things = {
            name: {
                "shape": thing.shape,
                "kind": thing.body.kind,
                "texture": thing.texture,
                "stretch": thing.stretch,
                "position_m": tuple(float(v) for v in poses[name].position_m),
                "yaw_rad": poses[name].yaw_rad,
                "height_m": thing.body.height_m,
                "movable": thing.body.movable,
                "grasp_m": _oracle.grasp_point(thing, poses[name]),
            }
            for name, thing in self._table.things.items()
        }
        rules, progress = self._table.rules, self._table.history[-1].progress
        pictures = self._table.scene.pictures
        return {
            "task": self._table.task.name,
            "seed": self._table.seed,
            "things": things,
            "slots": {slot: shown.thing for slot, shown in pictures.items()},
            "pictures": {slot: to_jsonable(shown) for slot, shown in pictures.items()},
            "props": {
                p.name: {"shape": p.shape, "texture": p.texture, "stretch": p.stretch} for p in self._table.scene.props
            },
            "words": dict(self._table.scene.words),
            "goals": [to_jsonable(goal) for goal in rules.goals],
            "phases": [[to_jsonable(goal) for goal in phase] for phase in rules.phases],
            "phase": progress.phase,
            "counts": [to_jsonable(count) for count in rules.counts],
            "counted": [sorted(inside) for inside in progress.counted],
            "never": [to_jsonable(never) for never in rules.nevers],
            "distractors": list(rules.distractors),
            "horizon": rules.horizon,
        }

    def masks(self, camera: str = "top") -> dict[str, Array]:
        """Which pixels of a view show each thing now, shape (H, W) bool by name."""
        ids = self._table.body_picture(camera)
        return {name: ids == self._table.built.body_id(name) for name in self._table.things}

    def mask(self, name: str, camera: str = "top") -> Array:
        """Which pixels of a view show one thing now, shape (H, W) bool.

        Raises:
            UnknownNameError: No such thing.
        """
        if name not in self._table.things:
            raise UnknownNameError("thing", name, self._table.things)
        return self.masks(camera)[name]

    def oracle(self) -> Sequence[Action]:
        """Actions that solve the scene from here; [] when it is solved, lost, or no way is known.

        Pushes do not end exactly where they should: for these ask again after every action.
        """
        table = self._table
        progress, poses = table.history[-1].progress, table.poses()
        if table.built.tool == "spatula":
            return oracle_push.solve(table.rules, progress, poses, table.things)
        return _oracle.solve(table.rules, progress, poses, table.things)
