"""What was really seen: the truth behind every look at a table and behind every picture of its instruction.

A look is kept as the pixels that were handed out and the state they were drawn from. Which pixels show which thing is
drawn only when somebody asks.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.once import Once
from wonderful_team.core.values import GroundTruthView, Instruction, Observation, TrueThing, View
from wonderful_team.sims.tabletop import prints
from wonderful_team.sims.tabletop.goals import footprint_of
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.oracle import grasp_point
from wonderful_team.sims.tabletop.simulated_table import Snapshot

LOOKS = 24
"""How many different looks are kept; a task of the suite has at most 17 actions."""
T = TypeVar("T")
OUTLINE_STEP_M = 0.0005
"""How far an outline that is handed out may lie off the true one [m]."""
KINDS = {"base": "container", "area": "area"}


class Lazily(Mapping[str, T]):
    """A mapping that is worked out when something in it is first asked for."""

    def __init__(self, make: Callable[[], Mapping[str, T]]) -> None:
        self._all = Once(make)

    def __getitem__(self, name: str) -> T:
        return self._all()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())


@dataclass(frozen=True, eq=False)
class Look:
    """One look: the state it was drawn from, and the sight of each camera."""

    state: Snapshot
    observation_log: Mapping[str, GroundTruthView]


class Seen(Protocol):
    """What is kept of a table: its things, and how it can be drawn as it stood at an earlier instant."""

    things: Mapping[str, Thing]

    def snapshot(self) -> Snapshot: ...

    def masks_at(self, at: Snapshot, camera: str) -> dict[str, Array]: ...

    def poses_at(self, at: Snapshot) -> Mapping[str, Pose]: ...

    def instruction(self) -> Instruction: ...

    def slot_masks(self, slot: str, camera: str) -> dict[str, Array]: ...

    def slot_stands(self, slot: str) -> list[tuple[Thing, Pose]]: ...


class ObservationLog:
    """Keeps what was looked at; bounded, and without any drawing of its own until somebody asks."""

    def __init__(self, table: Seen) -> None:
        self._table = table
        self._looks: deque[Look] = deque(maxlen=LOOKS)
        self._slots: Mapping[str, GroundTruthView] | None = None
        self._lock = threading.RLock()

    def keep(self, observation: Observation) -> None:
        """Remember one look; a second look at the same state shows the same and is not kept."""
        state = self._table.snapshot()
        if self._looks and self._looks[-1].state.same_as(state):
            return
        observation_log = {name: self._sight(view, state) for name, view in observation.views.items()}
        self._looks.append(Look(state, observation_log))

    def of(self, view_id: str) -> Sequence[GroundTruthView]:
        """Every look at a view, newest first; one for a picture of the instruction; () for an unknown id."""
        if view_id.startswith("slot:"):
            found = self._of_slots().get(view_id)
            return () if found is None else (found,)
        return tuple(look.observation_log[view_id] for look in reversed(self._looks) if view_id in look.observation_log)

    def _sight(self, view: View, state: Snapshot) -> GroundTruthView:
        # Nothing that is handed out holds the log, which holds it: pictures in a circle stay until the collector comes by.
        table, camera, lock = self._table, view.camera_name, self._lock
        return GroundTruthView(
            view.without_depth(),
            Lazily(lambda: _alone(lock, lambda: table.masks_at(state, camera))),
            Lazily(lambda: true_things(table.things, table.poses_at(state))),
        )

    def _of_slots(self) -> Mapping[str, GroundTruthView]:
        with self._lock:
            if self._slots is None:
                self._slots = {
                    view.id: self._slot_sight(name, view)
                    for name, slot in self._table.instruction().slots.items()
                    for view in slot.views.values()
                }
            return self._slots

    def _slot_sight(self, name: str, view: View) -> GroundTruthView:
        table, lock = self._table, self._lock
        return GroundTruthView(
            view,
            Lazily(lambda: _alone(lock, lambda: table.slot_masks(name, view.camera_name))),
            Lazily(lambda: {thing.name: true_thing(thing, pose) for thing, pose in table.slot_stands(name)}),
        )


def _alone(lock: threading.RLock, draw: Callable[[], Mapping[str, Array]]) -> Mapping[str, Array]:
    """One drawing at a time: all pictures of an instruction are set up in the same state."""
    with lock:
        return draw()


def true_things(things: Mapping[str, Thing], poses: Mapping[str, Pose]) -> dict[str, TrueThing]:
    """The things at these poses, as simulated models are told of them."""
    return {name: true_thing(thing, poses[name]) for name, thing in things.items()}


def true_thing(thing: Thing, pose: Pose) -> TrueThing:
    """One thing at a pose."""
    body, position = thing.body, pose.position_m
    return TrueThing(
        name=thing.name,
        words=_words(thing),
        kind=KINDS.get(body.kind, "object"),
        shape=thing.shape,
        cover=thing.texture,
        position_m=position,
        yaw_rad=pose.yaw_rad,
        height_m=float(position[2]) + body.height_m,
        outline_m=_outline(footprint_of(thing, pose)),
        grasp_m=np.array(grasp_point(thing, pose)),
    )


def _words(thing: Thing) -> str:
    """What a person would call it: a fruit by its name, a card by what stands on it, other things by cover and shape."""
    if thing.body.kind == "fruit":
        return thing.shape
    if thing.texture.startswith(prints.PREFIX):
        return f"{thing.shape} that says {thing.texture.removeprefix(prints.PREFIX)}"
    return thing.texture if thing.texture.endswith(thing.shape) else f"{thing.texture} {thing.shape}"


def _outline(footprint: BaseGeometry) -> Array:
    """The corners of what is covered; of several pieces, those of their hull. Holes are filled."""
    whole = footprint if footprint.geom_type == "Polygon" else footprint.convex_hull
    corners = shapely.get_coordinates(whole.exterior.simplify(OUTLINE_STEP_M))
    return np.asarray(corners[:-1])
