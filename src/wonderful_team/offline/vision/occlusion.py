"""Parting the things that touch or lie on each other, by how their colours are spread.

The colours of one texture are spread over the whole thing; those of a thing that lies on it show in one place only.
"""

from __future__ import annotations

from typing import TypeAlias

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.outlines import (
    components,
    filled,
    kernel,
    largest_contour,
    nearest_in,
    placed,
    window,
)

_COLOURS = 6
"""Main colours that a patch is parted into at most."""

_ONE_COLOUR = 15.0
"""How far centres of one colour lie apart at most [CIELAB, lightness counts 0.7]."""

_SPREAD = 0.55
"""Share of the patch's extent from which a colour belongs to all of it."""

_LEAST_TOP = 600.0
"""Pixels that a thing lying on another has at least [working px squared]; spots of a texture are smaller."""

_LEAST_BESIDE = 200.0
"""Pixels that a thing touching another has at least [working px squared]."""

_BRIDGE = 9
"""Gap across which parts of one colour count as one place [working px]."""

_BEYOND = 4
"""Pixels by which a bar sticks out on both sides of what it lies across, at least [working px]."""

_NECK = 0.75
"""Depth of the neck between two bodies, as a share of the deepest place in them, up to which they are two things."""

_STEP = 18.0
"""Least mean colour step across the border of two things [CIELAB units]: colours of a rainbow run into each other."""

_Parted: TypeAlias = tuple[Array, Array, Array]
"""What shows of the thing below, the thing on top, and what that one hides of it."""


def part_overlaid(lab: Array, patch: Array, least: float) -> list[Array]:
    """The things in one patch, each a full mask: what lies below first; the patch alone when it is one thing.

    Args:
        lab: CIELAB, shape (H, W, 3).
        patch: One connected patch of things, shape (H, W), bool.
        least: Pixels that a thing has at least.
    """
    view = window(patch)
    inside, colours = patch[view], lab[view]
    parts = _parts(colours, inside)
    out: list[Array] = []
    for part in parts:
        out += _at_neck(part, least)
    if len(out) == 1:
        return [patch]
    return [placed(part, view, patch.shape) for part in out]


def _parts(lab: Array, inside: Array, depth: int = 0) -> list[Array]:
    labels = _labels(lab, inside)
    count = int(labels.max()) + 1
    if depth > 2:  # noqa: PLR2004  three things on each other at most
        return [inside]
    extent = _hull_area(inside)
    found = _top(lab, labels, count, inside, extent) or _side_by_side(lab, labels, count, inside)
    found = found or _bar_across(inside)
    if found is None:
        return [inside]
    rest, above, hidden = found
    below = _parts(lab, rest, depth + 1)
    if len(below) == 1:
        below = [rest | hidden]
    return [*below, *_parts(lab, above, depth + 1)]


def _labels(lab: Array, inside: Array) -> Array:
    """Number of the main colour of each pixel, -1 outside; shades of one colour share a number."""
    pixels = lab[inside].astype(np.float32) * np.array([0.7, 1.0, 1.0], np.float32)
    out = np.full(inside.shape, -1, np.int32)
    count = min(_COLOURS, max(1, len(pixels) // 60))
    # An enlargement mixes a little of the table into the rim: it takes the colour of what is next to it.
    core = cv2.erode(inside.astype(np.uint8), np.ones((3, 3), np.uint8), iterations=2) > 0
    core = core if core.sum() > 0.3 * inside.sum() else inside
    inner = pixels[core[inside]]
    sample = inner[:: max(1, len(inner) // 3000)]
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 12, 0.5)
    cv2.setRNGSeed(7)
    _, _, centres = cv2.kmeans(sample, count, None, criteria, 4, cv2.KMEANS_PP_CENTERS)
    number = ((inner[:, None] - centres[None]) ** 2).sum(axis=-1).argmin(axis=1)
    names = _merged(centres, np.bincount(number, minlength=count))
    out[core] = names[number]
    if core is not inside:
        out[inside] = out[nearest_in(core)][inside]
    return out


def _merged(centres: Array, counts: Array) -> Array:
    """One number, from 0 on, per group of centres that are about the same colour."""
    names = np.arange(len(centres))
    for a in np.argsort(-counts):
        for b in range(len(centres)):
            if names[b] != names[a] and np.linalg.norm(centres[a] - centres[b]) < _ONE_COLOUR:
                names[names == names[b]] = names[a]
    return np.asarray(np.unique(names, return_inverse=True)[1])


def _hull_area(mask: Array) -> float:
    points = cv2.findNonZero(mask.astype(np.uint8))
    return float(cv2.contourArea(cv2.convexHull(points))) if points is not None and len(points) > 2 else 0.0


def _bridged(mask: Array) -> Array:
    padded = np.pad(mask.astype(np.uint8), _BRIDGE)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel(_BRIDGE))
    return np.asarray(closed[_BRIDGE:-_BRIDGE, _BRIDGE:-_BRIDGE] > 0)


def _top(lab: Array, labels: Array, count: int, inside: Array, extent: float) -> _Parted | None:
    """A thing that lies on another; None when there is none."""
    local = [k for k in range(count) if _hull_area(labels == k) < _SPREAD * extent]
    if not local or len(local) == count:
        return None
    own = np.isin(labels, local)
    places = components(_bridged(own), 1.0)
    biggest = places[0] & own
    if biggest.sum() < 0.9 * own.sum() or _hull_area(biggest) > _SPREAD * extent:
        return None
    top = _completed(places[0] & inside, inside)
    if top.sum() < _LEAST_TOP or top.sum() > 0.7 * inside.sum() or not _sharp(lab, top, inside):
        return None
    rest = inside & ~top
    if rest.sum() < _LEAST_TOP or not _rests_on(top, rest, inside):
        return None
    return rest, top, _closed_over(rest, top) & top


def _rests_on(top: Array, rest: Array, inside: Array) -> bool:
    """Whether a part lies within the rest, or sticks out of it: a stripe or spot of a texture does neither."""
    rim = (cv2.dilate(top.astype(np.uint8), kernel(3)) > 0) & ~top
    if (rim & ~inside).sum() < 0.2 * rim.sum():
        return True
    return bool((top & ~_hull(rest)).sum() > 0.05 * top.sum())


def _completed(top: Array, inside: Array) -> Array:
    """A bar whose texture shares colours with what is below is completed to its rectangle; other things stay."""
    (cx, cy), (w, h), angle = cv2.minAreaRect(largest_contour(top))
    long, short = max(w, h) + 1, min(w, h) + 1
    if long < 2.5 * short or top.sum() < 0.55 * long * short:
        return filled(top) & inside
    box = np.zeros(top.shape, np.uint8)
    corners = cv2.boxPoints(((cx, cy), (w, h), angle))
    cv2.fillConvexPoly(box, np.round(corners).astype(np.int32), 1)
    return np.asarray((box > 0) & inside)


def _closed_over(rest: Array, top: Array) -> Array:
    """Where what is below goes on under the thing on top: inside its outline, or straight across a bar."""
    covered = filled(rest)
    if (covered & top).sum() > 0.8 * top.sum() and not (filled(rest | top) & ~rest & ~top).any():
        return covered
    across = cv2.distanceTransform(np.pad(top.astype(np.uint8), 1), cv2.DIST_L2, 3).max()
    size = int(2 * across + 5) | 1
    padded = np.pad(rest.astype(np.uint8), size)
    line = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, np.ones((size, 1), np.uint8))
    line |= cv2.morphologyEx(padded, cv2.MORPH_CLOSE, np.ones((1, size), np.uint8))
    return np.asarray(line[size:-size, size:-size] > 0)


def _sharp(lab: Array, one: Array, inside: Array) -> bool:
    """Whether the colour changes abruptly where a part borders on the rest."""
    rest = inside & ~one
    steps = []
    for axis in (0, 1):
        a, b = (np.s_[:-1], np.s_[1:]) if axis == 0 else (np.s_[:, :-1], np.s_[:, 1:])
        border = (one[a] & rest[b]) | (rest[a] & one[b])
        steps.append(np.sqrt(((lab[a][border] - lab[b][border]) ** 2).sum(axis=-1)))
    every = np.concatenate(steps)
    return len(every) > 0 and float(np.median(every)) > _STEP


def _side_by_side(lab: Array, labels: Array, count: int, inside: Array) -> _Parted | None:
    """Two things that touch: two colours in different places; every other patch goes to the one that it borders on."""
    sizes = [int((labels == k).sum()) for k in range(count)]
    hulls = [_hull(labels == k) for k in range(count)]
    first = int(np.argmax(sizes))
    apart = [
        k for k in range(count)
        if k != first and sizes[k] > max(_LEAST_BESIDE, 0.1 * inside.sum())
        and (hulls[k] & hulls[first]).sum() < 0.2 * min(hulls[k].sum(), hulls[first].sum())
    ]  # fmt: skip
    if not apart:
        return None
    second = max(apart, key=lambda k: sizes[k])
    markers = np.full(inside.shape, 0, np.int32)
    markers[labels == first], markers[labels == second] = 1, 2
    for other in (k for k in range(count) if k not in (first, second)):
        for place in components(labels == other, 1.0):
            rim = cv2.dilate(place.astype(np.uint8), kernel(5)) > 0
            near = [int((markers[rim] == side).sum()) for side in (1, 2)]
            markers[place] = 1 if near[0] >= near[1] else 2
    one, two = inside & (markers == 1), inside & (markers == 2)
    if min(one.sum(), two.sum()) < _LEAST_BESIDE or not _sharp(lab, two, inside):
        return None
    nothing = np.zeros(inside.shape, dtype=bool)
    return (one, two, nothing) if _hull_area(one) >= _hull_area(two) else (two, one, nothing)


def _bar_across(inside: Array) -> _Parted | None:
    """An upright or level bar that lies across a thing and sticks out on both sides, told by its outline alone."""
    for turned in (inside, inside.T):
        band = _sticking_out(turned)
        if band is None:
            continue
        top = np.zeros(turned.shape, dtype=bool)
        top[band] = turned[band]
        rest = turned & ~top
        across = [part for part in components(rest, _LEAST_BESIDE) if part.any()]
        if len(across) < 3 or top.sum() < _LEAST_TOP:  # noqa: PLR2004  what is below goes on past it in several places
            continue
        hidden = _closed_over(rest, top) & top
        return (rest, top, hidden) if turned is inside else (rest.T, top.T, hidden.T)
    return None


def _sticking_out(mask: Array) -> slice | None:
    """The rows of an unbroken bar that reaches further to both sides than all other rows; None without one."""
    rows = np.flatnonzero(mask.any(axis=1))
    left, right = mask[rows].argmax(axis=1), mask.shape[1] - mask[rows, ::-1].argmax(axis=1)
    wide = right - left
    unbroken = mask[rows].sum(axis=1) >= 0.97 * wide
    bar = rows[unbroken & (wide >= 0.97 * wide.max())]
    if not len(bar) or bar[-1] - bar[0] + 1 != len(bar) or len(bar) > 0.3 * len(rows):
        return None
    others = (rows < bar[0] - 1) | (rows > bar[-1] + 1)
    if not (rows < bar[0] - 1).any() or not (rows > bar[-1] + 1).any():
        return None
    far = min(left[others].min() - left.min(), right.max() - right[others].max())
    return slice(int(bar[0]), int(bar[-1]) + 1) if _BEYOND <= far <= 0.15 * wide.max() else None


def _hull(mask: Array) -> Array:
    out = np.zeros(mask.shape, np.uint8)
    points = cv2.findNonZero(mask.astype(np.uint8))
    if points is not None and len(points) > 2:
        cv2.fillConvexPoly(out, cv2.convexHull(points), 1)
    return out > 0


def _at_neck(part: Array, least: float) -> list[Array]:
    """Two or more like compact bodies that touch at a corner or edge, parted at the neck; else the part itself."""
    whole = filled(part)
    deep = cv2.distanceTransform(np.pad(whole.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    for share in (0.5, 0.6, 0.7, 0.8):
        cores = components(deep > share * deep.max(), 1.0)
        if 2 <= len(cores) <= 4:
            break
    else:
        return [part]
    markers = np.zeros(part.shape, np.int32)
    for number, core in enumerate(cores, start=1):
        markers[core] = number
    owner = markers[nearest_in(markers > 0)]
    bodies = [whole & (owner == number) for number in range(1, len(cores) + 1)]
    sizes = [float(body.sum()) for body in bodies]
    if min(sizes) < max(least, 0.6 * max(sizes)) or not all(_compact(body) for body in bodies):
        return [part]
    rim = np.any([(cv2.dilate(body.astype(np.uint8), kernel(3)) > 0) & whole & ~body for body in bodies], axis=0)
    if deep[rim].max(initial=0.0) > _NECK * deep.max():
        return [part]
    return [body & part for body in bodies]


def _compact(body: Array) -> bool:
    """Nearly square or round and without notches."""
    contour = largest_contour(body)
    hull = float(cv2.contourArea(cv2.convexHull(contour)))
    _, (w, h), _ = cv2.minAreaRect(contour)
    rim = 0.5 * len(contour)
    full = body.sum() / ((w + 1) * (h + 1))
    return (
        (float(cv2.contourArea(contour)) + rim) > 0.82 * (hull + rim)
        and max(w, h) + 1 < 1.35 * (min(w, h) + 1)
        and full > 0.68
    )
