"""The scene as every member is shown it: views cut once, the instruction's pictures, and the plan in lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.pictures import Axes, Picture, RegionMark
from wonderful_team.core.values import Instruction, KeepOut, Limits, Observation, Slot, SlotKind, Subgoal, Target, View
from wonderful_team.images import whole
from wonderful_team.images.cut import MARKED_SIDE_PX
from wonderful_team.images.keep_out import region_px, table_height_m
from wonderful_team.images.single import changed_pair, cut_outs
from wonderful_team.images.stacked import lies_over

ARRANGED: frozenset[SlotKind] = frozenset(("scene", "frame"))
"""Kinds of the instruction's pictures that show where things belong."""


@dataclass(frozen=True, eq=False)
class SceneShown:
    """One observation and instruction, ready to be shown.

    Attributes:
        facts: What is known of the robot and its place, one fact a line.
        keep_out: Regions nothing may enter, beside those of the limits; they are drawn on the main view.
        said: What the user said beside the instruction, one line each: answers to questions, why a plan was declined.
        done: What was carried out since the instruction was given, as planned, one line each.
    """

    observation: Observation
    instruction: Instruction
    vocabulary: Vocabulary
    limits: Limits
    facts: str = ""
    keep_out: tuple[KeepOut, ...] = ()
    said: tuple[str, ...] = ()
    done: tuple[str, ...] = ()

    @property
    def view(self) -> View:
        """The main view."""
        return self.observation.main

    def arranged(self, target: Target) -> tuple[str, View] | None:
        """The instruction's scene that defines a place, as seen where the main view is: its name and view.

        Of several frames of a motion, the last one: a motion ends there. None without one, and for one of another size:
        places in it are then no places in the main view.
        """
        main = next(iter(self.observation.views))
        named = (self.instruction.slots.get(name) for name in target.like if target.kind == "area")
        scenes = [slot for slot in named if slot is not None and slot.kind in ARRANGED]
        for slot in sorted(scenes, key=lambda one: one.index if one.index is not None else -1, reverse=True):
            view = slot.views.get(main) or next(iter(slot.views.values()))
            if view.size_px == self.view.size_px:
                return slot.name, view
        return None

    @cached_property
    def views(self) -> tuple[Picture, ...]:
        """Every view whole, the main one first and large, with the regions that nothing may enter drawn on it."""
        main, *others = show_views(self.observation)
        regions = dict.fromkeys((*self.limits.keep_out, *self.keep_out))
        return main.marked(*keep_out_marks(main, self.view, regions, self.limits)), *others

    @cached_property
    def labelled(self) -> Picture:
        """The whole main view with labelled axes."""
        return self.views[0].marked(Axes())

    @cached_property
    def slots(self) -> tuple[ShownSlot, ...]:
        """The instruction's pictures: single things and what differs in pairs cut out, whole tables as large as the main view.

        A view from another side than the main one is shown of single things, and of whole tables where something lies over
        something else: elsewhere it tells nothing that the view from the main side does not.
        """
        shown = self._single_things() | self._pairs()
        for name, slot in self.instruction.slots.items():
            if name not in shown:
                shown[name] = tuple(self._table(slot, key) for key in self._useful(slot))
        return tuple(
            ShownSlot(name, slot.kind, shown[name], slot.index, self._times(slot, shown[name]))
            for name, slot in self.instruction.slots.items()
        )

    def _times(self, slot: Slot, pictures: tuple[Picture, ...]) -> float | None:
        """How many times as large as in the main view's picture a slot's things are shown."""
        if not pictures or not self._same_camera(next(iter(slot.views.values()))):
            return None
        return pictures[0].frame.scale / self.views[0].frame.scale

    def _same_camera(self, view: View) -> bool:
        return view.camera_name == self.view.camera_name and view.size_px == self.view.size_px

    def _single_things(self) -> dict[str, tuple[Picture, ...]]:
        things = [slot for slot in self.instruction.slots.values() if slot.kind == "object"]
        shots = [[(_named(slot, key), view) for key, view in slot.views.items()] for slot in things]
        return {slot.name: pictures for slot, pictures in zip(things, cut_outs(shots), strict=True)}

    def _pairs(self) -> dict[str, tuple[Picture, ...]]:
        """What differs between before and after, from the main side; from the others too where something is covered."""
        shown: dict[str, tuple[Picture, ...]] = {}
        ends = {slot.index: slot for slot in self.instruction.slots.values() if slot.kind == "after"}
        for slot in self.instruction.slots.values():
            end = ends.get(slot.index) if slot.kind == "before" else None
            if end is None:
                continue
            (key, first), *others = slot.views.items()
            pair = (
                changed_pair((_named(slot, key), first), (_named(end, key), end.views[key]))
                if key in end.views
                else None
            )
            if pair is None:
                continue
            flat = not lies_over(first, end.views[key])
            shown[slot.name], shown[end.name] = (
                (picture, *(() if flat else (self._table(one, other) for other, _ in others if other in one.views)))
                for picture, one in zip(pair, (slot, end), strict=True)
            )
        return shown

    def _useful(self, slot: Slot) -> tuple[str, ...]:
        """The views of a picture of a whole table that are worth showing: all, or the main side's alone."""
        key, view = next(iter(slot.views.items()))
        return (key,) if self._same_camera(view) and not lies_over(self.view, view) else tuple(slot.views)

    def _table(self, slot: Slot, key: str) -> Picture:
        """A picture of a whole table, as large as the main view where it is that camera's."""
        view = slot.views[key]
        if self._same_camera(view):
            return whole(view, _named(slot, key), long_side_px=MARKED_SIDE_PX)
        return whole(view, _named(slot, key))

    @cached_property
    def ticked_slots(self) -> tuple[ShownSlot, ...]:
        """The same; what the main camera sees of a whole table carries tick labels in the main view's pixels."""
        main = self.views[0]

        def ticked(picture: Picture) -> Picture:
            alike = picture.size_px == main.size_px and np.array_equal(
                picture.frame.T_view_picture, main.frame.T_view_picture
            )
            return picture.marked(Axes(main.frame)) if alike else picture

        return tuple(
            slot if slot.kind == "object" else replace(slot, pictures=tuple(ticked(item) for item in slot.pictures))
            for slot in self.slots
        )

    @cached_property
    def task(self) -> ShownTask:
        facts = tuple(line.strip() for line in self.facts.splitlines() if line.strip())
        facts += scale_facts(self.view, self.limits)
        return ShownTask(self.instruction.text, self.views, self.slots, facts, self.said, self.done)

    def examples(self, targets: Sequence[Target], ticks: bool = True) -> tuple[ShownSlot, ...]:
        """The instruction's pictures of these targets, in the instruction's order; whole tables with tick labels or without.

        A place is found with the scenes that define it. Where nobody says which these are, it gets all of them. Of a whole
        table that the main camera sees, the other views say nothing of where something lies in the main one.
        """
        scenes = {slot.name for slot in self.slots if slot.whole_scene}
        wanted = {name for target in targets for name in target.like}
        for target in targets:
            if target.kind == "area" and not scenes & set(target.like):
                wanted |= scenes
        found = (slot for slot in (self.ticked_slots if ticks else self.slots) if slot.name in wanted)
        return tuple(replace(slot, pictures=self._from_main(slot)) for slot in found)

    def _from_main(self, slot: ShownSlot) -> tuple[Picture, ...]:
        """A slot's pictures; of a whole table those of the main camera alone, where it has any."""
        main = self.views[0].size_px
        same = tuple(picture for picture in slot.pictures if picture.size_px == main) if slot.whole_scene else ()
        return same or slot.pictures


def scale_facts(view: View, limits: Limits) -> tuple[str, ...]:
    """How much of the table the main view spans, as a fact: lengths in other facts can so be told in the picture."""
    if view.camera is None:
        return ()
    width, height = view.size_px
    try:
        left, right = view.camera.on_plane(np.array([[0.0, height / 2], [width, height / 2]]), table_height_m(limits))
    except ValueError:
        return ()  # a side of the picture looks past the table
    span_m = float(np.linalg.norm(right - left))
    if not np.isfinite(span_m):
        return ()
    return (
        f"Scale: from its left to its right edge, across its middle, the main view shows {100 * span_m:.3g} cm of the table.",
    )


def keep_out_marks(picture: Picture, view: View, regions: Iterable[KeepOut], limits: Limits) -> tuple[RegionMark, ...]:
    """Regions that nothing may enter, as outlines on a whole view; what no camera can place in it is left out."""
    marks = []
    for region in regions:
        shape = region_px(region, view.camera, table_height_m(limits))
        if shape is not None:
            corners = tuple(picture.frame.point_to_picture(xy) for xy in shape.exterior.coords[:-1])
            marks.append(RegionMark(corners, region.name))
    return tuple(marks)


def show_views(observation: Observation, when: str = "") -> tuple[Picture, ...]:
    """Every view whole, the main one first and enlarged; `when` is added to their names."""
    return tuple(
        whole(view, f"{name} view{when}", long_side_px=0 if number else MARKED_SIDE_PX)
        for number, (name, view) in enumerate(observation.views.items())
    )


def _named(slot: Slot, camera: str) -> str:
    return f"{{{slot.name}}} {camera}"


def plan_lines(subgoals: Sequence[Subgoal]) -> tuple[str, ...]:
    """A plan in lines, as the grounding team sees it."""
    return tuple(f"{subgoal.id}: {subgoal.text}" for subgoal in subgoals)
