"""What passes over what depth shows, how near it comes and where: the gate's checks and the page's profile read the same numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from shapely import Point

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Carry, Reach, Slide
from wonderful_team.core.values import HeightProfile
from wonderful_team.images.relief import Relief, outline
from wonderful_team.runtime.stage import Stage
from wonderful_team.runtime.sweep import Sweep

PROUD_M = 0.01
"""How much higher than the place something may be before it stands in the way [m]; depth noise."""
LEAST_SPECKS = 3
"""So few points do not make a thing: edges that are seen unsharp."""
STATION_M = 0.005
"""A profile has a point about this often along the way [m]."""
UPRIGHT_M, NARROW_M = 1e-9, 0.015
"""A way that leads no farther than this over the table is straight up or down, or so steep that all of it is over one place [m]."""
MOST_POINTS, MOST_OF_A_PLAN = 96, 4000
"""An action's profile has about so many points, and all profiles of one passage; twice as many at most, where a way has many corners."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A straight piece of the tool's way.

    Attributes:
        start_m, end_m: Of the tool, shape (3,) [m].
        check: Name of the check that asks what it passes over; "" where none does.
        hanging_m: How far what the tool carries hangs below it [m].
        share: How far along the piece each seen point under it lies, shape (M,), 0 to 1.
        top_m: How high it lies, shape (M,) [m].
        gap_m: How much lower it lies than what passes over it, shape (M,) [m].
        meant: Whether it belongs to what the tool is sent to, which may be touched, shape (M,) bool.
        touched_m: Height of what is touched at one end of the piece, where no check asks what it passes over [m].
    """

    start_m: Array
    end_m: Array
    check: str = ""
    hanging_m: float = 0.0
    share: Array = field(default_factory=lambda: np.zeros(0))
    top_m: Array = field(default_factory=lambda: np.zeros(0))
    gap_m: Array = field(default_factory=lambda: np.zeros(0))
    meant: Array = field(default_factory=lambda: np.zeros(0, dtype=bool))
    touched_m: float = np.nan

    def in_order(self) -> Array:
        """Which points it has to clear, the nearest first and without those that are too few to be a thing."""
        counted = np.flatnonzero(~self.meant)
        ordered = counted[np.argsort(self.gap_m[counted], kind="stable")]
        return ordered[min(LEAST_SPECKS, len(ordered) - 1) :] if len(ordered) else ordered

    @property
    def clearance_m(self) -> float:
        """How much lower the nearest of them lies than what passes [m]; infinite where nothing is seen."""
        ordered = self.in_order()
        return float(self.gap_m[ordered[0]]) if len(ordered) else np.inf


def pieces_of(stage: Stage, sweep: Sweep, tool_radius_m: float) -> tuple[Piece, ...]:
    """The tool's way in one action, piece by piece, with what is seen under those that are checked."""
    motion, path = stage.motion, sweep.path_m
    if path is None:
        return ()
    carried = stage.carried
    hanging = carried.hanging_m if carried is not None else 0.0
    reach = max(tool_radius_m, carried.radius_m if carried is not None else 0.0)
    there = _there(sweep, stage.relief, tool_radius_m)
    match motion:
        case Carry():
            start, lifted, over, end = path
            down = [Piece(there[-1].end_m, start, touched_m=float(start[2]))] if there else []
            lift = Piece(start, lifted, hanging_m=hanging, touched_m=float(start[2]) - hanging)
            carry = _over(lifted, over, "under the way", reach, hanging, stage.relief, stage.own)
            # What is put down touches where it is put; the tool stays above that by what hangs below it.
            lower = Piece(over, end + np.array([0.0, 0.0, hanging]), hanging_m=hanging, touched_m=float(end[2]))
            return (*there, *down, lift, carry, lower)
        case Slide():
            down = [Piece(there[-1].end_m, path[0])] if there else []
            return (*there, *down, Piece(path[0], path[-1]))
        case Reach(planned=True):
            whole = path if sweep.transit_m is None else np.vstack([sweep.transit_m, path])
            ends = zip(whole[:-1], whole[1:], strict=True) if len(whole) > 1 else [(whole[0], whole[0])]
            own, meant = stage.own, stage.meant
            return tuple(
                _over(a, b, "under the way", reach, hanging, stage.relief, own, meant, _under(b, stage, tool_radius_m))
                for a, b in ends
            )
    return ()


def _there(sweep: Sweep, relief: Relief | None, tool_radius_m: float) -> tuple[Piece, ...]:
    """The way to where a thing is picked up or pushed, above everything."""
    if sweep.transit_m is None:
        return ()
    start, end = sweep.transit_m
    return (_over(start, end, "on the way there", tool_radius_m, 0.0, relief, None),)


def _over(
    start: Array,
    end: Array,
    check: str,
    reach_m: float,
    hanging_m: float,
    relief: Relief | None,
    own: Array | None,
    meant: object | None = None,
    upright: Any | None = None,
) -> Piece:
    """A piece with every seen point that what passes comes over, but for its own; `upright`: what it covers where it goes straight up or down."""
    if relief is None or not len(relief.xyz_m):
        return Piece(start, end, check, hanging_m)
    flat = float(np.linalg.norm(end[:2] - start[:2]))
    if flat > UPRIGHT_M:
        found = relief.along(start, end, reach_m)
    else:
        found = relief.inside(_disc(end, reach_m) if upright is None else upright)
    if own is not None:
        found &= ~own
    points = relief.xyz_m[found]
    named = np.zeros(len(points), dtype=bool)
    if meant is not None:
        named = np.asarray(shapely.contains_xy(meant, points[:, 0], points[:, 1]))
    share, lowest = np.zeros(len(points)), np.full(len(points), min(start[2], end[2]))
    if flat > UPRIGHT_M:
        share = np.clip((points[:, :2] - start[:2]) @ (end[:2] - start[:2]) / flat**2, 0.0, 1.0)
        lowest = start[2] + share * (end[2] - start[2])
    return Piece(start, end, check, hanging_m, share, points[:, 2], lowest - hanging_m - points[:, 2], named)


def _under(at_m: Array, stage: Stage, tool_radius_m: float) -> Any:
    """What the tool covers of the table where it goes straight up or down, with the outline of what it carries."""
    tool = _disc(at_m, tool_radius_m)
    offsets = stage.carried.offsets_m if stage.carried is not None else None
    if offsets is None or not len(offsets) or stage.relief is None:
        return tool
    return tool.union(outline(offsets + at_m[:2], stage.relief.spacing_m))


def _disc(at_m: Array, radius_m: float) -> Any:
    return Point(float(at_m[0]), float(at_m[1])).buffer(radius_m)


def profile_of(action: int, pieces: Sequence[Piece], least_m: float, actions: int, stays: bool) -> HeightProfile | None:
    """The whole way as a profile; None for an action without one.

    Args:
        action: Which one, from 0.
        pieces: Its way.
        least_m: The clearance that the gate asks for [m].
        actions: How many the plan has: all profiles together are bounded.
        stays: Whether the tool stays at the end of the way.
    """
    if not pieces:
        return None
    most = max(8, min(MOST_POINTS, MOST_OF_A_PLAN // max(1, actions)))
    lengths = [float(np.linalg.norm(piece.end_m - piece.start_m)) for piece in pieces]
    apart = max(STATION_M, sum(lengths) / most)
    nearest = min(pieces, key=lambda piece: piece.clearance_m)
    points: list[Array] = []
    marked = None
    for piece, length in zip(pieces, lengths, strict=True):
        shares = np.linspace(0.0, 1.0, max(2, int(round(length / apart)) + 1))
        there, at = _stations(piece, shares, piece is nearest)
        if at is not None:
            marked = sum(map(len, points)) + at
        points.append(there)
    table = np.vstack(points)
    kept = _thinned(len(table), 2 * most, marked)
    found = np.isfinite(nearest.clearance_m)
    return HeightProfile(
        action,
        table[kept, :3],
        table[kept, 3],
        table[kept, 4],
        table[kept, 5],
        nearest.clearance_m if found else None,
        least_m if found else None,
        int(np.flatnonzero(kept == marked)[0]) if found and marked is not None else None,
        stays,
    )


def _stations(piece: Piece, shares: Array, nearest: bool) -> tuple[Array, int | None]:
    """Rows of x, y, z, lowest point of what passes, surface to clear, surface that is meant; and which is the nearest."""
    counted, at = piece.in_order(), None
    if nearest and len(counted):
        share = float(piece.share[counted[0]])
        at = int(np.searchsorted(shares, share))
        if at == len(shares) or abs(shares[at] - share) > 1e-9:
            shares = np.insert(shares, at, share)
    rows = np.full((len(shares), 6), np.nan)
    rows[:, :3] = piece.start_m + shares[:, None] * (piece.end_m - piece.start_m)
    rows[:, 3] = rows[:, 2] - piece.hanging_m
    rows[:, 5] = piece.touched_m
    flat = float(np.linalg.norm(piece.end_m[:2] - piece.start_m[:2]))
    for column, which in ((4, counted), (5, np.flatnonzero(piece.meant))):
        if len(which):
            rows[:, column] = _tops(piece, shares, which, flat)
    if at is not None:
        # On a way straight down, what passes comes as low as its lower end.
        at = int(np.argmin(rows[:, 2])) if flat <= UPRIGHT_M else at
        rows[at, 4] = piece.top_m[counted[0]]
    return rows, at


def _tops(piece: Piece, shares: Array, which: Array, flat_m: float) -> Array:
    """Highest of some points at each station; NaN where none is near."""
    if flat_m <= NARROW_M:
        # So steep that they lie under all of it.
        return np.full(len(shares), piece.top_m[which].max())
    tops = np.full(len(shares), -np.inf)
    np.maximum.at(tops, np.searchsorted((shares[1:] + shares[:-1]) / 2, piece.share[which]), piece.top_m[which])
    seen = np.flatnonzero(np.isfinite(tops))
    tops[~np.isfinite(tops)] = np.nan
    for before, after in pairwise(seen):
        # Between pixels of one surface nothing is seen, and yet it is there.
        if after - before > 1 and (shares[after] - shares[before]) * flat_m <= NARROW_M:
            tops[before + 1 : after] = max(tops[before], tops[after])
    return tops


def _thinned(count: int, most: int, marked: int | None) -> Array:
    """Which of the points stay, evenly; the marked one does."""
    if count <= most:
        return np.arange(count)
    kept = np.linspace(0, count - 1, most).round().astype(np.int64)
    return np.unique(np.append(kept, marked)) if marked is not None else np.unique(kept)
