"""Pictures as they travel to a model: clean pixels, where they were cut from, and marks as data.

Nothing is drawn here. The client draws marks for models that look at pixels; models that read data get the data.
All mark coordinates are pixels of the picture that carries them.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from typing import Any, Literal, TypeAlias, TypeVar

import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.later import later

Point: TypeAlias = tuple[float, float]
PathPoint: TypeAlias = tuple[float, float] | tuple[float, float, float]
"""A point of a path: (x, y) [px], and for a path in the air how far over the height at which things are carried [m]."""
BoxStyle: TypeAlias = Literal["target", "before", "after", "keep_out", "workspace"]


def rises_of(points: Sequence[PathPoint]) -> tuple[float, ...]:
    """How far up each point of a path lies [m]; () for one that does not say."""
    return tuple(point[2] for point in points if len(point) == 3)


def checked_rgb(rgb: Array, name: str = "rgb") -> Array:
    """A read-only copy of an image, shape (H, W, 3), uint8, row 0 at the top.

    Raises:
        ValueError: Another shape or type, or no pixels.
    """
    array = np.asarray(rgb)
    if array.ndim != 3 or array.shape[2] != 3 or array.dtype != np.uint8 or array.size == 0:
        raise ValueError(
            f"{name}: expected a non-empty uint8 image of shape (H, W, 3), got {array.dtype} {array.shape}"
        )
    if array.flags.writeable:
        array = array.copy()
        array.setflags(write=False)
    return array


def checked_depth(depth_m: Array | None, size: tuple[int, int]) -> Array | None:
    """A read-only float32 copy of a depth image, shape (H, W) [m]; NaN where unknown."""
    if depth_m is None:
        return None
    array = np.asarray(depth_m, dtype=np.float32)
    if array.shape != size:
        raise ValueError(f"depth_m: expected shape {size} like the image, got {array.shape}")
    if array.flags.writeable:
        array = array.copy()
        array.setflags(write=False)
    return array


_hashes: dict[int, tuple[weakref.ref[Array], str]] = {}
"""From the id of an image that nobody may change to its hash, for as long as it lives: one is shown with many marks."""


def pixels_hash(rgb: Array) -> str:
    """SHA-256 of an image's size and pixels: 64 hex digits."""
    key = id(rgb)
    known = _hashes.get(key)
    if known is not None and known[0]() is rgb and not rgb.flags.writeable:
        return known[1]
    digest = hashlib.sha256(repr(rgb.shape).encode())
    digest.update(np.ascontiguousarray(rgb).reshape(-1).view(np.uint8).data)
    made = digest.hexdigest()
    if rgb.flags.owndata and not rgb.flags.writeable:
        _hashes[key] = weakref.ref(rgb, lambda gone: _forget(key, gone)), made
    return made


def _forget(key: int, gone: weakref.ref[Array]) -> None:
    # The id may have passed to another image meanwhile.
    if (known := _hashes.get(key)) is not None and known[0] is gone:
        del _hashes[key]


def picture_hash(rgb: Array) -> str:
    """A name for an image: the first 16 hex digits of its hash."""
    return pixels_hash(rgb)[:16]


@dataclass(frozen=True, eq=False)
class Axes:
    """Labelled axes along the edges; `reference` None labels the picture's own pixels.

    Attributes:
        reference: Frame whose pixels the labels name (a crop labelled in the whole view's pixels).
    """

    reference: Frame | None = None


@dataclass(frozen=True)
class BoxMark:
    """A box, drawn in the colour of its style, with an optional label."""

    box: Box
    style: BoxStyle = "target"
    label: str = ""


@dataclass(frozen=True)
class PointMark:
    """One point with an optional label."""

    point: Point
    label: str = ""


@dataclass(frozen=True)
class Candidates:
    """Numbered points to choose from: candidate k (1-based) stands at points[k - 1].

    Attributes:
        prefix: Stands before every number, where points of several things are told apart ("P1", "Q1").
    """

    points: tuple[Point, ...]
    prefix: str = later("")

    def at(self, number: int) -> Point:
        """The point with that number.

        Raises:
            ValueError: No such number.
        """
        if not 1 <= number <= len(self.points):
            raise ValueError(f"candidate {number} does not exist; valid: 1 to {len(self.points)}")
        return self.points[number - 1]


@dataclass(frozen=True)
class PathMark:
    """A path through points, drawn with an arrow at its end and its label where it starts.

    Attributes:
        width: Of the strip that a tool sweeps along it, drawn under the line [px of the picture]; 0 for none.
        bowed: Only its two ends count, as of a thing that is carried: it is drawn as a bow, which no other one covers.
    """

    points: tuple[Point, ...]
    label: str = ""
    width: float = 0.0
    bowed: bool = False


@dataclass(frozen=True)
class LineMark:
    """A straight line, such as the edge of a box inside an edge strip."""

    start: Point
    end: Point


@dataclass(frozen=True)
class Tiles:
    """Numbered pictures inside a picture, to choose from: tile k (1-based) is boxes[k - 1]."""

    boxes: tuple[Box, ...]

    def at(self, number: int) -> Box:
        """The tile with that number.

        Raises:
            ValueError: No such number.
        """
        if not 1 <= number <= len(self.boxes):
            raise ValueError(f"tile {number} does not exist; valid: 1 to {len(self.boxes)}")
        return self.boxes[number - 1]


@dataclass(frozen=True)
class Grid:
    """A grid over the whole picture; its tiles are called a1, a2, b1, ...: columns by letters from the left, rows by numbers from
    the bottom.
    """

    columns: int
    rows: int

    @property
    def names(self) -> tuple[str, ...]:
        """All tiles, column after column."""
        return tuple(f"{chr(97 + column)}{row + 1}" for column in range(self.columns) for row in range(self.rows))

    def tile(self, name: str, size_px: tuple[int, int]) -> Box:
        """A tile in a picture of that size.

        Raises:
            ValueError: No such tile.
        """
        if name not in self.names:
            raise ValueError(f"tile {name!r} does not exist; valid: {self.names[0]} to {self.names[-1]}")
        place = self.names.index(name)
        column, row = place // self.rows, self.rows - 1 - place % self.rows
        wide, high = size_px[0] / self.columns, size_px[1] / self.rows
        return Box(column * wide, row * high, (column + 1) * wide, (row + 1) * high)


@dataclass(frozen=True)
class TurnMark:
    """A thing that is turned: its outline as it comes to lie, and by how much it was turned.

    Attributes:
        centre: Middle of the outline, the arc's centre.
        corners: Its box's corners at the end, turned; in order.
        clockwise_deg: The turn, as the picture shows it.
        label: Of the step that turns it.
    """

    centre: Point
    corners: tuple[Point, ...]
    clockwise_deg: float
    label: str = ""


@dataclass(frozen=True)
class RegionMark:
    """A region that nothing may enter, by its corners; a camera at a slant makes a rectangle on the table any quadrangle."""

    corners: tuple[Point, ...]
    label: str = ""


Mark: TypeAlias = Axes | BoxMark | PointMark | Candidates | PathMark | LineMark | Tiles | Grid | TurnMark | RegionMark
M = TypeVar("M", bound=Mark)


@dataclass(frozen=True, eq=False)
class Panel:
    """A picture that stands inside a larger one, and where its top-left corner lies there [px]."""

    picture: Picture
    origin_px: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Picture:
    """One picture as a model is shown it, marks not yet drawn.

    Attributes:
        name: What the words call it ("top view", "crop before", "strip left outside").
        rgb: Clean pixels, shape (H, W, 3), uint8.
        frame: Maps this picture's pixels to the view it was cut from.
        depth_m: Distance along the optical axis [m], shape (H, W); None without depth.
        marks: What is to be drawn on it, in pixels of this picture.
        panels: The pictures that stand side by side in it, from left to right; () for a picture of one view. Its frame is
            then that of the first panel.
    """

    name: str
    rgb: Array
    frame: Frame
    depth_m: Array | None = None
    marks: tuple[Mark, ...] = field(default=())
    panels: tuple[Panel, ...] = field(default=())

    def __post_init__(self) -> None:
        object.__setattr__(self, "rgb", checked_rgb(self.rgb))
        object.__setattr__(self, "depth_m", checked_depth(self.depth_m, self.rgb.shape[:2]))
        if (self.rgb.shape[1], self.rgb.shape[0]) != self.frame.size_px:
            raise ValueError(
                f"picture {self.name!r}: {self.rgb.shape[1::-1]} px, but its frame says {self.frame.size_px}"
            )

    @property
    def size_px(self) -> tuple[int, int]:
        """Width, height."""
        return self.frame.size_px

    @cached_property
    def hash(self) -> str:
        """Hash of the clean pixels."""
        return picture_hash(self.rgb)

    @property
    def source_hash(self) -> str:
        """Names what it shows without marks: the same for as long as its pixels are, which need not be made for it."""
        return self.hash

    def marked(self, *marks: Mark) -> Picture:
        """The same picture with these marks added."""
        return replace(self, marks=self.marks + marks)

    def named(self, name: str) -> Picture:
        """The same picture under another name."""
        return replace(self, name=name)

    def mark(self, kind: type[M]) -> list[M]:
        """All marks of one kind, in order."""
        return [mark for mark in self.marks if isinstance(mark, kind)]


def with_pictures(value: Any, change: Callable[[Picture], Picture]) -> Any:
    """The same value with every picture in it changed; the value itself when none is."""
    match value:
        case Picture():
            return change(value)
        case tuple():
            new_items = tuple(with_pictures(item, change) for item in value)
            return new_items if any(new is not old for new, old in zip(new_items, value, strict=True)) else value
        case _ if is_dataclass(value) and not isinstance(value, type):
            held = {item.name: getattr(value, item.name) for item in fields(value) if item.init}
            new = {name: with_pictures(item, change) for name, item in held.items()}
            return replace(value, **new) if any(new[name] is not held[name] for name in held) else value
        case _:
            return value
