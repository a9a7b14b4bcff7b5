"""Parting one patch that stands out into the things that touch or lie on each other in it, by colour."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.outlines import filled

_SHARP = 5.0
"""Least mean colour step across the border between two things [CIELAB units per working pixel]; shading is softer."""


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


def split_by_colour(lab: Array, patch: Array, least: float) -> list[Array]:
    """Split a patch into a thing lying on a plain area, or plain things that touch; else it stays whole.

    Textured things must not fall apart: a part counts only when it is plain, compact and large enough.
    """
    view = window(patch)
    inside = patch[view]
    small = cv2.GaussianBlur(lab[view], (0, 0), 0.8)
    total = float(inside.sum())
    lying = _lying_on_plain(small, inside, least)
    if lying:
        return [placed(part, view, patch.shape) for part in lying]
    regions = [region for region in _plain_regions(small, inside) if region.sum() >= max(least, 0.035 * total)]
    if not 2 <= len(regions) <= 5 or sum(region.sum() for region in regions) < 0.82 * total:
        return [patch]
    parts = _stack(regions, inside)
    if parts is None:
        return [patch]
    return [placed(part, view, patch.shape) for part in parts]


def _lying_on_plain(lab: Array, inside: Array, least: float) -> list[Array]:
    """A plain ground and the one to three compact things on it, ground first; [] when it is nothing of the kind."""
    pixels = lab[inside]
    total = float(inside.sum())
    ground = _mode(pixels)
    near = np.abs(pixels - ground).max(axis=1) < 9
    spread = np.maximum(1.4826 * np.median(np.abs(pixels[near] - ground), axis=0), (1.5, 1.2, 1.2)) if near.any() else 0
    gap = (np.abs(lab - ground) - 3 * spread) / np.array([1.3, 1.0, 1.0])
    differs = (np.sqrt((np.maximum(gap, 0) ** 2).sum(axis=-1)) > 6) & inside
    differs = cv2.morphologyEx(differs.astype(np.uint8), cv2.MORPH_OPEN, kernel(5)) > 0
    tops = [filled(part) for part in components(differs, max(least, 0.02 * total))]
    if not 1 <= len(tops) <= 3 or not all(_is_thing(top, lab, inside, total, ground) for top in tops):
        return []
    covered = np.any([cv2.dilate(top.astype(np.uint8), kernel(5)) > 0 for top in tops], axis=0)
    rest = inside & ~covered
    if rest.sum() < 0.35 * total or (differs & rest).sum() > 0.08 * rest.sum():
        return []
    return [filled(inside & (rest | covered)), *(top & inside for top in tops)]


def _is_thing(top: Array, lab: Array, inside: Array, total: float, ground: Array) -> bool:
    """Whether a patch of another colour is a thing of its own: compact, sharply bordered and no highlight."""
    share = top.sum() / total
    if share > 0.5 or _solidity(top) < 0.79:
        return False
    colour = np.median(lab[top], axis=0)
    paler = np.hypot(*colour[1:]) < np.hypot(*ground[1:]) and colour[0] > ground[0] + 8
    if paler and share < 0.15:
        return False
    rim = (cv2.dilate(top.astype(np.uint8), kernel(3)) > 0) & ~(cv2.erode(top.astype(np.uint8), kernel(3)) > 0) & inside
    gx, gy = (cv2.Sobel(lab, cv2.CV_32F, *axis, scale=0.125)[rim] for axis in ((1, 0), (0, 1)))
    return bool(np.median(np.sqrt((gx**2 + gy**2).sum(axis=1))) > _SHARP)


def _mode(pixels: Array) -> Array:
    """The colour that most pixels (N, 3) are near."""
    bins = np.round(pixels / 6).astype(int) + (0, 32, 32)
    counts = np.bincount(bins @ np.array((4096, 64, 1)), minlength=1)
    code = int(counts.argmax())
    best = np.array((code // 4096, code // 64 % 64, code % 64))
    return np.asarray(np.median(pixels[(np.abs(bins - best) <= 1).all(axis=1)], axis=0))


def _plain_regions(lab: Array, inside: Array) -> list[Array]:
    """Patches of one colour inside a mask, largest first; shading does not part them."""
    pixels = lab[inside].astype(np.float32) * np.array([0.5, 1.0, 1.0], np.float32)
    count = min(4, max(2, len(pixels) // 60))
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 15, 0.5)
    cv2.setRNGSeed(7)
    _, labels, centres = cv2.kmeans(pixels, count, None, criteria, 1, cv2.KMEANS_PP_CENTERS)
    merged = _merge_centres(centres, np.bincount(labels.ravel(), minlength=count))
    image = np.full(inside.shape, -1, np.int32)
    image[inside] = merged[labels.ravel()]
    regions = []
    for value in np.unique(merged):
        part = cv2.morphologyEx((image == value).astype(np.uint8), cv2.MORPH_OPEN, kernel(5))
        regions += components(part > 0, 12.0)
    return sorted(regions, key=lambda region: -int(region.sum()))


def _merge_centres(centres: Array, counts: Array) -> Array:
    """One number per group of cluster centres that are the same colour but for shading."""
    names = np.arange(len(centres))
    for a in np.argsort(-counts):
        for b in range(len(centres)):
            gap = np.abs(centres[a] - centres[b])
            if names[b] != names[a] and gap[0] < 9 and np.hypot(gap[1], gap[2]) < 14:
                names[names == names[b]] = names[a]
    return names


def _stack(regions: list[Array], inside: Array) -> list[Array] | None:
    """Plain regions as things: those enclosed by another lie on it, those side by side touch. None: a texture."""
    hulls = [_solidity(filled(region)) for region in regions]
    if min(hulls) < 0.72:
        return None
    below = filled(regions[0])
    on_top = [region for region in regions[1:] if (region & below).sum() > 0.7 * region.sum()]
    beside = [region for region in regions[1:] if (region & below).sum() <= 0.7 * region.sum()]
    if len(on_top) > 2 or len(beside) > 2:
        return None
    if any(region.sum() < 0.12 * inside.sum() for region in beside) and not on_top:
        return None
    parts = [filled(region) for region in on_top + beside]
    base = regions[0].copy()
    for region in on_top:
        base |= cv2.dilate(filled(region).astype(np.uint8), kernel(5)) > 0
    return [filled(base & inside), *parts]


def _solidity(mask: Array) -> float:
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    contour = max(contours, key=cv2.contourArea)
    hull = float(cv2.contourArea(cv2.convexHull(contour)))
    return float(cv2.contourArea(contour)) / hull if hull > 0 else 0.0
