"""Masks, and their outlines in polar form: compare two shapes, holes included, at every rotation at once."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array

RADII = 36
ANGLES = 120
_REACH = 2.3
"""Radii are sampled to this many times the radius of a disc of the same filled area."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A shape, free of place and size.

    Attributes:
        polar: Coverage at radius and angle, shape (RADII, ANGLES), 0 to 1.
        outer: The same with all holes filled.
        profile: Distance of the outer edge in units of the equal-area radius, shape (ANGLES,).
        hole_share: Area of holes over filled area, 0 to 1.
        holes: Number of holes that count.
        solidity: Filled area over convex area, 0 to 1.
        aspect: Long over short side of the tightest rectangle, >= 1.
        fill: Filled area over that rectangle's area, 0 to 1.
        corners: Corners of the simplified outline.
        filled_area: Of the mask, in its own pixels.
    """

    polar: Array
    outer: Array
    profile: Array
    hole_share: float
    holes: int
    solidity: float
    aspect: float
    fill: float
    corners: int
    filled_area: float


def kernel(size: int) -> Array:
    """A round structuring element."""
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)))


def components(mask: Array, least: float) -> list[Array]:
    """Connected patches of at least `least` pixels, largest first, each as a full mask."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    sizes = stats[:, cv2.CC_STAT_AREA]
    order = sorted((k for k in range(1, count) if sizes[k] >= least), key=lambda k: -int(sizes[k]))
    return [labels == k for k in order]


def window(mask: Array, margin: int = 4) -> tuple[slice, slice]:
    """Rows and columns round what a mask shows."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return (
        slice(max(0, int(rows[0]) - margin), int(rows[-1]) + 1 + margin),
        slice(max(0, int(columns[0]) - margin), int(columns[-1]) + 1 + margin),
    )


def placed(part: Array, view: tuple[slice, slice], shape: tuple[int, ...]) -> Array:
    """A window's mask in a full one."""
    full = np.zeros(shape, dtype=bool)
    full[view] = part
    return full


def nearest_in(mask: Array) -> tuple[Array, Array]:
    """Row and column of the pixel of a mask that is nearest to each pixel."""
    _, labels = cv2.distanceTransformWithLabels(
        (~mask).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    rows, columns = np.nonzero(mask)
    place = np.zeros(int(labels.max()) + 1, np.int64)
    place[labels[rows, columns]] = np.arange(len(rows))
    return rows[place[labels]], columns[place[labels]]


def largest_contour(mask: Array) -> Array:
    """The longest outer contour of a mask, shape (N, 1, 2) int32."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(max(contours, key=cv2.contourArea))


def filled(mask: Array) -> Array:
    """The mask with everything inside its outer contours, bool."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    out = np.zeros(mask.shape, np.uint8)
    cv2.drawContours(out, contours, -1, 1, cv2.FILLED)
    return out.astype(bool)


def deep_inside(mask: Array) -> Array:
    """How far each pixel of a mask is from where it ends [px], shape of the mask."""
    padded = np.pad(mask.astype(np.uint8), 1)
    return np.asarray(cv2.distanceTransform(padded, cv2.DIST_L2, 3)[1:-1, 1:-1])


def mean_width(deep: Array) -> float:
    """How wide a form is, by how deep its pixels lie: a strip's width; 4/3 of a disc's radius."""
    return 4 * float(deep[deep > 0].mean())


@dataclass(frozen=True, eq=False)
class _Solid:
    """A mask at a size where one pixel is small against the shape.

    Attributes:
        whole: With everything inside its outer contours, bool; of the picture only what is not empty.
        origin: Where that begins in the picture, x and y.
        area: Of `whole` [px].
        centre: Of `whole`, in the picture.
        scale: Pixels of `whole` per pixel of the mask.
        holes: Number of holes that count.
        hole_area: Their area [px].
        polar: Coverage at radius and angle, as in `Outline`.
    """

    whole: Array
    origin: tuple[int, int]
    area: float
    centre: tuple[float, float]
    scale: float
    holes: int
    hole_area: float
    polar: Array


def polar_form(mask: Array) -> tuple[Array, int]:
    """`polar` and `holes` of `study_outline`, for a third of its work."""
    solid = _solid(mask)
    return solid.polar, solid.holes


def _solid(mask: Array) -> _Solid:
    padded = np.pad(mask.astype(np.uint8), 2)
    scale = float(np.clip(64.0 / max(np.sqrt(padded.sum()), 1.0), 0.5, 4.0))
    grown = cv2.resize(padded.astype(np.float32), None, fx=scale, fy=scale, interpolation=cv2.INTER_LINEAR)
    grown = cv2.GaussianBlur(grown, (0, 0), max(0.6, 0.45 * scale))
    view = window(grown > 0, margin=1)
    grown, origin = grown[view], (view[1].start, view[0].start)
    solid = grown > 0.5
    if not solid.any():
        solid = grown > 0.5 * grown.max()
    whole = filled(solid)
    area = float(whole.sum())
    opened, holes, hole_area = _opened(whole & ~solid, area)
    moments = cv2.moments(whole.astype(np.uint8), True)
    size = moments["m00"]
    centre = ((moments["m10"] + origin[0] * size) / size, (moments["m01"] + origin[1] * size) / size)
    cover = np.where(whole, np.maximum(grown, 0.5), grown)
    cover[opened] = 0.0
    polar = _polar(cover, origin, centre, np.sqrt(area / np.pi))
    return _Solid(whole, origin, area, centre, scale, holes, hole_area, polar.astype(np.float32))


def study_outline(mask: Array) -> Outline:
    """Describe the shape of a mask, shape (h, w), bool, with at least a few pixels set."""
    solid = _solid(mask)
    whole, area = solid.whole, solid.area
    contour = largest_contour(whole) + np.array(solid.origin, np.int32)
    hull_area = max(float(cv2.contourArea(cv2.convexHull(contour))), 1.0)
    (_, _), (w, h), _ = cv2.minAreaRect(contour)
    long_side, short_side = max(w, h, 1.0), max(min(w, h), 1.0)
    simple = cv2.approxPolyDP(contour, 0.035 * cv2.arcLength(contour, True), True)
    outer = _polar(whole.astype(np.float32), solid.origin, solid.centre, np.sqrt(area / np.pi))
    reach = np.where(outer > 0.5, np.arange(1, RADII + 1)[:, None], 0).max(axis=0) * _REACH / RADII
    return Outline(
        solid.polar,
        outer.astype(np.float32),
        reach,
        solid.hole_area / area,
        solid.holes,
        min(1.0, float(cv2.contourArea(contour)) / hull_area),
        long_side / short_side,
        area / (long_side * short_side),
        len(simple),
        area / solid.scale**2,
    )


def _opened(gaps: Array, area: float) -> tuple[Array, int, float]:
    """Gaps that are true holes, not specks; how many there are, and their area."""
    if not gaps.any():
        return gaps, 0, 0.0
    view = window(gaps, margin=0)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(gaps[view].astype(np.uint8), connectivity=4)
    keep = np.zeros(count, dtype=bool)
    keep[1:] = stats[1:, cv2.CC_STAT_AREA] > 0.02 * area
    opened = placed(keep[labels], view, gaps.shape)
    return opened, int(keep.sum()), float(stats[keep, cv2.CC_STAT_AREA].sum())


def _polar(image: Array, origin: tuple[int, int], centre: tuple[float, float], radius: float) -> Array:
    """Sample an image on rings round a centre, shape (RADII, ANGLES); it begins at `origin`, and all round it is nothing."""
    r = (np.arange(RADII) + 0.5) / RADII * _REACH * radius
    t = np.arange(ANGLES) / ANGLES * 2 * np.pi
    # Rounded before the origin is taken off: so it does not matter how much round the shape is empty.
    x = (centre[0] + r[:, None] * np.cos(t)).astype(np.float32) - np.float32(origin[0])
    y = (centre[1] + r[:, None] * np.sin(t)).astype(np.float32) - np.float32(origin[1])
    return np.asarray(cv2.remap(image.astype(np.float32), x, y, cv2.INTER_LINEAR, borderValue=0.0))


_WEIGHT = (np.arange(RADII) + 0.5)[:, None] / RADII


@dataclass(frozen=True, eq=False)
class Forms:
    """Several polar shapes, ready to be compared with one: their spectra and areas."""

    spectra: Array
    total: Array
    squares: Array

    @classmethod
    def of(cls, polars: Array) -> Forms:
        """From polar shapes, shape (N, RADII, ANGLES)."""
        spectra = np.conj(np.fft.rfft(polars * _WEIGHT, axis=-1)).astype(np.complex64)
        return cls(spectra, (polars * _WEIGHT).sum(axis=(1, 2)), (polars**2 * _WEIGHT).sum(axis=(1, 2)))


def overlaps(polar: Array, forms: Forms) -> tuple[Array, Array]:
    """Best intersection over union with each of several shapes over all rotations.

    Args:
        polar: Shape (RADII, ANGLES).
        forms: N shapes.

    Returns:
        IoU, shape (N,), and the rotation from the other to this one [rad, clockwise in the picture], shape (N,).
    """
    mine = np.fft.rfft(polar, axis=-1).astype(np.complex64)
    shared = np.fft.irfft(np.einsum("nra,ra->na", forms.spectra, mine), n=ANGLES, axis=-1)
    total = (polar * _WEIGHT).sum() + forms.total
    # For soft edges: 1 - |A - B|^2 over the union keeps a shape's IoU with itself at 1.
    difference = ((polar**2 * _WEIGHT).sum() + forms.squares)[:, None] - 2 * shared
    union = 0.5 * (total[:, None] + difference)
    scores = 1 - difference / np.maximum(union, 1e-9)
    best = scores.argmax(axis=1)
    return scores[np.arange(len(best)), best], best / ANGLES * 2 * np.pi


def same_outline(one: Outline, other: Outline) -> float:
    """How alike two outlines are at their best rotation, 0 to 1; 1 for the same shape."""
    iou = float(overlaps(one.polar, Forms.of(other.polar[None]))[0][0])
    hole_gap = abs(one.hole_share - other.hole_share)
    solidity_gap = abs(one.solidity - other.solidity)
    score = np.clip((iou - 0.55) / 0.4, 0, 1) * np.clip(1 - _edge_gap(one, other) / 0.35, 0, 1)
    return float(score * np.clip(1 - 1.2 * hole_gap, 0, 1) * np.clip(1 - 1.2 * solidity_gap, 0, 1))


def _edge_gap(one: Outline, other: Outline) -> float:
    """How far two outer edges lie apart at their best rotation [radii]."""
    spectrum = np.conj(np.fft.rfft(other.profile)) * np.fft.rfft(one.profile)
    shared = np.fft.irfft(spectrum, n=ANGLES).max()
    return float(np.sqrt(max((one.profile**2).mean() + (other.profile**2).mean() - 2 * shared / ANGLES, 0.0)))


def same_form(one: Outline, other: Outline) -> float:
    """How alike two outer edges are, holes and sizes left out, 0 to 1: a ring and a disc are both round."""
    return float(
        np.clip(1 - _edge_gap(one, other) / 0.12, 0, 1) * np.clip(1 - 1.5 * abs(one.solidity - other.solidity), 0, 1)
    )
