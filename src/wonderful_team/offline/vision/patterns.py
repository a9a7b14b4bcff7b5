"""Surface patterns: striped, dotted, checkered, swirled, … from the colours and edges inside a thing's outline."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.description import PATTERNS
from wonderful_team.offline.vision.fitting import least_squares


@dataclass(frozen=True, eq=False)
class Surface:
    """Texture statistics of a thing.

    Attributes:
        contrast: Spread of the colours about their mean inside the outline [CIELAB units].
        one_way: How far all edges inside run in one direction, 0 to 1 (stripes).
        two_way: How far they run in two crossing directions, 0 to 1 (checks).
        edges: Mean strength of edges inside [CIELAB units per pixel].
        spots: Number of separate compact patches of one of its two main colours.
        spotted: Share of that colour that lies in such patches, 0 to 1.
        rare_share: Share of the surface that the rarer of the two main colours covers.
        hues: Number of different hues that show.
        two_tone: How well two colours explain the surface, 0 to 1.
    """

    contrast: float
    one_way: float
    two_way: float
    edges: float
    spots: int
    spotted: float
    rare_share: float
    hues: int
    two_tone: float

    @property
    def stripes(self) -> float:
        """How far its edges make stripes, 0 to 1."""
        return float(np.clip((self.one_way - 0.5) / 0.3, 0, 1))

    @property
    def checks(self) -> float:
        """How far they make a grid, as checks, tiles and bricks do, 0 to 1."""
        return float(np.clip((self.two_way - 0.35) / 0.25, 0, 1)) * (1 - self.stripes)

    @property
    def numbers(self) -> Array:
        """The statistics as one vector for comparison, shape (7,), each about 0 to 1."""
        return np.array(
            [
                min(self.contrast / 40, 1.5),
                self.one_way,
                self.two_way,
                min(self.edges / 15, 1.5),
                min(self.spots / 15, 1.0),
                self.spotted,
                self.two_tone,
            ]
        )


def study_surface(lab: Array, mask: Array) -> Surface:
    """Texture statistics inside a mask.

    Args:
        lab: CIELAB crop, shape (h, w, 3).
        mask: The thing, shape (h, w), bool.
    """
    inner = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8), iterations=2).astype(bool)
    if inner.sum() < 40:
        inner = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    if inner.sum() < 20:
        inner = mask
    inner = _without_blurred_rim(lab, inner)
    pixels = lab[inner].astype(np.float64)
    contrast = _contrast(pixels, inner)
    one_way, two_way, edges = _directions(lab, inner)
    labels, share, fit = _two_colours(pixels)
    spots, spotted = 0, 0.0
    for tone in (0, 1):
        image = np.zeros(mask.shape, np.uint8)
        image[inner] = labels == tone
        number, part = _spots(image, float(inner.sum()))
        if number * part > spots * spotted:
            spots, spotted = number, part
    chroma, hue = np.hypot(pixels[:, 1], pixels[:, 2]), np.arctan2(pixels[:, 2], pixels[:, 1])
    vivid = chroma > 22
    counts = np.histogram(hue[vivid], bins=12, range=(-np.pi, np.pi))[0] / max(len(pixels), 1)
    return Surface(contrast, one_way, two_way, edges, spots, spotted, share, int((counts > 0.06).sum()), fit)


ON_THE_RIM = 0.9
"""A second tone of which this share lies on the outermost pixels is the table's, blurred into the edge."""


def _without_blurred_rim(lab: Array, inner: Array) -> Array:
    """The mask without its outermost pixels where these alone differ from the rest."""
    core = cv2.erode(inner.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=0).astype(bool)
    if core.sum() < 40:
        return inner
    rare = np.zeros(inner.shape, bool)
    rare[inner] = _two_colours(lab[inner].astype(np.float64))[0] == 1
    return core if rare.any() and (rare & ~core).sum() >= ON_THE_RIM * rare.sum() else inner


def _contrast(pixels: Array, inner: Array) -> float:
    """Spread of colours that is no shading: what remains after a smooth rise and fall of lightness is taken out."""
    rows, columns = np.nonzero(inner)
    y = (rows - rows.mean()) / max(float(np.ptp(rows)), 1.0)
    x = (columns - columns.mean()) / max(float(np.ptp(columns)), 1.0)
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    stride = max(1, len(x) // 1500)
    fit = least_squares(terms[::stride], pixels[::stride])
    left = pixels[::stride] - terms[::stride] @ fit
    return float(np.sqrt(np.einsum("ij,ij->", left, left) / len(left)))


def _directions(lab: Array, inner: Array) -> tuple[float, float, float]:
    """Agreement of edge directions over one and over two axes, and mean edge strength."""
    smooth = cv2.GaussianBlur(lab, (0, 0), 0.8)
    gx, gy = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, scale=0.125), cv2.Sobel(smooth, cv2.CV_32F, 0, 1, scale=0.125)
    # Colour structure tensor: add over the three channels.
    gx, gy = gx[inner], gy[inner]
    xx, yy, xy = (np.einsum("ij,ij->i", one, other) for one, other in ((gx, gx), (gy, gy), (gx, gy)))
    strength = np.sqrt(xx + yy)
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    weight = np.where(strength > 0.4 * np.percentile(strength, 90), xx + yy, 0.0)
    total = weight.sum()
    if total < 1e-6:
        return 0.0, 0.0, 0.0
    one = abs((weight * np.exp(2j * angle)).sum()) / total
    two = abs((weight * np.exp(4j * angle)).sum()) / total
    return float(one), float(two), float(strength.mean())


def _two_colours(pixels: Array) -> tuple[Array, float, float]:
    """Split pixels into two colours: 1 for the rarer one, its share, and the variance explained."""
    some = pixels[:: max(1, len(pixels) // 1200)]
    centred = some - some.mean(axis=0)
    variance = float(np.einsum("ij,ij->", centred, centred))
    nothing = np.zeros(len(pixels), np.uint8), 0.0, 0.0
    if variance < 1e-6:
        return nothing
    axis = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    labels = centred @ axis > 0
    cut, middle = axis, some.mean(axis=0)
    for _ in range(6):
        if not labels.any() or labels.all():
            return nothing
        low, high = some[~labels].mean(axis=0), some[labels].mean(axis=0)
        cut, middle = high - low, (high + low) / 2
        labels = (some - middle) @ cut > 0
    if not labels.any() or labels.all():
        return nothing
    gaps = (some[side] - some[side].mean(axis=0) for side in (labels, ~labels))
    within = sum(float(np.einsum("ij,ij->", gap, gap)) for gap in gaps)
    every = (pixels - middle) @ cut > 0
    if every.mean() > 0.5:
        every = ~every
    return every.astype(np.uint8), float(every.mean()), 1.0 - within / variance


def _spots(one_tone: Array, area: float) -> tuple[int, float]:
    """Number of compact convex patches of one tone, and the share of that tone that lies in them."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(one_tone, connectivity=4)
    spots, inside, total = 0, 0.0, 0.0
    for number in range(1, count):
        x, y, w, h, size = (int(v) for v in stats[number])
        total += size
        if size < max(5.0, 0.004 * area) or size > 0.2 * area:
            continue
        patch = np.pad((labels[y : y + h, x : x + w] == number).astype(np.uint8), 1)
        contours, _ = cv2.findContours(patch, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        hull = cv2.convexHull(contours[0])
        # Half a pixel of rim on each side, so that small patches are not judged by their steps.
        convex = (cv2.contourArea(contours[0]) + 0.5 * len(contours[0])) / (cv2.contourArea(hull) + 0.5 * len(hull) + 2)
        (_, _), sides, _ = cv2.minAreaRect(contours[0])
        slim = (max(sides) + 1) / (min(sides) + 1)
        if convex > 0.86 and slim < 2.4:
            spots += 1
            inside += size
    return spots, inside / max(total, 1.0)


def pattern_scores(surface: Surface) -> dict[str, float]:
    """How well each canonical pattern fits, 0 to 1."""
    seen = float(np.clip((surface.contrast - 6) / 7, 0, 1))
    sharp = float(np.clip((surface.edges - 1.0) / 2.0, 0, 1))
    # A second tone on a speck of the surface is a highlight or a stalk, no pattern.
    speck = float(surface.two_tone > 0.6) * (1 - float(np.clip((surface.rare_share - 0.02) / 0.04, 0, 1)))
    shown = seen * sharp * (1 - speck)
    two_tone = float(np.clip((surface.two_tone - 0.6) / 0.2, 0, 1))
    stripes, checks = surface.stripes, surface.checks
    several = float(np.clip((surface.spots - 1.5) / 2, 0, 1))
    isotropic = float(np.clip((0.55 - surface.one_way) / 0.2, 0, 1))
    compact = float(np.clip((surface.spotted - 0.45) / 0.3, 0, 1)) * several
    many_hues = float(np.clip((surface.hues - 2.5) / 1.5, 0, 1)) * float(
        np.clip((0.86 - surface.two_tone) / 0.12, 0, 1)
    )
    regular = max(two_tone, float(np.clip((surface.spots - 8) / 8, 0, 1)) * float(surface.two_tone > 0.5))
    dotted = regular * isotropic * compact * (1 - checks)
    # Curls of a paler shade of the ground's own hue: paisley rather than dots.
    curls = 0.8 * compact * float(surface.hues <= 2) * float(np.clip((24 - surface.contrast) / 6, 0, 1))
    swirled = isotropic * (1 - checks) * max(two_tone * (1 - compact), curls * float(surface.rare_share < 0.36))
    scores = {
        "plain": 1 - shown,
        "striped": shown * stripes * (1 - 0.5 * many_hues),
        "dotted": shown * dotted,
        "checkered": shown * checks * two_tone,
        "swirled": shown * swirled * 0.9,
        "mottled": shown * (1 - stripes) * (1 - checks) * (1 - 0.8 * two_tone) * (1 - many_hues),
        "multicoloured": seen * many_hues,
    }
    return {name: float(np.clip(scores[name], 0, 1)) for name in PATTERNS}
