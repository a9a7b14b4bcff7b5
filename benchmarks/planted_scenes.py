"""Scenes in which faults are planted, with what is true of them, and what a member says of one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from benchmarks.offline_success import VIMA
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import (
    PlanReview,
    Question,
    WalkedReview,
)
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.models.client import ModelClient
from wonderful_team.offline import OfflineModel
from wonderful_team.planning import TeamConfig
from wonderful_team.planning.session import AgentSession
from wonderful_team.sims.tabletop import TabletopWorld, make_world

TASKS = (*VIMA, "fruit_placement/both", "fruit_placement/misplaced")


@dataclass
class Scene:
    """One world with what is shown of it and what is true of it."""

    task: str
    seed: int
    world: TabletopWorld
    shown: SceneShown
    masks: dict[str, np.ndarray] = field(repr=False)

    @property
    def truth(self) -> Any:
        return self.world.privileged.truth()

    def box(self, name: str) -> Box:
        """Tight box of a thing in the main view [px]."""
        rows, columns = np.nonzero(self.masks[name])
        return Box(columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)


@lru_cache(maxsize=8)
def scene(task: str, seed: int) -> Scene:
    """Set one scene up."""
    world = make_world(task, seed=seed)
    shown = SceneShown(world.observe(), world.instruction, PICK_PLACE, world.limits)
    return Scene(task, seed, world, shown, world.privileged.masks())


def scenes(first: int) -> Iterator[Scene]:
    """Scenes of all tasks in turn, for ever."""
    seed = first
    while True:
        for task in TASKS:
            yield scene(task, seed)
        seed += 1


def session_for(shown: SceneShown) -> AgentSession:
    return AgentSession(ModelClient(OfflineModel()), TeamConfig(ablation="s8"), shown.instruction.text)


async def objection(session: AgentSession, question: Question, stage: str) -> str | None:
    """What the member objects, or None when it lets the thing pass. A member that refuses to judge objects."""
    try:
        answer = await session.ask(question, stage=stage)
    except WonderfulTeamError as error:
        return f"refused: {str(error)[:160]}"
    if isinstance(answer, PlanReview | WalkedReview):
        return answer.doubt.question[:160] if answer.doubt else None
    return None if answer.decision == "accept" else f"{answer.decision}: {answer.problem[:160]}"
