"""A plate that lies on something only a little lower, such as a lid on its box: flat on it, askew in it, or over its edge."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.fitting import least_squares
from wonderful_team.offline.vision.outlines import components, filled, kernel, nearest_in
from wonderful_team.offline.vision.things import lab_histogram

STEP_M, OTHER_LOOK = 0.005, 0.3
"""A plate stands at least so much higher than what is round it [m], and is at most so much alike in colours (0 to 1)."""

EVEN_LAB = 9.0
"""A plate is of one colour: so far its pixels differ from the middle of its highest ones in any channel (CIELAB)."""

_CONVEX, _ONE_HUE = 0.93, 0.94
"""Share of its hull that a thing fills once what the plate hides of it counts, and cosine of the difference of hues up to which a low
part within it is its own."""


def uncovered(lab: Array, pieces: Sequence[Array], height_m: Array, least: float) -> list[Array]:
    """Pieces of one raised patch, with a plate and what it lies on told apart; what lies under it is whole again.

    Args:
        lab: CIELAB, shape (H, W, 3).
        pieces: Masks, shape (H, W), bool, which do not overlap.
        height_m: Above the table, shape (H, W) [m].
        least: Smallest thing that counts [px].

    Returns:
        Masks; that of what a plate lies on also holds what the plate hides of it where the plate reaches beyond its edge.
    """
    height = np.nan_to_num(height_m).astype(np.float32)
    out, wholes = list[Array](), list[Array]()
    for piece in pieces:
        plate, *rests = _plate_and_rests(lab, piece, height, least)
        out.append(plate)
        for rest in rests:
            whole = rest | (plate & _hull(rest))
            hidden = (plate & ~filled(rest)).any() and whole.sum() > rest.sum() and _is_convex(filled(whole))
            (wholes if hidden else out).append(whole if hidden else rest)
    return [*_without_insides(lab, out, wholes, height), *wholes]


def _plate_and_rests(lab: Array, piece: Array, height: Array, least: float) -> list[Array]:
    """An even plate of one colour, and what it lies on, level, of other colours and a little lower where they meet; else the piece alone.

    What else the piece holds, which the plate only touches, comes after these.
    """
    if piece.sum() < 2 * least:
        return [piece]
    height = cv2.medianBlur(np.where(piece, height, 0.0).astype(np.float32), 5)
    top = piece & (height > np.percentile(height[piece], 75) - STEP_M / 2)
    alike = piece & (np.abs(lab - np.median(lab[top], axis=0)).max(axis=2) < EVEN_LAB)
    alike = cv2.morphologyEx(alike.astype(np.uint8), cv2.MORPH_OPEN, kernel(3)) > 0
    found = components(alike, least)
    if not found:
        return [piece]
    plate = piece & filled(found[0])
    edge = cv2.dilate(plate.astype(np.uint8), kernel(5)) > 0
    clear = piece & ~edge
    under, *others = _by_looks(lab, components(clear, least / 2)) or [clear]
    if under.sum() < least or lab_histogram(lab[plate]) @ lab_histogram(lab[under]) > OTHER_LOOK:
        return [piece]
    # The walls inside a box that stands open by a gap count with its rim.
    low, level, high = np.percentile(height[under], (25, 50, 75))
    border = plate & (cv2.dilate(under.astype(np.uint8), kernel(7)) > 0)
    if high - low >= STEP_M / 2 or not border.any() or _unevenness(height, plate) >= STEP_M / 2:
        return [piece]
    if float(np.percentile(height[border], 75)) - level < STEP_M:
        return [piece]
    # Pixels that the plate's edge blurs go to what is nearest.
    marks = np.zeros(piece.shape, np.int32)
    for number, part in enumerate((plate, under, *others), start=1):
        marks[part] = number
    nearest = marks[nearest_in(marks > 0)]
    return [piece & (nearest == number) for number in range(1, len(others) + 3)]


def _by_looks(lab: Array, parts: Sequence[Array]) -> list[Array]:
    """The parts, those that look like the first one in one with it, and each of the others."""
    if not parts:
        return []
    look = lab_histogram(lab[parts[0]])
    own = [float(look @ lab_histogram(lab[part])) > OTHER_LOOK for part in parts]
    first = np.any([part for part, same in zip(parts, own, strict=True) if same], axis=0)
    return [first, *(part for part, same in zip(parts, own, strict=True) if not same)]


def _unevenness(height: Array, plate: Array) -> float:
    """How far the heights on a plate spread about a plane, which may slope [m]: between a tenth and nine tenths of them."""
    inner = cv2.erode(plate.astype(np.uint8), kernel(5)) > 0
    rows, columns = np.nonzero(inner if inner.sum() > 20 else plate)
    terms = np.stack([np.ones(len(rows)), rows, columns], axis=1).astype(np.float64)
    values = height[rows, columns].astype(np.float64)
    low, high = np.percentile(values - terms @ least_squares(terms, values), (10, 90))
    return float(high - low)


def _hull(mask: Array) -> Array:
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = np.zeros(mask.shape, np.uint8)
    cv2.fillConvexPoly(hull, cv2.convexHull(np.concatenate(contours)), 1)
    return np.asarray(hull > 0)


def _is_convex(mask: Array) -> bool:
    return float(mask.sum()) > _CONVEX * float(_hull(mask).sum())


def _without_insides(lab: Array, pieces: list[Array], wholes: list[Array], height: Array) -> list[Array]:
    """The pieces but for those that are low parts within one of `wholes` and of its hue: what still shows of its inside.

    They are added to it in `wholes`.
    """
    left, taken = [], np.any(pieces, axis=0)
    for piece in pieces:
        for k, whole in enumerate(wholes):
            inside = (piece & filled(whole)).sum() > 0.9 * piece.sum()
            low = float(np.median(height[piece])) < float(np.median(height[whole])) - STEP_M
            if inside and low and _one_hue(lab[piece], lab[whole & ~taken]):
                wholes[k] = whole | piece
                break
        else:
            left.append(piece)
    return left


def _one_hue(one: Array, other: Array) -> bool:
    """Whether two surfaces (N, 3) in CIELAB are shades of one colour."""
    a, b = (np.median(pixels, axis=0)[1:] for pixels in (one, other))
    return float(a @ b) > _ONE_HUE * float(np.linalg.norm(a)) * float(np.linalg.norm(b))
