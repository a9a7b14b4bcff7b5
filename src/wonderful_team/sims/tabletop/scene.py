"""What a task function is given: put things on the table, fill the instruction's slots, say what the goal is."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from shapely import box
from shapely.geometry.base import BaseGeometry

from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import textures
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.goals import NEAR_M, Goal, footprint_at
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.shapes import shape

GAP_M = 0.012
"""Free table between two things that are placed at random [m]."""
TRIES = 200
EDGE_M = 0.008


class CrowdedError(Exception):
    """No free place was found; the scene is started afresh."""


def generator(seed: int, purpose: str, attempt: int) -> np.random.Generator:
    """One independent generator per purpose, so that a change in one leaves the others alone."""
    return np.random.default_rng([seed, zlib.crc32(purpose.encode()), attempt])


@dataclass
class Scene:
    """A table being set.

    Attributes:
        colours: Generator for colours and textures alone; `recolour` changes its seed and nothing else.
        words: Text slots of the instruction.
        pictures: Picture slots: name of the thing shown alone, or None for the whole table.
    """

    layout: np.random.Generator
    colours: np.random.Generator
    things: list[Thing] = field(default_factory=list)
    goals: list[Goal] = field(default_factory=list)
    distractors: list[str] = field(default_factory=list)
    words: dict[str, str] = field(default_factory=dict)
    pictures: dict[str, str | None] = field(default_factory=dict)
    ends_when_reached: bool = True
    _covered: list[BaseGeometry] = field(default_factory=list)

    def add(
        self,
        shape_name: str,
        texture: str,
        *,
        at: tuple[float, float] | None = None,
        on: Thing | None = None,
        yaw_rad: float | None = None,
        name: str | None = None,
        distractor: bool = False,
    ) -> Thing:
        """Put a thing on the table.

        Args:
            shape_name: One of `shapes.shape_names()`.
            texture: One of `textures.texture_names(dark=True)`.
            at: Where its centre goes, (x, y) [m]; None for a free place.
            on: A flat area to stand on, at a free place on it.
            yaw_rad: How it is turned, counter-clockwise; None for any way.
            name: Unique name; made from shape and texture if not given.
            distractor: Whether it must be kept away from the targets.

        Raises:
            UnknownNameError: No such shape or texture.
            ConfigError: The name is taken.
        """
        body = shape(shape_name)
        textures.texture(texture)
        name = name or self._free_name(f"{texture} {shape_name}")
        if any(thing.name == name for thing in self.things):
            raise ConfigError(f"two things are called {name!r}; names in a scene must differ")
        yaw = float(self.layout.uniform(-math.pi, math.pi)) if yaw_rad is None else yaw_rad
        lifted = 0.001 if on is not None else 0.0
        draft = Thing(name, body.name, texture, 0.0, 0.0, yaw, lifted)
        x, y = at if at is not None else self._free_place(draft, on)
        thing = Thing(name, body.name, texture, float(x), float(y), yaw, lifted)
        self.things.append(thing)
        self._covered.append(footprint_at(thing, thing.x_m, thing.y_m, yaw).convex_hull)
        if distractor:
            self.distractors.append(name)
        return thing

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
        self.goals.append(Goal(thing.name, _names(near), at, _names(inside), _names(off), within_m, yaw))

    def say(self, **words: str) -> None:
        """Fill text slots of the instruction."""
        self.words.update(words)

    def show(self, **pictures: Thing) -> None:
        """Fill picture slots with one thing each, alone on white."""
        self.pictures.update({slot: thing.name for slot, thing in pictures.items()})

    def show_table(self, slot: str) -> None:
        """Fill a picture slot with the whole table as it stands at the start."""
        self.pictures[slot] = None

    def pick_textures(self, count: int, among: Sequence[str] | None = None) -> list[str]:
        """Different textures, drawn by the colour generator."""
        names = list(among if among is not None else textures.texture_names())
        return [names[int(k)] for k in self.colours.choice(len(names), size=count, replace=False)]

    def _free_name(self, wanted: str) -> str:
        taken = {thing.name for thing in self.things}
        count = 1
        while (name := wanted if count == 1 else f"{wanted} {count}") in taken:
            count += 1
        return name

    def _free_place(self, draft: Thing, on: Thing | None) -> tuple[float, float]:
        table = box(TABLE_LOW_M[0], TABLE_LOW_M[1], TABLE_HIGH_M[0], TABLE_HIGH_M[1]).buffer(
            -EDGE_M, join_style="mitre"
        )
        room = footprint_at(on, on.x_m, on.y_m, on.yaw_rad) if on is not None else table
        low_x, low_y, high_x, high_y = room.bounds
        outline = footprint_at(draft, 0.0, 0.0, draft.yaw_rad).convex_hull
        own = outline.bounds
        others = [c for t, c in zip(self.things, self._covered, strict=True) if on is None or t.name != on.name]
        centres = [(t.x_m, t.y_m) for t in self.things if on is None or t.name != on.name]
        if own[2] - own[0] > high_x - low_x or own[3] - own[1] > high_y - low_y:
            raise ConfigError(f"{draft.name!r} is too large for the place it should stand on")
        for _ in range(TRIES):
            x = float(self.layout.uniform(low_x - own[0], high_x - own[2]))
            y = float(self.layout.uniform(low_y - own[1], high_y - own[3]))
            if on is None and any(math.dist((x, y), c) < 1.2 * NEAR_M for c in centres):
                continue
            placed = footprint_at(draft, x, y, draft.yaw_rad).convex_hull
            if room.covers(placed) and all(placed.distance(other) >= GAP_M for other in others):
                return x, y
        raise CrowdedError(f"no free place for {draft.name!r} among {len(self.things)} things")


def _names(things: Thing | Sequence[Thing]) -> tuple[str, ...]:
    return (things.name,) if isinstance(things, Thing) else tuple(thing.name for thing in things)
