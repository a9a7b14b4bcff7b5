"""What is seen and what is wanted: views, observations, instructions."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import numpy as np

from wonderful_team.core.geometry import Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.notebook import card
from wonderful_team.core.once import Once
from wonderful_team.core.pictures import checked_depth, checked_rgb, picture_hash, pixels_hash
from wonderful_team.core.text import counted, picture_names, spoken
from wonderful_team.errors import ConfigError

SlotKind: TypeAlias = Literal["object", "scene", "frame", "before", "after"]


@dataclass(frozen=True, eq=False)
class View:
    """One camera's view at one instant.

    Attributes:
        id: Unique within an observation or an instruction, such as "top" or "slot:base_obj:top".
        camera_name: Which camera took it.
        time_s: When, in the world's own time [s].
        rgb: Image, shape (H, W, 3), uint8, row 0 at the top.
        depth_m: Distance along the optical axis [m], shape (H, W); NaN where unknown; None without depth.
        camera: Model and pose of the camera in the robot base frame; None for a photo.
    """

    id: str
    camera_name: str
    time_s: float
    rgb: Array
    depth_m: Array | None = None
    camera: Camera | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "rgb", checked_rgb(self.rgb))
        object.__setattr__(self, "depth_m", checked_depth(self.depth_m, self.rgb.shape[:2]))

    @property
    def size_px(self) -> tuple[int, int]:
        """Width, height."""
        return self.rgb.shape[1], self.rgb.shape[0]

    @cached_property
    def hash(self) -> str:
        return picture_hash(self.rgb)

    @property
    def drawn(self) -> bool:
        """Whether its pixels are there."""
        return True

    def without_depth(self) -> View:
        """The same picture, for those who read no depth."""
        return replace(self, depth_m=None)

    def has_the_pixels_of(self, other: View) -> bool:
        """Whether both hold one and the same image; nothing is drawn for that."""
        return self is other or (self.drawn and other.drawn and self.rgb is other.rgb)


class LaterView(View):
    """A view of a simulator that is drawn when its pixels are first asked for: many are never looked at.

    Args:
        size_px: Width, height of what `draw` gives.
        draw: Gives rgb and depth_m of `View` as they were at `time_s`, whenever it is called; called once at most.
    """

    _drawn: Once[tuple[Array, Array | None]]
    _origin: object

    def __new__(cls, *args: Any, **fields: Any) -> Any:
        # `dataclasses.replace` hands over the fields of a view: what it makes has its pixels.
        return View(**fields) if "rgb" in fields else super().__new__(cls)

    def __init__(
        self,
        id: str,
        camera_name: str,
        time_s: float,
        size_px: tuple[int, int],
        draw: Callable[[], tuple[Array, Array | None]],
        camera: Camera | None = None,
    ) -> None:
        def drawn() -> tuple[Array, Array | None]:
            rgb, depth_m = draw()
            rgb = checked_rgb(rgb)
            return rgb, checked_depth(depth_m, rgb.shape[:2])

        given = {"id": id, "camera_name": camera_name, "time_s": time_s, "camera": camera}
        pixels = Once(drawn)
        self.__dict__.update(given, _size_px=size_px, _drawn=pixels, _origin=pixels)

    @property
    def size_px(self) -> tuple[int, int]:
        size: tuple[int, int] = self.__dict__["_size_px"]
        return size

    @property
    def rgb(self) -> Array:
        return self._drawn()[0]

    @property
    def depth_m(self) -> Array | None:
        return self._drawn()[1]

    def without_depth(self) -> View:
        bare = LaterView(self.id, self.camera_name, self.time_s, self.size_px, lambda: (self.rgb, None), self.camera)
        bare.__dict__["_origin"] = self._origin
        return bare

    def has_the_pixels_of(self, other: View) -> bool:
        alike = isinstance(other, LaterView) and self._origin is other._origin
        return alike or super().has_the_pixels_of(other)

    @property
    def drawn(self) -> bool:
        return self._drawn.made


@dataclass(frozen=True, eq=False)
class RobotState:
    """What the robot says of itself: tool position (3,) [m], gripper opening 0..1 or None, holding something or not."""

    tool_m: Array | None = None
    gripper: float | None = None
    holding: bool | None = None


@dataclass(frozen=True, eq=False)
class Observation:
    """All views at one instant; the first is the one that targets are grounded in."""

    views: Mapping[str, View]
    robot: RobotState | None = None

    def __post_init__(self) -> None:
        if not self.views:
            raise ConfigError("an observation needs at least one view")
        object.__setattr__(self, "views", MappingProxyType(dict(self.views)))

    @property
    def main(self) -> View:
        """The view that targets are grounded in."""
        return next(iter(self.views.values()))

    @cached_property
    def hash(self) -> str:
        """SHA-256 over the pixels of all views, in order: 64 hex digits."""
        return hashlib.sha256("".join(pixels_hash(view.rgb) for view in self.views.values()).encode()).hexdigest()

    def shows_the_same_as(self, other: Observation) -> bool:
        """Whether all views hold the same pixels, as two equal hashes say; the main views are compared first."""
        mine, theirs = tuple(self.views.values()), tuple(other.views.values())
        if len(mine) != len(theirs):
            return False
        return all(a is b or np.array_equal(a.rgb, b.rgb) for a, b in zip(mine, theirs, strict=True))

    @cached_property
    def short_hash(self) -> str:
        """What plans of earlier releases call it: 16 hex digits."""
        return hashlib.sha256("".join(view.hash for view in self.views.values()).encode()).hexdigest()[:16]

    def is_called(self, named: str) -> bool:
        """Whether a plan means this observation by the hash that it names."""
        return named == self.hash or named == self.short_hash

    def _repr_html_(self) -> str:
        """In a notebook: every view, with what is known beside its pixels."""
        pictures = []
        for name, view in self.views.items():
            known = [word for word, value in (("depth", view.depth_m), ("camera", view.camera)) if value is not None]
            size = f"{view.size_px[0]} x {view.size_px[1]} px"
            pictures.append((view.rgb, f"{name}, {size}, {' and '.join(known) or 'no depth, no camera'}"))
        return card(f"observation of {counted(len(pictures), 'view')}", pictures=pictures)


@dataclass(frozen=True, eq=False)
class Slot:
    """A picture inside an instruction: `{name}` in the text stands for it.

    Attributes:
        kind: object (one thing alone), scene (a whole table), frame (of a sequence), before / after (of a pair).
        index: Place in a sequence of frames or pairs; None otherwise.
        views: By camera name, such as top and front.
    """

    name: str
    kind: SlotKind
    views: Mapping[str, View]
    index: int | None = None

    def __post_init__(self) -> None:
        if not self.views:
            raise ConfigError(f"instruction slot {self.name!r} holds no picture")
        object.__setattr__(self, "views", MappingProxyType(dict(self.views)))


@dataclass(frozen=True, eq=False)
class Instruction:
    """What the human wants: words with `{slot}` marks, and the pictures for them. A slot may occur twice.

    Raises:
        ConfigError: The text is empty, or a slot's picture is never mentioned.
    """

    text: str
    slots: Mapping[str, Slot] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.text.strip():
            raise ConfigError("the instruction is empty")
        for name in self.slots:
            if f"{{{name}}}" not in self.text:
                raise ConfigError(
                    f"the instruction has a picture {name!r} but its text never says {{{name}}}: {self.text!r}"
                )
        object.__setattr__(self, "slots", MappingProxyType(dict(self.slots)))

    @property
    def plain_text(self) -> str:
        """The words as people read them without the pictures: "put [picture 1] into [picture 2]"."""
        return spoken(self.text, picture_names(self.text, self.slots))
