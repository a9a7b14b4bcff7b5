"""What a task function is given: put things on the table, fill the instruction's slots, say what the goal is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from wonderful_team.core.values import SlotKind
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import textures
from wonderful_team.sims.tabletop.goals import NEAR_M, Count, Goal, Never, Zone, footprint_at
from wonderful_team.sims.tabletop.likeness import look_alikes
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.placing import CrowdedError, Floor, Room, Spot
from wonderful_team.sims.tabletop.rules import Distractors, Order
from wonderful_team.sims.tabletop.showing import Shown, Stand

__all__ = ["CrowdedError", "Scene", "Spot"]


@dataclass
class Scene(Floor):
    """A table being set.

    Attributes:
        partition: Generalisation level that was asked for (L1 to L4), or None; see `tasks/choices.py`.
        alike: How much alike the covers are that `pick_textures` draws: from 0, at random, to 3, the most alike.
        clutter: Names of things that no rule is about.
        whole: Picture slots that show all that stands on the table.
        words: Text slots of the instruction; a word may hold picture slots of its own.
        pictures: Picture slots.
        ends_when_reached, order, distractors_matter, goals_last: See `rules.Rules`.
        side_m: How far to the left or right of the table's middle what is to be moved may stand, and where it goes [m].
    """

    partition: str | None = None
    alike: int = 0
    clutter: list[str] = field(default_factory=list)
    whole: list[str] = field(default_factory=list)
    phases: list[list[Goal]] = field(default_factory=lambda: [[]])
    counts: list[Count] = field(default_factory=list)
    nevers: list[Never] = field(default_factory=list)
    distractors: list[str] = field(default_factory=list)
    words: dict[str, str] = field(default_factory=dict)
    pictures: dict[str, Shown] = field(default_factory=dict)
    ends_when_reached: bool = True
    order: Order = "free"
    distractors_matter: Distractors = "always"
    goals_last: bool = False
    side_m: float = math.inf
    _drawn: list[str] = field(default_factory=list)

    def add(
        self,
        shape_name: str,
        texture: str,
        *,
        at: tuple[float, float] | None = None,
        on: Thing | None = None,
        within: Room | None = None,
        yaw_rad: float | None = None,
        name: str | None = None,
        distractor: bool = False,
        stretch: float = 1.0,
        lifted_m: float | None = None,
    ) -> Thing:
        """Put a thing on the table.

        Args:
            shape_name: One of `shapes.shape_names()`.
            texture: One of `textures.texture_names(dark=True)`.
            at: Where its centre goes, (x, y) [m]; None for a free place.
            on: A flat area to stand on, at a free place on it.
            within: A part of the table to stand on (low x, low y, high x, high y) [m].
            yaw_rad: How it is turned, counter-clockwise; None for any way.
            name: Unique name; made from shape and texture if not given.
            distractor: Whether it must be kept away from the targets.
            stretch: How many times as high as usual it is.
            lifted_m: How high its bottom is at first, when it is put into or onto something with `at` [m].

        Raises:
            UnknownNameError: No such shape or texture.
            ConfigError: The name is taken.
        """
        yaw = float(self.layout.uniform(-math.pi, math.pi)) if yaw_rad is None else yaw_rad
        lifted = (0.001 if on is not None else 0.0) if lifted_m is None else lifted_m
        draft = self.made(shape_name, texture, name, yaw, lifted, stretch)
        name = draft.name
        x, y = at if at is not None else self.free_place(draft, on=on, within=within)
        thing = replace(draft, x_m=float(x), y_m=float(y))
        self.things.append(thing)
        self.covered.append(footprint_at(thing, thing.x_m, thing.y_m, yaw).convex_hull)
        if distractor:
            self.distractors.append(name)
        return thing

    def prop(self, shape_name: str, texture: str, *, stretch: float = 1.0, name: str | None = None) -> Thing:
        """A thing that is only seen in pictures of the instruction, never on the table.

        Raises:
            UnknownNameError: No such shape or texture.
            ConfigError: The name is taken.
        """
        made = self.made(shape_name, texture, name and f"{name} (picture)", 0.0, 0.0, stretch)
        self.props.append(made)
        return made

    def goal(
        self,
        thing: Thing,
        *,
        near: Thing | Sequence[Thing] = (),
        at: tuple[float, float] | None = None,
        inside: Thing | Sequence[Thing] = (),
        off: Sequence[Thing] = (),
        within_m: float = NEAR_M,
        turned_rad: float | None = None,
    ) -> None:
        """Say where a thing has to end; several goals must all be met. `turned_rad` counts from its pose now."""
        yaw = None if turned_rad is None else thing.yaw_rad + turned_rad
        self.phases[-1].append(Goal(thing.name, _names(near), at, _names(inside), _names(off), within_m, yaw))

    def then(self) -> None:
        """Goals from here on belong to a next phase: they count once all goals before are met together."""
        if self.phases[-1]:
            self.phases.append([])

    def count(
        self,
        things: Sequence[Thing],
        zone: tuple[Thing, Sequence[tuple[float, float]]],
        *,
        exactly: int,
        none_of: Sequence[Thing] = (),
    ) -> None:
        """Say that exactly so many of these things have to come to lie in a zone, and none of some others.

        Args:
            things: Those that count.
            zone: A thing and the corners (a right, b up) of a region that belongs to it [m].
            exactly: How many.
            none_of: Those of which no part may enter the zone.

        Raises:
            ConfigError: More are wanted than there are.
        """
        if not 1 <= exactly <= len(things):
            raise ConfigError(f"count: exactly must be from 1 to {len(things)} (the things that count), got {exactly}")
        self.counts.append(Count(_names(things), Zone(zone[0].name, tuple(zone[1])), exactly, _names(none_of)))

    def never(self, things: Sequence[Thing], *, over: Thing) -> None:
        """Say what these things may not overlap, not even on the way."""
        self.nevers.append(Never(_names(things), over.name))

    @property
    def goals(self) -> list[Goal]:
        """The goals of all phases."""
        return [goal for phase in self.phases for goal in phase]

    @property
    def wants_something(self) -> bool:
        """Whether there is anything to judge."""
        return bool(self.goals or self.counts)

    def say(self, **words: str) -> None:
        """Fill text slots of the instruction."""
        self.words.update(words)

    def show(self, **pictures: Thing) -> None:
        """Fill picture slots with one thing each, alone on white."""
        self.pictures.update({slot: Shown("object", None, (Stand(thing.name),)) for slot, thing in pictures.items()})

    def show_table(
        self,
        slot: str,
        *,
        moved: Mapping[Thing, Stand] | None = None,
        only: Sequence[Thing] | None = None,
        kind: SlotKind = "scene",
        index: int | None = None,
    ) -> None:
        """Fill a picture slot with the table as it stands at the start, or changed.

        Args:
            slot: Name of the slot.
            moved: Where some things stand in the picture; others stand as they do at the start.
            only: What is to be seen, where not everything on the table; may name props.
            kind: scene, frame, before or after.
            index: Place in a sequence of frames or pairs.
        """
        stands = {thing.name: stand for thing, stand in (moved or {}).items()}
        seen = self.things if only is None else only
        everything = tuple(stands.get(t.name, Stand(t.name)) for t in seen)
        self.pictures[slot] = Shown(kind, index, everything)
        if only is None:
            self.whole.append(slot)

    def pick_textures(self, count: int, among: Sequence[str] | None = None) -> list[str]:
        """Different textures, drawn by the colour generator; in harder scenes they look like those drawn before."""
        names = list(among if among is not None else textures.texture_names())
        drawn = [names[int(k)] for k in self.colours.choice(len(names), size=count, replace=False)]
        if self.alike:
            drawn = look_alikes(drawn, names, self._drawn, self.alike)
        self._drawn += drawn
        return drawn


def _names(things: Thing | Sequence[Thing]) -> tuple[str, ...]:
    return (things.name,) if isinstance(things, Thing) else tuple(thing.name for thing in things)
