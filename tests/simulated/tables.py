"""Tables of the simulator with their simulated model, and questions as planning asks them."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.contracts import GiveBox, PlanDraft
from wonderful_team.contracts.draft_plan import DraftPlan
from wonderful_team.core.geometry import Box
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Request, Target, Trial
from wonderful_team.models.image_corruption import CHANGES, ImageCorruption
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.sims.tabletop import make_world
from wonderful_team.simulated import PROFILES, SimulatedModel


@dataclass
class Set:
    """A table, what a planner is shown of it, and the model that knows the truth."""

    world: Any
    scene: SceneShown
    model: SimulatedModel

    @property
    def truth(self) -> Any:
        return self.world.privileged

    def ask(self, question: Any, model: Model | None = None, request_id: str = "0/plan/main/0") -> Any:
        """The settled answer to one question."""
        pictures = getattr(question, "view", None) or getattr(question, "crop", None)
        parts = (pictures,) if pictures is not None else ()
        request = Request(request_id, "plan", "any", question, parts, question.output())
        return asyncio.run((model or self.model).answer(request)).value  # type: ignore[arg-type]

    def draft(self, shown: Any = None) -> PlanDraft:
        answer = self.ask(DraftPlan(shown or self.scene.task, self.world.vocabulary.step_kinds, True))
        assert isinstance(answer, PlanDraft)
        return answer

    def targets(self) -> list[Target]:
        return [draft.to_target() for draft in self.draft().targets]

    def thing_box(self, name: str) -> Box:
        """The true box of a thing in the main view [view px]."""
        mask = self.truth.masks()[name]
        rows, columns = mask.any(axis=1).nonzero()[0], mask.any(axis=0).nonzero()[0]
        return Box(columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)

    def shown_box(self, name: str) -> Box:
        """The same in pixels of the main view as it is shown."""
        return self.scene.views[0].frame.box_to_picture(self.thing_box(name))

    def given_box(self, target: Target) -> Box:
        """The box that the model gives for a target [view px]."""
        main = self.scene.views[0]
        return main.frame.box_to_view(self.ask(GiveBox(target, (), main)).box.as_box)

    def look(self) -> None:
        """Look again, at the table as it is now."""
        self.scene = SceneShown(self.world.observe(), self.world.instruction, self.world.vocabulary, self.world.limits)


@contextmanager
def set_table(task: str, seed: int = 500, profile: str = "perfect") -> Iterator[Set]:
    """A table that has been looked at once."""
    world = make_world(task, seed=seed)
    try:
        scene = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits)
        yield Set(world, scene, SimulatedModel(world.privileged, world.instruction, PROFILES[profile]))
    finally:
        world.close()


def solve(
    task: str, seed: int = 500, *, way: str = "lean", replans: int = 0, show: str = "", only: str = "",
    models: Mapping[str, Model] | None = None, profile: str = "perfect",
) -> Trial:  # fmt: skip
    """One attempt of the team with a simulated model, perhaps beside other models."""
    world = make_world(task, seed=seed)
    try:
        model: Model = SimulatedModel(world.privileged, world.instruction, PROFILES[profile])
        if show:
            model = ImageCorruption(model, CHANGES[show], only)
        team = TeamPolicy({"*": model, **(models or {})}, TeamConfig(mode=way))  # type: ignore[arg-type]
        return rollout(team, world, replans=replans, scorer=world.privileged, seed=seed, max_age_s=None)
    finally:
        world.close()


__all__ = ["Set", "set_table", "show_views", "solve"]
