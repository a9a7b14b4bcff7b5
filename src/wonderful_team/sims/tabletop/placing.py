"""Where things can stand on a table that is being set."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from shapely import box
from shapely.geometry.base import BaseGeometry

from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import textures
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.goals import NEAR_M, footprint_at
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.shapes import shape

Spot: TypeAlias = tuple[float, float]
"""A point (x, y) of the table [m]."""
Room: TypeAlias = tuple[float, float, float, float]
"""A rectangle of the table: low x, low y, high x, high y [m]."""
GAP_M = 0.012
"""Free table between two things that are placed at random [m]."""
TRIES = 200
EDGE_M = 0.008


class CrowdedError(Exception):
    """No free place was found; the scene is started afresh."""


@dataclass
class Floor:
    """What stands on the table so far, and where there is room.

    Attributes:
        layout: Generator for places and turns.
        colours: Generator for colours and textures alone; `recolour` changes its seed and nothing else.
        things: What stands on the table.
        props: What is only seen in pictures of the instruction.
        covered: What each of the things covers, holes filled, in the same order.
        apart_m: How far apart the centres of things are that are placed at random [m].
    """

    layout: np.random.Generator
    colours: np.random.Generator
    things: list[Thing] = field(default_factory=list)
    props: list[Thing] = field(default_factory=list)
    covered: list[BaseGeometry] = field(default_factory=list)
    apart_m: float = 1.2 * NEAR_M

    def free_place(
        self, draft: Thing, *, on: Thing | None = None, within: Room | None = None, away: Sequence[Spot] = ()
    ) -> Spot:
        """A place (x, y) [m] at random where a thing, turned as it is, stands free of all others.

        Args:
            draft: What is to stand there; where it stands already does not matter.
            on: A flat area to stand on.
            within: A part of the table to stand on (low x, low y, high x, high y) [m].
            away: Further points to keep `apart_m` away from.

        Raises:
            CrowdedError: None was found.
        """
        whole = box(*TABLE_LOW_M[:2], *TABLE_HIGH_M[:2]).buffer(-EDGE_M, join_style="mitre")
        table = whole if within is None else box(*within)
        room = footprint_at(on, on.x_m, on.y_m, on.yaw_rad) if on is not None else table
        low_x, low_y, high_x, high_y = room.bounds
        own = footprint_at(draft, 0.0, 0.0, draft.yaw_rad).convex_hull.bounds
        if own[2] - own[0] > high_x - low_x or own[3] - own[1] > high_y - low_y:
            raise ConfigError(f"{draft.name!r} is too large for the place it should stand on")
        ignored = {draft.name, on.name if on is not None else ""}
        centres = [(t.x_m, t.y_m) for t in self.things if t.name not in ignored] + list(away)
        for _ in range(TRIES):
            x = float(self.layout.uniform(low_x - own[0], high_x - own[2]))
            y = float(self.layout.uniform(low_y - own[1], high_y - own[3]))
            if on is None and any(math.dist((x, y), c) < self.apart_m for c in centres):
                continue
            if self.fits(draft, (x, y), room=room, ignored=ignored):
                return x, y
        raise CrowdedError(f"no free place for {draft.name!r} among {len(self.things)} things")

    def fits(self, draft: Thing, at: Spot, *, room: BaseGeometry | None = None, ignored: Collection[str] = ()) -> bool:
        """Whether a thing can stand at (x, y) [m], free of all others, wholly on the table."""
        room = box(*TABLE_LOW_M[:2], *TABLE_HIGH_M[:2]) if room is None else room
        placed = footprint_at(draft, *at, draft.yaw_rad).convex_hull
        pairs = zip(self.things, self.covered, strict=True)
        others = [cover for thing, cover in pairs if thing.name not in ignored and thing.name != draft.name]
        return bool(room.covers(placed)) and all(placed.distance(other) >= GAP_M for other in others)

    def made(self, shape_name: str, texture: str, name: str | None, yaw: float, lifted: float, stretch: float) -> Thing:
        """A thing with a name of its own, not yet anywhere."""
        body = shape(shape_name, stretch)
        textures.texture(texture)
        taken = {thing.name for thing in (*self.things, *self.props)}
        if name is not None and name in taken:
            raise ConfigError(f"two things are called {name!r}; names in a scene must differ")
        wanted, count = f"{texture} {shape_name}", 1
        while name is None or name in taken:
            name, count = wanted if count == 1 else f"{wanted} {count}", count + 1
        return Thing(name, body.name, texture, 0.0, 0.0, yaw, lifted, stretch)
