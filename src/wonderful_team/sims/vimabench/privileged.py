"""The truth of an episode, for scorers and simulated models only: asked of the simulator when it is needed, never before."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wonderful_team.core.actions import Action, Vocabulary
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.core.values import GroundTruthView, Instruction, Observation, TrueThing, View
from wonderful_team.sims.process.client import Simulator
from wonderful_team.sims.vimabench.converting import pick_of, push_of
from wonderful_team.sims.vimabench.judging import score_of


@dataclass(frozen=True, eq=False)
class Episode:
    """What a world and its truth both know; `looks` grows: what could be seen at the start and after every action."""

    task: str
    seed: int
    vocabulary: Vocabulary
    instruction: Instruction
    looks: list[Observation] = field(default_factory=list)


class VimaTruth:
    """Implements the SceneTruth protocol for one episode."""

    def __init__(self, simulator: Simulator, episode: Episode) -> None:
        self._simulator, self._episode = simulator, episode
        self._things: tuple[int, Mapping[str, TrueThing]] | None = None
        self._sights: dict[tuple[str, int], GroundTruthView] = {}

    def score(self) -> Score:
        """The simulator's own word on success and failure within the horizon; the stage from what was touched."""
        said, _ = self._simulator.ask("score")
        return score_of(said)

    def truth(self) -> Mapping[str, Any]:
        """Things with true poses, what each picture slot shows, and the goals, as plain values."""
        said, _ = self._simulator.ask("truth")
        slots = self._episode.instruction.slots
        things = {
            name: {
                "shape": thing.shape,
                "kind": thing.kind,
                "texture": thing.cover,
                "position_m": tuple(float(value) for value in thing.position_m),
                "yaw_rad": thing.yaw_rad,
                "height_m": thing.height_m,
                "movable": thing.kind == "object",
                "grasp_m": tuple(float(value) for value in thing.grasp_m),
            }
            for name, thing in self.things().items()
        }
        shown: Mapping[str, Sequence[str]] = said["shown"]
        return {
            "task": self._episode.task,
            "seed": self._episode.seed,
            "things": things,
            "slots": {name: shown[name][0] if slot.kind == "object" else None for name, slot in slots.items()},
            "pictures": {
                name: {"kind": slot.kind, "index": slot.index, "stands": [{"thing": one} for one in shown[name]]}
                for name, slot in slots.items()
            },
            **{
                key: said[key] for key in ("props", "goals", "left", "distractors", "within_m", "within_rad", "horizon")
            },
        }

    def things(self) -> Mapping[str, TrueThing]:
        """Everything on the table as it stands now, by name."""
        look = len(self._episode.looks) - 1
        if self._things is None or self._things[0] != look:
            self._things = look, self._asked("now")
        return self._things[1]

    def start(self) -> Mapping[str, TrueThing]:
        """The same, as it stood when the world was made."""
        return self._asked("start")

    def observation_log(self, view_id: str) -> Sequence[GroundTruthView]:
        """What really was in every look at a view so far, newest first; one for an instruction's picture; () for an unknown id."""
        if view_id.startswith("slot:"):
            found = [
                self._sight(view, 0, "slot_masks", slot=slot.name)
                for slot in self._episode.instruction.slots.values()
                for view in slot.views.values()
                if view.id == view_id
            ]
            return tuple(found)
        looks = [(k, one.views[view_id]) for k, one in enumerate(self._episode.looks) if view_id in one.views]
        return tuple(self._sight(view, k, "masks", look=k) for k, view in reversed(looks))

    def masks(self, camera: str = "top") -> dict[str, Array]:
        """Which pixels of a view show each thing now, shape (H, W) bool by name."""
        return dict(self.observation_log(camera)[0].masks)

    def oracle(self) -> Sequence[Action]:
        """Actions that solve the episode from here; [] when it is over. Of pushes the next one only: ask again after each."""
        said, _ = self._simulator.ask("oracle")
        make = push_of if "push" in self._episode.vocabulary.kinds else pick_of
        return [make(action) for action in said["actions"]]

    def _asked(self, when: str) -> dict[str, TrueThing]:
        said, _ = self._simulator.ask("things", when=when)
        return {one["name"]: TrueThing(**one) for one in said["things"]}

    def _sight(self, view: View, number: int, what: str, **which: Any) -> GroundTruthView:
        key = (view.id, number)
        if key not in self._sights:
            said, pictures = self._simulator.ask(what, camera=view.camera_name, **which)
            bodies = pictures["bodies"]
            masks = {str(name): np.asarray(bodies == int(body)) for body, name in said["names"].items()}
            self._sights[key] = GroundTruthView(view.without_depth(), masks)
        return self._sights[key]
