"""Pictures of an instruction: what they show, and the drawing of them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import LaterView, Slot, SlotKind
from wonderful_team.sims.tabletop.appearance import PLAIN_LIGHT
from wonderful_team.sims.tabletop.cameras import CAMERA_NAMES
from wonderful_team.sims.tabletop.drawing import open_renderer
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.model import BuiltModel, Thing, build
from wonderful_team.sims.tabletop.moving import put_body
from wonderful_team.sims.tabletop.renderer import Renderer

ALONE_M = (0.5, 0.0, 0.0)
"""Where a thing stands for a picture of it alone."""
AWAY_M = 50.0
"""Where the others are then [m]."""


@dataclass(frozen=True)
class Stand:
    """One thing in a picture, and where it stands there; without `at_m` as at the start, or in the middle when alone."""

    thing: str
    at_m: tuple[float, float] | None = None
    yaw_rad: float = 0.0
    z_m: float = 0.0


@dataclass(frozen=True)
class Shown:
    """What a picture slot shows.

    Attributes:
        index: Place in a sequence of frames or pairs; None otherwise.
        stands: The things to be seen; a picture of kind object shows one, on white.
    """

    kind: SlotKind
    index: int | None
    stands: tuple[Stand, ...]

    @property
    def thing(self) -> str | None:
        """Name of the one thing that is shown alone, or None for a picture of the table."""
        return self.stands[0].thing if self.kind == "object" else None


class Studio:
    """Draws the pictures of an instruction: the table's own things in its own model, with props in a larger one."""

    def __init__(
        self,
        built: BuiltModel,
        start_qpos: Array,
        props: Sequence[Thing],
        size_px: tuple[int, int],
        wanted: str | None,
        table_renderer: Callable[[], Renderer | None],
    ) -> None:
        """Without a table that is still open, `table_renderer` gives None, and a renderer is opened for each picture."""
        # The pictures were taken before, in ordinary light, by cameras that stood where they stand now.
        look = replace(built.look, light=PLAIN_LIGHT)
        self._own = bool(props) or look.light is not built.look.light
        self._built = build((*built.things, *props), size_px, built.tool, look) if self._own else built
        self._state = mj.MjData(self._built.model)
        self._start = _start_poses(built, start_qpos)
        self._size_px, self._wanted, self._table_renderer = size_px, wanted, table_renderer
        self._renderer: Renderer | None = None
        self._closed = False
        self._lock = threading.Lock()

    def slots(self, pictures: Mapping[str, Shown]) -> dict[str, Slot]:
        """Every picture, from both cameras, drawn when it is looked at."""
        return {name: self._slot(name, shown) for name, shown in pictures.items()}

    def masks(self, shown: Shown, camera: str) -> dict[str, Array]:
        """Which pixels of a picture show each thing in it, props too, shape (H, W) bool by name."""
        ids = self._drawn(shown, lambda renderer: renderer.bodies(self._state, camera))
        return {stand.thing: ids == self._built.body_id(stand.thing) for stand in shown.stands}

    def stands(self, shown: Shown) -> list[tuple[Thing, Pose]]:
        """Everything in a picture, props too, and where it stands in it."""
        things = {thing.name: (k, thing) for k, thing in enumerate(self._built.things)}
        found = []
        for stand in shown.stands:
            number, thing = things[stand.thing]
            found.append((thing, self._pose(thing, stand, shown.kind == "object", number)))
        return found

    def close(self) -> None:
        """Give its renderer back; safe to call twice."""
        with self._lock:
            self._closed = True
            if self._renderer is not None:
                self._renderer.close()
                self._renderer = None

    def _drawn(self, shown: Shown, draw: Callable[[Renderer], Array]) -> Array:
        """One picture at a time: all are set up in the same state."""
        with self._lock:
            self._set_up(shown)
            renderer = self._open()
            if renderer is not None:
                return draw(renderer)
            renderer = open_renderer(self._built, self._wanted)[0]
            try:
                return draw(renderer)
            finally:
                renderer.close()

    def _open(self) -> Renderer | None:
        """What draws its model as long as the table is there: opened once, for the pictures and for the masks that may be asked for later."""
        if not self._own:
            return self._table_renderer()
        if self._renderer is None and not self._closed:
            self._renderer = open_renderer(self._built, self._wanted)[0]
        return self._renderer

    def _slot(self, name: str, shown: Shown) -> Slot:
        views = {}
        for camera in CAMERA_NAMES:
            draw = partial(self._colours, shown, camera)
            views[camera] = LaterView(f"slot:{name}:{camera}", camera, 0.0, self._size_px, draw)
        return Slot(name, shown.kind, views, shown.index)

    def _colours(self, shown: Shown, camera: str) -> tuple[Array, None]:
        alone = shown.kind == "object"
        return self._drawn(shown, lambda renderer: renderer.colours(self._state, camera, alone=alone)), None

    def _set_up(self, shown: Shown) -> None:
        """Put everything where the picture shows it, and the rest out of sight."""
        stands = {stand.thing: stand for stand in shown.stands}
        for k, thing in enumerate(self._built.things):
            stand = stands.get(thing.name)
            put_body(self._built, self._state, thing.name, self._pose(thing, stand, shown.kind == "object", k))
        mj.mj_forward(self._built.model, self._state)

    def _pose(self, thing: Thing, stand: Stand | None, alone: bool, number: int) -> Pose:
        if stand is None:
            return Pose.at((AWAY_M, AWAY_M + number, 0.0))
        if alone:
            return Pose.at(ALONE_M)
        if stand.at_m is None:
            return self._start[thing.name]
        return Pose.at((*stand.at_m, stand.z_m), stand.yaw_rad)


def _start_poses(built: BuiltModel, start_qpos: Array) -> dict[str, Pose]:
    state: Any = mj.MjData(built.model)
    state.qpos[:] = start_qpos
    mj.mj_forward(built.model, state)
    found = {}
    for thing in built.things:
        body = built.body_id(thing.name)
        found[thing.name] = Pose(state.xpos[body].copy(), state.xquat[body].copy())
    return found
