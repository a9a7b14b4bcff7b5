"""Pictures with known marks: plain coloured shapes, well spread, on quiet backgrounds, all from a seed.

Every mark is named by colour and shape ("red circle"), no colour occurs twice, and backgrounds are nearly colourless, so that
weak models find them too: what is measured is how a model says where things are, not whether it sees them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.values import Target

COLOURS: dict[str, tuple[int, int, int]] = {
    "red": (214, 24, 24),
    "orange": (255, 136, 0),
    "yellow": (250, 220, 20),
    "green": (20, 150, 40),
    "cyan": (0, 200, 210),
    "blue": (25, 60, 215),
    "purple": (135, 30, 190),
    "black": (12, 12, 12),
}
"""RGB of each mark; hues are at least 25 degrees apart."""
BACKGROUNDS = ("plain", "slope", "speckle")
_RADIUS_SHARE = 0.045
"""Radius of a mark as a share of the geometric mean of the sides."""
_GAP_PX = 2.0
"""Least distance of a mark to the picture's edge."""


@dataclass(frozen=True)
class Mark:
    """One mark: what it is called, its true outline's box and its middle [picture px]."""

    words: str
    box: Box
    centre: Point


@dataclass(frozen=True, eq=False)
class MarkedScene:
    """A picture, and what is where in it.

    Attributes:
        absent: Words for things that are not in the picture.
        seed: Where it comes from.
    """

    picture: Picture
    marks: tuple[Mark, ...]
    absent: tuple[str, ...] = ()
    seed: int = 0

    def targets(self) -> tuple[Target, ...]:
        """The marks as targets T1, T2, …, each with one point (pick)."""
        return tuple(Target(f"T{k}", "object", mark.words, use=("pick",)) for k, mark in enumerate(self.marks, start=1))


def marked_scene(
    seed: int, size_px: tuple[int, int], *, background: str | None = None, absent: int = 0, name: str = "scene"
) -> MarkedScene:
    """Draw a picture with one mark of each colour, less those that are left out.

    Args:
        seed: Decides places, shapes, backgrounds and what is absent.
        size_px: Width and height, each at least 96.
        background: One of BACKGROUNDS; None lets the seed choose.
        absent: How many colours are left out and listed as absent.
        name: What the words call the picture.

    Raises:
        ValueError: The picture is too small, or more colours are to be left out than there are.
    """
    width, height = size_px
    if min(size_px) < 96 or not 0 <= absent < len(COLOURS):
        raise ValueError(f"sides must be at least 96 px and absent below {len(COLOURS)}, got {size_px} and {absent}")
    rng = np.random.default_rng([seed, width, height])
    colours = [str(colour) for colour in rng.permutation(list(COLOURS))]
    shapes = [tuple(SHAPES)[i % len(SHAPES)] for i in rng.permutation(len(COLOURS))]
    rgb = _background(rng, size_px, background or str(rng.choice(BACKGROUNDS)))
    radius = max(6.0, _RADIUS_SHARE * float(np.sqrt(width * height)))
    marks = []
    for centre, colour, shape in zip(
        _places(rng, size_px, radius, len(COLOURS) - absent), colours, shapes, strict=False
    ):
        mask = shape_mask(size_px, centre, radius, SHAPES[shape])
        rgb[mask] = COLOURS[colour]
        rows, columns = np.nonzero(mask)
        box = Box(float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1))
        marks.append(Mark(f"{colour} {shape}", box, box.centre))
    missing = tuple(f"{colour} {shape}" for colour, shape in zip(colours, shapes, strict=True))[len(marks) :]
    frame = Frame.whole(name, size_px)
    return MarkedScene(Picture(name, rgb, frame), tuple(marks), missing, seed)


def _circle(dx: Array, dy: Array, r: float) -> Array:
    return np.asarray(dx * dx + dy * dy <= r * r)


def _square(dx: Array, dy: Array, r: float) -> Array:
    return np.asarray(np.maximum(abs(dx), abs(dy)) <= 0.85 * r)


def _diamond(dx: Array, dy: Array, r: float) -> Array:
    return np.asarray(abs(dx) + abs(dy) <= 1.15 * r)


def _cross(dx: Array, dy: Array, r: float) -> Array:
    arm = 0.36 * r
    inside = np.maximum(abs(dx), abs(dy)) <= r
    return np.asarray(inside & ((abs(dx) <= arm) | (abs(dy) <= arm)))


SHAPES: dict[str, Callable[[Array, Array, float], Array]] = {
    "circle": _circle,
    "square": _square,
    "diamond": _diamond,
    "cross": _cross,
}
"""Shapes whose middle is the middle of their box, so that "the middle" means one thing."""


def shape_mask(
    size_px: tuple[int, int], centre: Point, radius: float, shape: Callable[[Array, Array, float], Array]
) -> Array:
    width, height = size_px
    dx = np.arange(width)[None, :] + 0.5 - centre[0]
    dy = np.arange(height)[:, None] + 0.5 - centre[1]
    return shape(dx, dy, radius)


def _places(rng: np.random.Generator, size_px: tuple[int, int], radius: float, count: int) -> list[Point]:
    """Centres in a grid of cells, one each, jittered; the outermost cells reach to the picture's edge."""
    width, height = size_px
    columns = max(1, round(np.sqrt(count * width / height)))
    rows = int(np.ceil(count / columns))
    while columns * rows < count:
        rows += 1
    cells = [(column, row) for row in range(rows) for column in range(columns)]
    # Corners first: they decide scale and offset.
    corners = [cell for cell in cells if cell[0] in (0, columns - 1) and cell[1] in (0, rows - 1)]
    others = [cell for cell in cells if cell not in corners]
    chosen = (corners + [others[i] for i in rng.permutation(len(others))])[:count]
    reach = 1.2 * radius + _GAP_PX
    places = []
    for column, row in chosen:
        x = _jittered(rng, column, columns, width, reach)
        y = _jittered(rng, row, rows, height, reach)
        places.append((x, y))
    return places


def _jittered(rng: np.random.Generator, cell: int, cells: int, side: int, reach: float) -> float:
    """A place within a cell; cells at the edge put theirs near the edge."""
    low, high = side * cell / cells + reach, side * (cell + 1) / cells - reach
    if high <= low:
        return side * (cell + 0.5) / cells
    if cells > 1 and cell == 0:
        high = low + (high - low) * 0.35
    elif cells > 1 and cell == cells - 1:
        low = high - (high - low) * 0.35
    return float(rng.uniform(low, high))


def _background(rng: np.random.Generator, size_px: tuple[int, int], kind: str) -> Array:
    """A nearly colourless background, shape (H, W, 3), uint8."""
    if kind not in BACKGROUNDS:
        raise ValueError(f"background {kind!r}: valid are {', '.join(BACKGROUNDS)}")
    width, height = size_px
    level = float(rng.uniform(150, 205))
    shade = np.full((height, width), level)
    if kind == "slope":
        angle = rng.uniform(0, 2 * np.pi)
        across = np.linspace(-1, 1, width)[None, :] * np.cos(angle) + np.linspace(-1, 1, height)[:, None] * np.sin(
            angle
        )
        shade = shade + 22 * across
    elif kind == "speckle":
        shade = shade + rng.normal(0, 5, size=(height, width))
    tint = rng.uniform(-6, 6, size=3)
    return np.clip(shade[..., None] + tint, 0, 255).astype(np.uint8)
