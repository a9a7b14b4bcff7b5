"""Pictures of an instruction: what they show, and the drawing of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Slot, SlotKind, View
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
        self, built: BuiltModel, start_qpos: Array, props: Sequence[Thing], size_px: tuple[int, int], wanted: str | None
    ) -> None:
        # The pictures were taken before, in ordinary light, by cameras that stood where they stand now.
        look = replace(built.look, light=PLAIN_LIGHT)
        self._own = bool(props) or look.light is not built.look.light
        self._built = build((*built.things, *props), size_px, built.tool, look) if self._own else built
        self._state = mj.MjData(self._built.model)
        self._start = _start_poses(built, start_qpos)
        self._wanted = wanted
        self._renderer: Renderer | None = None

    def slots(self, pictures: Mapping[str, Shown], table_renderer: Renderer) -> dict[str, Slot]:
        """Every picture, from both cameras."""
        renderer = self._draws_with(table_renderer)
        return {name: self._slot(name, shown, renderer) for name, shown in pictures.items()}

    def masks(self, shown: Shown, camera: str, table_renderer: Renderer) -> dict[str, Array]:
        """Which pixels of a picture show each thing in it, props too, shape (H, W) bool by name."""
        self._set_up(shown)
        ids = self._draws_with(table_renderer).bodies(self._state, camera)
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
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _draws_with(self, table_renderer: Renderer) -> Renderer:
        """What draws its model: opened once, for the pictures and for the masks that may be asked for later."""
        if not self._own:
            return table_renderer
        if self._renderer is None:
            self._renderer = open_renderer(self._built, self._wanted)[0]
        return self._renderer

    def _slot(self, name: str, shown: Shown, renderer: Renderer) -> Slot:
        self._set_up(shown)
        views = {}
        for camera in CAMERA_NAMES:
            rgb = renderer.colours(self._state, camera, alone=shown.kind == "object")
            views[camera] = View(f"slot:{name}:{camera}", camera, 0.0, rgb)
        return Slot(name, shown.kind, views, shown.index)

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
