"""The scene as every member is shown it: views cut once, the instruction's pictures, and the plan in lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.values import Instruction, Limits, Observation, SlotKind, Subgoal, Target, View
from wonderful_team.images import whole

ARRANGED: frozenset[SlotKind] = frozenset(("scene", "frame"))
"""Kinds of the instruction's pictures that show where things belong."""


@dataclass(frozen=True, eq=False)
class SceneShown:
    """One observation and instruction, ready to be shown."""

    observation: Observation
    instruction: Instruction
    vocabulary: Vocabulary
    limits: Limits

    @property
    def view(self) -> View:
        """The main view."""
        return self.observation.main

    def arranged(self, target: Target) -> tuple[str, View] | None:
        """The instruction's scene that defines a place, as seen where the main view is: its name and view.

        None without one, and for one of another size: places in it are then no places in the main view.
        """
        main = next(iter(self.observation.views))
        for name in target.like if target.kind == "area" else ():
            slot = self.instruction.slots.get(name)
            if slot is not None and slot.kind in ARRANGED:
                view = slot.views.get(main) or next(iter(slot.views.values()))
                if view.size_px == self.view.size_px:
                    return name, view
        return None

    @cached_property
    def views(self) -> tuple[Picture, ...]:
        return show_views(self.observation)

    @cached_property
    def labelled(self) -> Picture:
        """The whole main view with labelled axes."""
        return self.views[0].marked(Axes())

    @cached_property
    def slots(self) -> tuple[ShownSlot, ...]:
        return tuple(
            ShownSlot(
                slot.name,
                slot.kind,
                tuple(whole(view, f"{{{slot.name}}} {name}") for name, view in slot.views.items()),
                slot.index,
            )
            for slot in self.instruction.slots.values()
        )

    @cached_property
    def task(self) -> ShownTask:
        return ShownTask(self.instruction.text, self.views, self.slots)

    def examples(self, targets: Sequence[Target]) -> tuple[ShownSlot, ...]:
        """The instruction's pictures of these targets, in the instruction's order."""
        wanted = {name for target in targets for name in target.like}
        return tuple(slot for slot in self.slots if slot.name in wanted)


def show_views(observation: Observation) -> tuple[Picture, ...]:
    """Every view whole, the main one first."""
    return tuple(whole(view, f"{name} view") for name, view in observation.views.items())


def plan_lines(subgoals: Sequence[Subgoal]) -> tuple[str, ...]:
    """A plan in lines, as the grounding team sees it."""
    return tuple(f"{subgoal.id}: {subgoal.text}" for subgoal in subgoals)
