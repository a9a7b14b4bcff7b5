"""What has to be done, from the oracle's actions: which thing is meant, and what the place is that it goes to.

The oracle speaks in metres; here its numbers become things and places that can be named.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from wonderful_team.core.actions import Action, Gripper, Home, MoveTo, PickPlace, Push, RotateGripper, Trajectory
from wonderful_team.core.geometry import wrap_angle
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.geometry.cameras import Camera
from wonderful_team.core.protocols import SceneTruth
from wonderful_team.core.values import GroundTruthView, Instruction, TrueThing

SAME_M = 0.02
"""Two centres this close are the same place [m]."""
REACH_M = 0.006
"""A point this close to an outline still touches the thing [m]."""
TURNED_RAD = math.radians(0.5)
LEVEL_M = 0.05
"""Points of a path that lie no higher than this over its lowest run along the surface [m]."""
LANE_M = 0.02
"""Half the width of what a push may meet [m]."""
PICTURED = ("scene", "frame", "before", "after")


@dataclass(frozen=True)
class Spot:
    """Where something goes, with one way to name it.

    Attributes:
        how: self (turned where it stands) | thing (a container, or another thing to be stacked on) | origin (where it stood
            when this plan begins) | start (where it stood at the very start) | slot (as a picture of the instruction
            shows it) | spot (free space).
        at_m: Where the thing's centre ends [m].
        thing: The other thing; for a spot, what it lies on, if anything.
        slot: Name of the instruction's picture.
    """

    how: str
    at_m: tuple[float, float]
    thing: str | None = None
    slot: str | None = None


@dataclass(frozen=True)
class Put:
    """Carry a thing.

    Attributes:
        covers_m: Sides of the rectangle that it covers where it ends, turned as it is then, along x and y [m].
        twist_deg: How far it is turned clockwise where it stands before it is lifted, as a screw cap is.
        path_m: Points (x, y, up) that it is moved through in the air before it is put down, up from where the path begins [m].
        tight: Whether it is gripped as hard as can be.
    """

    thing: str
    to: Spot
    rotate_deg: float
    covers_m: tuple[float, float]
    twist_deg: float = 0.0
    path_m: tuple[tuple[float, float, float], ...] = ()
    tight: bool = False

    @property
    def plain(self) -> bool:
        """Whether it is one pick and one place, and nothing else."""
        return not (self.twist_deg or self.path_m)


@dataclass(frozen=True)
class Shove:
    """Push a thing.

    Attributes:
        to_m: Where its centre ends [m].
        into: The container that it then lies in, if any.
        clear_of: Flat things on the table that it keeps off.
    """

    thing: str
    to_m: tuple[float, float]
    into: str | None
    clear_of: tuple[str, ...] = ()


@dataclass(frozen=True)
class Trace:
    """Lead the tool along a surface, or a thing through the air.

    Attributes:
        thing: What it is led over, or what is moved.
        path_m: Points (x, y) of the way [m].
        up_m: How far each lies over where the way begins [m]; () on a surface.
    """

    thing: str
    path_m: tuple[tuple[float, float], ...]
    up_m: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Handled:
    """What an arm does between closing and opening its gripper, where that is more than a pick and place.

    Attributes:
        carry: From where it is gripped to where it is let go, turned by what the gripper was not turned in place.
        twist_rad: How far it was turned in place, counter-clockwise [rad].
        path_m: The way in the air, shape (N, 3) [m]; None without one.
        tight: Whether it was gripped tightly.
    """

    carry: PickPlace
    twist_rad: float
    path_m: Array | None
    tight: bool


Move = Put | Shove | Trace


@dataclass
class _Table:
    """How things are believed to stand while a plan is followed."""

    things: Mapping[str, TrueThing]
    centres: dict[str, tuple[float, float]] = field(init=False)
    turns: dict[str, float] = field(default_factory=dict)
    moved: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.centres = {name: _xy(thing.position_m) for name, thing in self.things.items()}

    def outline(self, name: str) -> shapely.Polygon:
        thing = self.things[name]
        turn = self.turns.get(name, 0.0)
        c, s = math.cos(turn), math.sin(turn)
        around = (thing.outline_m - thing.position_m[:2]) @ np.array([[c, s], [-s, c]])
        return shapely.Polygon(around + np.array(self.centres[name]))

    def top_at(self, point: tuple[float, float], kinds: Sequence[str]) -> str | None:
        """The uppermost thing at a point: what was put down last, else the highest."""
        at = shapely.Point(point)
        found = [
            name
            for name, thing in self.things.items()
            if thing.kind in kinds and self.outline(name).distance(at) <= REACH_M
        ]
        return max(found, key=self._level, default=None)

    def _level(self, name: str) -> tuple[int, float]:
        return (self.moved.index(name) if name in self.moved else -1), self.things[name].height_m

    def nearest_kind(self, point: tuple[float, float], kinds: Sequence[str], leave_out: str) -> str | None:
        """A thing whose centre is that very place."""
        near = [
            (math.dist(centre, point), name)
            for name, centre in self.centres.items()
            if name != leave_out and self.things[name].kind in kinds
        ]
        return next((name for distance, name in sorted(near) if distance <= SAME_M), None)

    def carry(self, name: str, to: tuple[float, float], turn: float) -> None:
        self.centres[name] = to
        self.turns[name] = self.turns.get(name, 0.0) + turn
        if name in self.moved:
            self.moved.remove(name)
        self.moved.append(name)


def moves_of(actions: Sequence[Action], truth: SceneTruth, instruction: Instruction | None) -> list[Move]:
    """The oracle's actions as moves of things; an action on nothing is left out."""
    table = _Table(truth.things())
    pictured = _pictured(truth, instruction)
    start = {name: _xy(thing.position_m) for name, thing in truth.start().items()}
    moves: list[Move] = []
    for action in carried(actions):
        if isinstance(action, PickPlace | Handled):
            put = _put(action if isinstance(action, PickPlace) else action.carry, table, pictured, start)
            if put is not None:
                moves.append(_as_handled(put, action) if isinstance(action, Handled) else put)
        elif isinstance(action, Push):
            shove = _shove(action, table)
            if shove is not None:
                moves.append(shove)
        elif isinstance(action, Trajectory):
            moves += _traced(action, table)
    return moves


def carried(actions: Sequence[Action]) -> list[Action | Handled]:
    """The same, with what an arm does between closing and opening its gripper as one pick and place, or as a thing handled."""
    found: list[Action | Handled] = []
    at = gripped = path = None
    twist, tight = 0.0, False
    for action in actions:
        if isinstance(action, MoveTo):
            at = action.pose
        elif isinstance(action, Gripper) and at is not None:
            if action.state != "open":
                gripped, twist, path, tight = at, 0.0, None, action.state == "tight"
            elif gripped is not None:
                turn = wrap_angle(at.yaw_rad - gripped.yaw_rad - twist)
                carry = PickPlace(gripped.position_m, at.position_m, turn)
                found.append(Handled(carry, twist, path, tight) if twist or path is not None else carry)
                gripped = None
        elif gripped is not None and isinstance(action, RotateGripper):
            twist += action.yaw_rad
        elif gripped is not None and isinstance(action, Trajectory):
            path = action.waypoints_m
        elif not isinstance(action, Gripper | RotateGripper | Home):
            found.append(action)
    return found


def _as_handled(put: Put, handled: Handled) -> Put:
    """A move of a thing with what else is done to it while it is held; where it comes back to its place, that is its origin."""
    carry, path = handled.carry, handled.path_m
    back = math.dist(_xy(carry.pick_m), _xy(carry.place_m)) <= SAME_M and not put.rotate_deg
    to = Spot("origin", put.to.at_m) if back else put.to
    points = [] if path is None else np.column_stack([path[:, :2], path[:, 2] - path[0, 2]]).tolist()
    way = tuple((float(x), float(y), float(up)) for x, y, up in points)
    twist = round(-math.degrees(handled.twist_rad), 2) + 0.0
    return replace(put, to=to, twist_deg=twist, path_m=way, tight=handled.tight)


def _put(
    action: PickPlace,
    table: _Table,
    pictured: Sequence[tuple[str, Mapping[str, tuple[float, float]]]],
    start: Mapping[str, tuple[float, float]],
) -> Put | None:
    name = table.top_at(_xy(action.pick_m), ("object",)) or table.top_at(_xy(action.pick_m), ("container", "area"))
    if name is None:
        return None
    turn = wrap_angle(action.yaw_rad)
    centre = np.array(table.centres[name])
    c, s = math.cos(turn), math.sin(turn)
    offset = np.array([[c, -s], [s, c]]) @ (centre - action.pick_m[:2])
    end = _xy(action.place_m[:2] + offset)
    spot = _spot(name, end, abs(turn) > TURNED_RAD, table, pictured, start)
    table.carry(name, end, turn)
    degrees = round(-math.degrees(turn), 2) if abs(turn) > TURNED_RAD else 0.0
    low_x, low_y, high_x, high_y = table.outline(name).bounds
    return Put(name, spot, degrees + 0.0, (high_x - low_x, high_y - low_y))


def _spot(
    name: str,
    end: tuple[float, float],
    turned: bool,
    table: _Table,
    pictured: Sequence[tuple[str, Mapping[str, tuple[float, float]]]],
    start: Mapping[str, tuple[float, float]],
) -> Spot:
    if turned and math.dist(end, table.centres[name]) <= SAME_M:
        return Spot("self", end)
    container = table.nearest_kind(end, ("container",), name)
    if container is not None:
        return Spot("thing", end, container)
    if name in table.moved and math.dist(end, _xy(table.things[name].position_m)) <= SAME_M:
        return Spot("origin", end)
    under = table.nearest_kind(end, ("object",), name)
    if under is not None:
        return Spot("thing", end, under)
    shown = [slot for slot, centres in pictured if name in centres and math.dist(centres[name], end) <= SAME_M]
    if shown:
        return Spot("slot", end, slot=shown[0])
    if name in start and math.dist(start[name], end) <= SAME_M:
        return Spot("start", end)
    return Spot("spot", end, table.top_at(end, ("area", "container")))


def _shove(action: Push, table: _Table) -> Shove | None:
    start, end = _xy(action.start_m), _xy(action.end_m)
    lane = shapely.LineString([start, end]).buffer(LANE_M)
    met = [
        (table.outline(name).distance(shapely.Point(start)), name)
        for name, thing in table.things.items()
        if thing.kind == "object" and table.outline(name).intersects(lane)
    ]
    if not met:
        return None
    name = min(met)[1]
    way = np.subtract(end, start) / max(math.dist(start, end), 1e-9)
    # Pushed far enough, a side of it lies against the blade.
    around = (table.things[name].outline_m - table.things[name].position_m[:2]) @ _turned(-table.things[name].yaw_rad)
    reach = float(np.abs(around).max(axis=0).min())
    to = _xy(np.array(end) + way * reach)
    table.carry(name, to, 0.0)
    hulls = {n: table.outline(n).convex_hull for n, thing in table.things.items() if thing.kind == "container"}
    into = next((n for n, hull in hulls.items() if hull.covers(shapely.Point(to))), None)
    return Shove(name, to, into, tuple(n for n, thing in table.things.items() if thing.kind == "area"))


def _traced(action: Trajectory, table: _Table) -> list[Move]:
    """What a path runs over: its points are those lower than where it comes from and goes to."""
    points = action.waypoints_m
    low = points[points[:, 2] <= points[:, 2].min() + LEVEL_M]
    under = table.top_at(_xy(low[:, :2].mean(axis=0)), ("area", "container", "object"))
    return [] if under is None else [Trace(under, tuple(_xy(point) for point in low))]


def _turned(angle_rad: float) -> Array:
    """Turns rows of points counter-clockwise, shape (2, 2)."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, s], [-s, c]])


def _pictured(
    truth: SceneTruth, instruction: Instruction | None
) -> list[tuple[str, Mapping[str, tuple[float, float]]]]:
    """Where things stand in the instruction's pictures of the table, picture after picture."""
    found: list[tuple[str, Mapping[str, tuple[float, float]]]] = []
    for name, slot in {}.items() if instruction is None else instruction.slots.items():
        if slot.kind not in PICTURED:
            continue
        view = next(iter(slot.views.values()))
        looks = truth.observation_log(view.camera_name)
        for sight in truth.observation_log(view.id):
            camera = sight.view.camera or (looks[0].view.camera if looks else None)
            places = {thing: stands_at(sight, thing, camera) for thing in sight.masks}
            found.append((name, {thing: at for thing, at in places.items() if at is not None}))
    return found


def stands_at(sight: GroundTruthView, name: str, camera: Camera | None) -> tuple[float, float] | None:
    """Where a thing stands in a picture [m]: as the sight says, else in the middle of the pixels that show it."""
    thing = sight.things.get(name)
    if thing is not None:
        return _xy(thing.position_m)
    rows, columns = np.nonzero(sight.masks[name])
    if camera is None or not len(rows):
        return None
    middle = ((columns.min() + columns.max() + 1) / 2, (rows.min() + rows.max() + 1) / 2)
    return _xy(camera.on_plane([middle], 0.0)[0])


def _xy(position: Array) -> tuple[float, float]:
    return float(position[0]), float(position[1])
