"""Worlds with an arm, driven action by action."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

import wonderful_team as wt
from wonderful_team.core.actions import Action
from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Score
from wonderful_team.core.values import StepReport, Trial
from wonderful_team.sims.arms import ArmWorld
from wonderful_team.sims.tabletop.moving import put_body


def play(world: ArmWorld, actions: Iterable[Action]) -> tuple[Score, list[StepReport]]:
    """Run these actions; how the scene is judged then, and what was reported."""
    reports = [world.execute(action) for action in actions]
    return world.privileged.score(), reports


def by_team(task: str, seed: int, model: str = "simulated:perfect", **options: Any) -> Trial:
    """The whole team, once through a task."""
    world = wt.make_world(task, seed=seed)
    try:
        return wt.rollout(wt.Team(model=model), world, **options)
    finally:
        world.close()


def lay_down(world: ArmWorld, name: str) -> None:
    """A thing lies on its side where it stood."""
    table: Any = world._table
    at = table.poses()[name].position_m + np.array([0.0, 0.0, 0.05])
    put_body(table.built, table._state, name, Pose(at, np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0])))
    table.rest()
