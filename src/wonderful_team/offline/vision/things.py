"""What the eyes report: things with their looks, the scene they lie in, and what an example picture shows."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.images.colours import ColourShare, colour_shares, darkness, membership_shares
from wonderful_team.offline.vision.outlines import Outline, deep_inside, filled, mean_width, study_outline
from wonderful_team.offline.vision.patterns import Surface, pattern_scores, study_surface
from wonderful_team.offline.vision.shapes import shape_scores


class NotSeen(WonderfulTeamError):  # noqa: N818  the name says what it is
    """A picture does not show what it was asked about, or a description cannot be judged by eye; says why."""

    stage = "grounding"


@dataclass(frozen=True, eq=False)
class Look:
    """How something looks, wherever it lies.

    Attributes:
        colours: Its colours, largest share first.
        memberships: Mean degree of every colour name over its surface; sums to 1.
        pattern, patterns: Best canonical pattern, and how well each fits.
        shape, shapes: Best canonical shape, and how well each fits.
        letters: How well each capital letter fits.
        outline: Its outline, free of size and rotation.
        surface: Texture statistics.
        histogram: Square roots of a smoothed CIELAB histogram, length 1, shape (3757,).
    """

    colours: tuple[ColourShare, ...]
    memberships: dict[str, float]
    pattern: str
    patterns: dict[str, float]
    shape: str
    shapes: dict[str, float]
    letters: dict[str, float]
    outline: Outline
    surface: Surface
    histogram: Array

    @property
    def colourless(self) -> float:
        """Share of white, grey and black."""
        return self.memberships["white"] + self.memberships["grey"] + self.memberships["black"]

    @property
    def letter(self) -> str:
        """The letter that it is, or ""."""
        return max(self.letters, key=self.letters.__getitem__) if self.shape == "letter" else ""

    @property
    def words(self) -> str:
        """Such as "red and white striped star"."""
        named = " and ".join(colour.words for colour in self.colours[:3])
        pattern = "" if self.pattern == "plain" else f" {self.pattern}"
        return f"{named}{pattern} {self.shape}".strip()


@dataclass(frozen=True, eq=False)
class Thing:
    """One thing in a picture; coordinates are pixels of that picture.

    Attributes:
        number: Its place in Scene.things.
        box: Tight round it.
        centre: Centroid of its filled outline.
        mask: Where it shows, cropped to its box, in working pixels, bool.
        offset: Working pixel (column, row) of the mask's corner.
        zoom: Picture pixels per working pixel.
        area_px: Filled area [picture px squared].
        look: Colours, pattern, shape.
        height_m: Its top above the table [m]; None without depth.
        flat: A thin area such as a paper: measured with depth, judged from its plain look without.
        cut: It reaches the edge of what the picture shows.
        on: Number of the thing it lies on or in, or None.
        tall_px: How much of its side a second, slanted view shows [px of that view]; None without one.
    """

    number: int
    box: Box
    centre: Point
    mask: Array
    offset: tuple[int, int]
    zoom: float
    area_px: float
    look: Look
    height_m: float | None = None
    flat: bool = False
    cut: bool = False
    on: int | None = None
    tall_px: float | None = None

    def holds(self, point: Point) -> bool:
        """Whether a point [picture px] lies on what shows of it."""
        return self._shows(self.mask, point)

    def covers(self, point: Point) -> bool:
        """Whether a point [picture px] lies inside its outer outline, holes included."""
        return self._shows(self._whole, point)

    def _shows(self, mask: Array, point: Point) -> bool:
        column = int(point[0] / self.zoom) - self.offset[0]
        row = int(point[1] / self.zoom) - self.offset[1]
        height, width = mask.shape
        return 0 <= column < width and 0 <= row < height and bool(mask[row, column])

    @cached_property
    def _whole(self) -> Array:
        return filled(self.mask)

    @property
    def radius_px(self) -> float:
        """Radius of a disc of its area [picture px]."""
        return float(np.sqrt(self.area_px / np.pi))

    @cached_property
    def _deep(self) -> Array:
        return deep_inside(self.mask)

    @property
    def wide_px(self) -> float:
        """How wide its material is on the whole [picture px]."""
        return mean_width(self._deep) * self.zoom

    def steady_point(self) -> Point:
        """A point well inside what shows of it: its centre when that lies on it, else the deepest one near the centre."""
        return self._steady

    @cached_property
    def _steady(self) -> Point:
        deep = self._deep
        rows, columns = np.mgrid[0 : deep.shape[0], 0 : deep.shape[1]]
        away = np.hypot(
            columns + 0.5 + self.offset[0] - self.centre[0] / self.zoom,
            rows + 0.5 + self.offset[1] - self.centre[1] / self.zoom,
        )
        if self.holds(self.centre) and deep[away <= 1.0].max(initial=0.0) >= 0.35 * deep.max():
            return self.centre
        row, column = np.unravel_index(int(np.where(deep >= 0.7 * deep.max(), away, np.inf).argmin()), deep.shape)
        return (column + 0.5 + self.offset[0]) * self.zoom, (row + 0.5 + self.offset[1]) * self.zoom


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that was seen in one picture.

    Attributes:
        things: Objects and papers, left to right.
        occupied: Where any thing or background beyond the table shows, working pixels, bool.
        zoom: Picture pixels per working pixel.
        view_scale: Picture pixels per view pixel.
        size_px: Width and height of the picture.
        valid: The part that shows the view.
        has_depth: Heights were measured.
    """

    things: tuple[Thing, ...]
    occupied: Array
    zoom: float
    view_scale: float
    size_px: tuple[int, int]
    valid: Box
    has_depth: bool

    @property
    def table(self) -> Box:
        """The part of the picture in which free table shows [picture px]; all of it when none does."""
        rows, columns = np.nonzero(~self.occupied)
        if not len(rows):
            return self.valid
        (x0, x1), (y0, y1) = (np.percentile(places, (2, 98)) * self.zoom for places in (columns, rows))
        return Box(float(x0), float(y0), float(x1) + self.zoom, float(y1) + self.zoom)

    @property
    def objects(self) -> tuple[Thing, ...]:
        """Things that are not flat areas."""
        return tuple(thing for thing in self.things if not thing.flat)

    @property
    def areas(self) -> tuple[Thing, ...]:
        """Flat areas such as papers."""
        return tuple(thing for thing in self.things if thing.flat)

    def at(self, point: Point) -> Thing | None:
        """The smallest thing that shows at a point [picture px], or None."""
        under = [thing for thing in self.things if thing.holds(point)]
        return min(under, key=lambda thing: thing.area_px, default=None)

    def on(self, thing: Thing) -> tuple[Thing, ...]:
        """The things that lie directly on or in a thing."""
        return tuple(other for other in self.things if other.on == thing.number)


@dataclass(frozen=True, eq=False)
class Example:
    """What an object picture shows alone.

    Attributes:
        look: Colours, pattern, shape.
        box: Tight round it [px of that picture].
        area_view_px: Its filled area [px squared of the view], for comparing sizes in like views.
        wide_view_px: How wide its material is on the whole [px of the view].
        gapless: Its look if the gaps in it are white parts that have vanished; None where `look` says so already.
        open_outline: Its outline if the gaps that were taken for vanished texture are holes instead; None without any.
    """

    look: Look
    box: Box
    area_view_px: float
    wide_view_px: float
    open_outline: Outline | None = None
    gapless: Look | None = None


@dataclass(frozen=True, eq=False)
class Match:
    """A thing or a free spot that fits a description.

    Attributes:
        thing: The thing; None for a free spot.
        box, point: Where [picture px]; the point lies on the thing or in the free spot.
        score: 0 to 1.
        margin: Score over the next best candidate; small means that several are nearly equal.
        why: What decided, in words.
        parts: Score of each aspect that was judged.
    """

    thing: Thing | None
    box: Box
    point: Point
    score: float
    margin: float
    why: str
    parts: dict[str, float] = field(default_factory=dict)


def with_margins(matches: list[Match]) -> list[Match]:
    """Each match's lead over the best of the others (negative when behind); the best one comes first."""
    best, *others = [match.score for match in matches] or [0.0]
    rivals = [max(others, default=0.0), *(best for _ in others)]
    return [replace(match, margin=match.score - rival) for match, rival in zip(matches, rivals, strict=False)]


def study_look(rgb: Array, lab: Array, mask: Array, shown: Array | None = None) -> Look:
    """Colours, pattern and shape of what a mask shows.

    Args:
        rgb: Crop, shape (h, w, 3), uint8.
        lab: The same in CIELAB, float32.
        mask: Shape (h, w), bool, not empty.
        shown: The part of the mask whose surface counts; all of it when None.
    """
    visible = mask if shown is None else shown
    inner = inner_part(visible)
    pixels = rgb[inner]
    surface = study_surface(lab, visible)
    patterns = pattern_scores(surface)
    outline = study_outline(mask)
    shapes, letters = shape_scores(outline)
    return Look(
        colours=colour_shares(pixels) or (_mean_colour(pixels),),
        memberships=membership_shares(pixels),
        pattern=max(patterns, key=lambda name: patterns[name]),
        patterns=patterns,
        shape=max(shapes, key=lambda name: shapes[name]),
        shapes=shapes,
        letters=letters,
        outline=outline,
        surface=surface,
        histogram=lab_histogram(lab[inner]),
    )


def _mean_colour(pixels: Array) -> ColourShare:
    """The colour of the mean, for a surface of very many colours."""
    shares = colour_shares(pixels, at_least=0.0)
    best = shares[0]
    return ColourShare(best.name, best.share, best.lab, *darkness(best.name, best.lab))


def inner_part(mask: Array) -> Array:
    """The mask without its blurred rim, as long as enough is left."""
    thin = np.pad(mask.astype(np.uint8), 1)
    for rounds in (2, 1):
        inner = cv2.erode(thin, np.ones((3, 3), np.uint8), iterations=rounds)[1:-1, 1:-1].astype(bool)
        if inner.sum() >= max(20, 0.3 * mask.sum()):
            return np.asarray(inner)
    return np.asarray(mask)


_BINS = (13, 17, 17)


def lab_histogram(pixels: Array) -> Array:
    """Square roots of a smoothed histogram of CIELAB pixels (N, 3): the dot product of two is their likeness."""
    steps = np.array([8.0, 12.0, 12.0])
    index = np.clip(((pixels + [0, 102, 102]) / steps).astype(int), 0, np.array(_BINS) - 1)
    flat = np.ravel_multi_index(tuple(index.T), _BINS)
    counts = np.bincount(flat, minlength=int(np.prod(_BINS))).reshape(_BINS).astype(np.float64)
    for axis in range(3):
        padded = np.pad(counts, [(1, 1) if k == axis else (0, 0) for k in range(3)])
        take = [padded.take(range(k, k + counts.shape[axis]), axis) for k in range(3)]
        counts = 0.2 * take[0] + 0.6 * take[1] + 0.2 * take[2]
    return np.asarray(np.sqrt(counts / max(counts.sum(), 1e-9)).ravel())


def whole_mask(thing: Thing, shape: tuple[int, int]) -> Array:
    """A thing's mask in a full working image of that shape (H, W), bool."""
    full = np.zeros(shape, dtype=bool)
    x, y = thing.offset
    h, w = thing.mask.shape
    full[y : y + h, x : x + w] = thing.mask
    return full
