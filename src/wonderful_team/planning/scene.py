"""The scene as every member is shown it: views cut once, the instruction's pictures, and the plan in lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Picture
from wonderful_team.core.values import Instruction, KeepOut, Limits, Observation, SlotKind, Subgoal, Target, View
from wonderful_team.images import whole
from wonderful_team.images.keep_out import region_px, table_height_m

ARRANGED: frozenset[SlotKind] = frozenset(("scene", "frame"))
"""Kinds of the instruction's pictures that show where things belong."""


@dataclass(frozen=True, eq=False)
class SceneShown:
    """One observation and instruction, ready to be shown.

    Attributes:
        facts: What is known of the robot and its place, one fact a line.
        keep_out: Regions nothing may enter, beside those of the limits; they are drawn on the main view.
    """

    observation: Observation
    instruction: Instruction
    vocabulary: Vocabulary
    limits: Limits
    facts: str = ""
    keep_out: tuple[KeepOut, ...] = ()

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
        main, *others = show_views(self.observation)
        regions = dict.fromkeys((*self.limits.keep_out, *self.keep_out))
        return main.marked(*keep_out_marks(main, self.view, regions, self.limits)), *others

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
        facts = tuple(line.strip() for line in self.facts.splitlines() if line.strip())
        return ShownTask(self.instruction.text, self.views, self.slots, facts)

    def examples(self, targets: Sequence[Target]) -> tuple[ShownSlot, ...]:
        """The instruction's pictures of these targets, in the instruction's order.

        A place is found with the scenes that define it. Where nobody says which these are, it gets all of them.
        """
        scenes = {slot.name for slot in self.slots if slot.whole_scene}
        wanted = {name for target in targets for name in target.like}
        for target in targets:
            if target.kind == "area" and not scenes & set(target.like):
                wanted |= scenes
        return tuple(slot for slot in self.slots if slot.name in wanted)


def keep_out_marks(picture: Picture, view: View, regions: Iterable[KeepOut], limits: Limits) -> tuple[BoxMark, ...]:
    """Regions that nothing may enter, as boxes on a whole view; what no camera can place in it is left out."""
    marks = []
    for region in regions:
        shape = region_px(region, view.camera, table_height_m(limits))
        box = None if shape is None else Box(*shape.bounds).intersection(Box(0, 0, *view.size_px))
        if box is not None:
            marks.append(BoxMark(picture.frame.box_to_picture(box), "keep_out", region.name))
    return tuple(marks)


def show_views(observation: Observation) -> tuple[Picture, ...]:
    """Every view whole, the main one first."""
    return tuple(whole(view, f"{name} view") for name, view in observation.views.items())


def plan_lines(subgoals: Sequence[Subgoal]) -> tuple[str, ...]:
    """A plan in lines, as the grounding team sees it."""
    return tuple(f"{subgoal.id}: {subgoal.text}" for subgoal in subgoals)
