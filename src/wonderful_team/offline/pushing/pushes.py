"""Straight pushes over a table, found in a picture: which thing, to where, past what. Lengths count in sides of the thing.

The picture alone decides: no size in metres is known, and the tool is taken to be about as wide as what it pushes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.offline.pushing.enclosure import Room, study_room
from wonderful_team.offline.vision import Scene, Thing
from wonderful_team.offline.vision.outlines import filled
from wonderful_team.offline.vision.things import whole_mask

TOOL_HALF = 0.8
"""Half the tool's width."""
BEHIND = 1.15
"""How far behind the thing's middle the tool comes down, its own thickness included."""
DRIFT = 0.06
"""How far a thing may wander sideways under a push; this and ASTRAY from 1,300 pushes of blocks on the tabletop."""
ASTRAY = 0.3
"""How much farther from where it was pushed to a thing may lie for each radian that it stood off square before."""
READ_RAD = np.radians(3)
"""How exactly a picture shows how a thing is turned."""
ROOM_LEFT = 0.05
"""Least free space beside a lane."""
SETTLED = 0.82
"""How far inside a zone the middle of a thing ends: half its diagonal and a little."""
BEFORE_MOUTH = 1.3
"""How far outside of a room a thing rests on its way."""
ENOUGH = 0.7
"""Free space beyond which more is worth nothing."""
WORTH_CLEAR, WORTH_DEEP, PUSH_COST = 6.0, 2.5, 30.0
"""What free space beside a lane and distance from a line are worth, and what one more push costs, as sides of way."""
WORTH_ROOM = 12.0
"""What distance from the open side is worth where others are to follow."""
RISK = 200.0
"""What each side of free space costs that a lane lacks for where a thing may lie, as sides of way."""
SHORTEST = 0.4
HALF = 0.5
STEP = 2 * ROOM_LEFT
"""How far apart the places lie at which a lane is measured: ROOM_LEFT sees half as far, so no thin line falls between them."""
FREE_NOW = 0.75
"""How far from where the picture shows things a thing may rest: a place that is taken now is judged to be no free place."""
GRID = 0.55
OFF_DRAWN = 0.85
"""How far from walls that are only drawn the middle of a thing rests on its way."""
STOPS = (0.0, 1.2, 2.6, 4.2, 6.0, 8.0)
"""How much farther than BEFORE_MOUTH from the room a thing may rest on its way."""
CLEAR_OF = 1.9
"""How far from another's path a thing is put that was in its way."""
MOST_STOPS = 120
"""How many stops are looked on from, the cheapest to reach first."""
BESIDE_WALL = 0.93
"""How far from a side wall the middle of a thing ends: the tool has to fit as well."""


@dataclass(frozen=True, eq=False)
class Block:
    """A thing that can be pushed; working pixels."""

    number: int
    at: Array
    side: float
    yaw_rad: float


@dataclass(frozen=True, eq=False)
class Way:
    """How one thing gets to a place: its middle rests at these points, one push each; the last one is the end."""

    number: int
    stops: tuple[Array, ...]
    cost: float


@dataclass(frozen=True, eq=False)
class Field:
    """The table for pushes towards one place; working pixels.

    Attributes:
        blocks: Everything that can be pushed, by number, where it is believed to be.
        masks: Where each of them is believed to cover the table, bool.
        shown: Where the picture shows any of them, whatever was pushed since, bool.
        fixed: What a lane must keep off with thing and tool, bool.
        line: What only the thing must keep off, bool.
        room: Where to.
        least: How far from the room's back a thing's middle must stay, because of a line inside.
        zoom: Picture pixels per working pixel.
        open_round: The room can be entered from every side.
    """

    blocks: dict[int, Block]
    masks: dict[int, Array]
    shown: Array
    fixed: Array
    line: Array
    room: Room
    least: float
    zoom: float
    open_round: bool = False

    def point(self, at: Array) -> Point:
        """Picture pixels of a place."""
        return float(at[0] * self.zoom), float(at[1] * self.zoom)

    def without(self, number: int) -> Field:
        """Were a thing not there."""
        blocks = {key: value for key, value in self.blocks.items() if key != number}
        return replace(self, blocks=blocks, masks={key: self.masks[key] for key in blocks})

    def with_move(self, number: int, end: Array, start: Array) -> Field:
        """After a thing was pushed: it stands square to the push."""
        block = self.blocks[number]
        way = end - start
        moved = replace(block, at=end, yaw_rad=float(np.arctan2(way[1], way[0])))
        corners = cv2.boxPoints((tuple(map(float, end)), (block.side, block.side), float(np.degrees(moved.yaw_rad))))
        mask = np.zeros(self.fixed.shape, np.uint8)
        cv2.fillConvexPoly(mask, np.round(corners).astype(np.int32), 1)
        return replace(self, blocks={**self.blocks, number: moved}, masks={**self.masks, number: mask > 0})


def study_field(
    scene: Scene, into: Thing, lines: Sequence[Thing], *, limit: bool, flat_walls: bool = False
) -> Field | None:
    """The table for pushes into a thing; None when it has no way in.

    Args:
        scene: As seen.
        into: Where to.
        lines: What a pushed thing must not touch.
        limit: Whether a line is also as far in as a thing may go.
        flat_walls: What looks like walls is only drawn on the table, and can be passed over.
    """
    shape = scene.occupied.shape
    masks = {thing.number: filled(whole_mask(thing, shape)) for thing in scene.things}
    room = study_room(into, whole_mask(into, shape))
    if room is None:
        return None
    named = {into.number, *(thing.number for thing in lines)}
    movable = [thing for thing in scene.things if thing.number not in named and not thing.flat]
    blocks = {thing.number: _block(thing, masks[thing.number]) for thing in movable}
    around = _around(scene, [*masks.values()])
    fixed = around if room.walls is None or flat_walls else around | room.walls
    drawn = [whole_mask(thing, shape) for thing in lines]
    line = np.any([np.zeros(shape, bool), *drawn], axis=0)
    least = max([0.0, *(_reach(room, mask) for mask in drawn if limit)])
    open_round = flat_walls or not room.mouth
    masks = {number: masks[number] for number in blocks}
    shown = np.any([np.zeros(shape, bool), *masks.values()], axis=0)
    return Field(blocks, masks, shown, fixed, line, room, least, scene.zoom, open_round)


def _around(scene: Scene, masks: Sequence[Array]) -> Array:
    """What is neither a thing nor the surface that things lie on, such as what shows past the table's edge, bool."""
    things = np.any([np.zeros_like(scene.occupied), *masks], axis=0).astype(np.uint8)
    rims = (cv2.dilate(things, np.ones((5, 5), np.uint8)) > 0) & (things == 0)
    other = scene.occupied & (things == 0)
    if rims.any() and other[rims].mean() > HALF:
        # The surface round the things is the table, whatever shows more of the picture.
        other = ~scene.occupied & (things == 0)
    other &= ~rims
    return np.asarray(cv2.morphologyEx(other.astype(np.uint8), cv2.MORPH_OPEN, np.ones((5, 5), np.uint8)) > 0)


def _reach(room: Room, mask: Array) -> float:
    """How far out of the room's back a line reaches [px]."""
    local = room.local(np.argwhere(mask)[:, ::-1] + 0.5)
    return float(np.percentile(local[:, 1], 98))


def _block(thing: Thing, mask: Array) -> Block:
    (x, y), (w, h), angle = cv2.minAreaRect(np.argwhere(mask)[:, ::-1].astype(np.float32) + 0.5)
    return Block(thing.number, np.array([x, y]), float(max(np.sqrt(w * h), 1.0)), float(np.radians(angle)))


def inside(field: Field, number: int, slack: float = 0.12) -> bool:
    """Whether a thing lies wholly in the zone, but for `slack` of its side at the open end."""
    block = field.blocks[number]
    local = field.room.local(np.argwhere(field.masks[number])[:, ::-1] + 0.5)
    low, high = local.min(axis=0), local.max(axis=0)
    spare = slack * block.side
    fits_x = low[0] > -spare and high[0] < field.room.width + spare
    return bool(fits_x and low[1] > field.least - spare and high[1] < field.room.depth + spare)


def best_way(field: Field, number: int, *, clear_of: Sequence[Array] = (), deep: bool = False) -> Way | None:
    """The cheapest one or two straight pushes of a thing into the room, or one push aside, that meet nothing else.

    Args:
        field: The table.
        number: Who is pushed.
        clear_of: Points of a path; given, the thing is pushed out of its way instead, onto free table.
        deep: Far in, so that others find room, for one more push if need be.
    """
    block = field.blocks[number]
    aside = bool(clear_of)
    stops = _stops(field, block)
    if aside:
        stops = stops[_beside(stops, clear_of) > CLEAR_OF * block.side]
    goals, worth = (
        (stops, _openness(field, block, stops)) if aside else _goals(field, block, WORTH_ROOM if deep else WORTH_DEEP)
    )
    if not len(goals):
        return None
    lanes = _Lanes(field, block)
    direct = lanes.costs(block.at[None], np.array([block.yaw_rad]), goals)[0] - worth
    straight = Way(number, (goals[int(direct.argmin())],), float(direct.min())) if np.isfinite(direct).any() else None
    if aside or not len(stops) or (straight is not None and not deep):
        return straight
    first = lanes.costs(block.at[None], np.array([block.yaw_rad]), stops)[0]
    stops, first = stops[np.isfinite(first)], first[np.isfinite(first)]
    if not len(stops):
        return straight
    nearest = np.argsort(first, kind="stable")[:MOST_STOPS]
    stops, first = stops[nearest], first[nearest]
    way = stops - block.at
    turned, pushed = np.arctan2(*way.T[::-1]), np.linalg.norm(way, axis=1) / block.side
    off = np.minimum(_off_square(turned - block.yaw_rad) + READ_RAD, np.pi / 4)
    # On its corner a thing is balanced against the tool; from there it turns away ever faster, until it is square.
    unsure = np.maximum(np.pi / 4 - (np.pi / 4 - off) * np.exp(pushed), 0.0)
    # A push ends half the thing's upright box short of its end; square to the tool, the thing is half its side before it.
    behind = (abs(np.cos(block.yaw_rad)) + abs(np.sin(block.yaw_rad)) - 1) / 2
    both = first[:, None] + lanes.costs(stops, turned, goals, (unsure, ASTRAY * off, behind)) - worth
    if not np.isfinite(both).any() or (straight is not None and straight.cost <= both.min()):
        return straight
    k, m = np.unravel_index(int(both.argmin()), both.shape)
    return Way(number, (stops[k], goals[m]), float(both[k, m]))


def _goals(field: Field, block: Block, worth: float) -> tuple[Array, Array]:
    """Places in the zone where the thing lies wholly inside, and what each is worth."""
    room, side = field.room, block.side
    edge = SETTLED * side
    low, high = max(field.least, 0.0) + edge, room.depth - edge
    if room.width < 2 * BESIDE_WALL * side or high < low - 0.3 * side:
        return np.zeros((0, 2)), np.zeros(0)
    x, y = _columns(room, side), _spread(low, max(high, low), GRID * side)
    local = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    # Far in; but midway between the open side and a line that must not be exceeded.
    deep = room.depth - local[:, 1]
    if field.least > 0:
        deep = np.minimum(local[:, 1] - field.least, deep)
    elif not room.mouth:
        deep = np.minimum(np.minimum(local[:, 0], room.width - local[:, 0]), np.minimum(local[:, 1], deep))
    return room.at(local), np.asarray(worth * deep / side)


def _columns(room: Room, side: float) -> Array:
    return _spread(BESIDE_WALL * side, room.width - BESIDE_WALL * side, GRID * side)


def _spread(low: float, high: float, step: float) -> Array:
    count = max(1, round((high - low) / step) + 1)
    return np.linspace(low, high, count) if high > low else np.array([(low + high) / 2])


def _stops(field: Field, block: Block) -> Array:
    """Places on the free table before the room's open side (around a room that can be entered from every side)."""
    room, side = field.room, block.side
    x, y = _columns(room, side), _spread(BESIDE_WALL * side, room.depth - BESIDE_WALL * side, GRID * side)
    out = (BEFORE_MOUTH + np.array(STOPS)) * side
    local = [np.stack(np.meshgrid(x, room.depth + out), axis=-1).reshape(-1, 2)]
    if field.open_round:
        local.append(np.stack(np.meshgrid(x, -out), axis=-1).reshape(-1, 2))
        local.append(np.stack(np.meshgrid(-out, y), axis=-1).reshape(-1, 2))
        local.append(np.stack(np.meshgrid(room.width + out, y), axis=-1).reshape(-1, 2))
    points = room.at(np.concatenate(local))
    height, width = field.fixed.shape
    margin = 1.2 * side
    points = points[(points > margin).all(axis=1) & (points < np.array([width, height]) - margin).all(axis=1)]
    if room.mouth and field.open_round and room.walls is not None:
        # A thing that rests on drawn walls is hard to tell from them at the next look.
        at = points.astype(int)
        points = points[_distance(room.walls)[at[:, 1], at[:, 0]] > OFF_DRAWN * side]
    return np.asarray(points)


def _beside(points: Array, path: Sequence[Array]) -> Array:
    """Distance of points from a path, shape (N,)."""
    least = np.full(len(points), np.inf)
    for start, end in zip(path[:-1], path[1:], strict=True):
        way = end - start
        share = np.clip((points - start) @ way / max(float(way @ way), 1e-9), 0, 1)
        least = np.minimum(least, np.linalg.norm(points - (start + share[:, None] * way), axis=1))
    return least


def _openness(field: Field, block: Block, points: Array) -> Array:
    """What free space round a place is worth."""
    away = _distance(_solid(field, block.number) | field.line)
    at = points.astype(int)
    return np.asarray(WORTH_CLEAR * np.minimum(away[at[:, 1], at[:, 0]] / block.side, 3.0))


def _solid(field: Field, number: int) -> Array:
    others = [mask for other, mask in field.masks.items() if other != number]
    return np.asarray(np.any([field.fixed, *others], axis=0))


def _off_square(turn: Array) -> Array:
    """How far a square that is turned against a push is from standing square to it, 0 to pi / 4 [rad]."""
    return np.asarray(np.abs((turn + np.pi / 4) % (np.pi / 2) - np.pi / 4))


def _distance(blocked: Array) -> Array:
    return np.asarray(cv2.distanceTransform((~blocked).astype(np.uint8), cv2.DIST_L2, 5))


class _Lanes:
    """What straight pushes of one thing cost; infinite where something is in the way."""

    def __init__(self, field: Field, block: Block) -> None:
        self.side = block.side
        blocked = (_solid(field, block.number), field.line, field.shown)
        self.solid, self.line, self.shown = map(_distance, blocked)

    def costs(self, starts: Array, yaws: Array, ends: Array, pushed: tuple[Array, Array, float] | None = None) -> Array:
        """From each start, the thing turned by yaw there, to each end, shape (S, E).

        `pushed`, after a push along `yaws`: how far yaws are unsure [rad], how far the thing may lie aside, behind (in sides).
        """
        unsure, astray, behind = pushed or (np.full(len(yaws), READ_RAD), np.zeros(len(yaws)), 0.0)
        count, side = len(starts) * len(ends), self.side
        start = np.repeat(starts, len(ends), axis=0)
        way = np.tile(ends, (len(starts), 1)) - start
        length = np.linalg.norm(way, axis=1)
        way = way / np.maximum(length, 1e-9)[:, None]
        turn = np.arctan2(way[:, 1], way[:, 0]) - np.repeat(yaws, len(ends))
        off = np.minimum(_off_square(turn) + np.repeat(unsure, len(ends)), np.pi / 4)
        aside = np.repeat(astray, len(ends)) + behind * np.abs(np.sin(turn))
        half = (np.cos(off) + np.sin(off)) / 2 + DRIFT
        clear = np.full(count, np.inf)
        seen_free = self._least(self.shown, ends, np.zeros_like(ends), 0.0, np.zeros(len(ends))) > FREE_NOW * side
        alive = np.flatnonzero((length > SHORTEST * side) & np.tile(seen_free, len(starts)))
        # The middle of a lane first: most lanes are barred there, and the rest of them need not be looked at.
        for part in (0.0, -1.0, 1.0, -0.5, 0.5):
            for away, first, past, wide in (
                (self.solid, -BEHIND, -0.5, np.maximum(half, TOOL_HALF)),
                (self.solid, 0.0, 0.75, half),
                (self.line, 0.0, 0.75, half),
            ):
                if not len(alive):
                    break
                across = np.stack([-way[alive, 1], way[alive, 0]], axis=1) * (part * wide[alive] * side)[:, None]
                last = length[alive] / side + past
                seen = self._least(away, start[alive] + across, way[alive], first, last)
                clear[alive] = np.minimum(clear[alive], seen)
                alive = alive[clear[alive] > ROOM_LEFT * side]
        cost = np.full(count, np.inf)
        short = np.maximum(aside - clear / side, 0.0)
        cost[alive] = (PUSH_COST + length / side + RISK * short - WORTH_CLEAR * np.minimum(clear / side, ENOUGH))[alive]
        return cost.reshape(len(starts), len(ends))

    def _least(self, away: Array, starts: Array, way: Array, first: float, last: Array) -> Array:
        """Least distance to what is blocked along lines of different lengths (in sides), shape (N,)."""
        count = max(3, int(np.ceil((float(last.max()) - first) / STEP)) + 1)
        along = (first + np.linspace(0.0, 1.0, count) * (last[:, None] - first)) * self.side
        points = (starts[:, None] + along[..., None] * way[:, None]).astype(np.int32)
        height, width = away.shape
        columns, rows = points[..., 0], points[..., 1]
        seen = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
        value = away[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
        return np.asarray(np.where(seen, value, 0.0).min(axis=1))
