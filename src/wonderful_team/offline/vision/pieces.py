"""Computed pictures without noise: the pieces that stand out of the table, joined into things.

Every pixel of such a picture says for itself whether it shows table, so nothing needs to be smoothed or closed, and things
that lie a pixel apart stay apart. What belongs together is said by rule: the bars of a frame, the slats of a pallet, the
specks of a texture.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.outlines import filled, largest_contour
from wonderful_team.offline.vision.things import lab_histogram

_GAP = 4
"""Widest gap across which pieces of one texture are joined [working px]."""

_SLATS_GAP = 9
"""Widest gap between long pieces of one thing, such as slats [working px]."""

_ALIKE = 0.5
"""Least likeness of the colours of two pieces of one thing (0 to 1)."""

_MANY = 4
"""From so many compact pieces of one look at their corners on, they are the checks of a texture and no things."""


@dataclass(frozen=True, eq=False)
class _Piece:
    """A connected patch: its label, pixels, colours, and whether it is long or a body of its own."""

    label: int
    size: int
    histogram: Array
    long: bool
    body: bool


def joined_pieces(lab: Array, shows: Array, least: float) -> list[Array]:
    """The patches of a mask, joined where they belong to one thing; each a full mask, largest first.

    Args:
        lab: CIELAB, shape (H, W, 3).
        shows: What stands out of the table, shape (H, W), bool.
        least: Pixels that a thing has at least.
    """
    count, labels, stats, _ = cv2.connectedComponentsWithStats(shows.astype(np.uint8), connectivity=4)
    if count <= 1:
        return []
    pieces = {k: _piece(lab, labels, stats[k], k, least) for k in range(1, count) if stats[k, cv2.CC_STAT_AREA] >= 4}
    owner = _owners(pieces, labels, stats)
    sizes: dict[int, int] = {}
    table = np.zeros(count, np.int32)
    for k, piece in pieces.items():
        table[k] = owner[k]
        sizes[owner[k]] = sizes.get(owner[k], 0) + piece.size
    named = table[labels]
    return [named == k for k in sorted(sizes, key=lambda k: -sizes[k]) if sizes[k] >= least]


def _owners(pieces: dict[int, _Piece], labels: Array, stats: Array) -> dict[int, int]:
    """For each piece the smallest number among those that it belongs together with."""
    links: dict[int, set[int]] = {k: set() for k in pieces}
    checks: dict[int, set[int]] = {}
    for k, piece in pieces.items():
        for reach in (_GAP, _SLATS_GAP) if piece.long else (_GAP,):
            for other in _neighbours(labels, stats[k], k, reach):
                if other not in pieces:
                    continue
                verdict = _belong(piece, pieces[other], reach)
                if verdict:
                    links[k].add(other)
                    links[other].add(k)
                elif verdict is None and reach == _GAP:
                    checks.setdefault(k, set()).add(other)
    for cluster in _groups(checks):
        if len(cluster) >= _MANY:
            links[cluster[0]].update(cluster[1:])
            for k in cluster[1:]:
                links[k].add(cluster[0])
    return {k: min(group) for group in _groups(links) for k in group}


def _piece(lab: Array, labels: Array, stats: Array, label: int, least: float) -> _Piece:
    x, y, w, h, size = (int(v) for v in stats)
    mask = labels[y : y + h, x : x + w] == label
    histogram = lab_histogram(lab[y : y + h, x : x + w][mask])
    if size < least:
        return _Piece(label, size, histogram, False, False)
    whole = filled(mask)
    contour = largest_contour(whole)
    hull = max(float(cv2.contourArea(cv2.convexHull(contour))), 1.0)
    solid = (float(cv2.contourArea(contour)) + 0.5 * len(contour)) / (hull + 0.5 * len(contour))
    _, sides, _ = cv2.minAreaRect(contour)
    aspect = (max(sides) + 1) / (min(sides) + 1)
    framed = mask.sum() < 0.85 * whole.sum()
    return _Piece(label, size, histogram, aspect > 2.5, framed or (solid > 0.85 and aspect < 2.0))


def _neighbours(labels: Array, stats: Array, label: int, reach: int) -> list[int]:
    """Labels of the pieces within `reach` of one."""
    x, y, w, h, _ = (int(v) for v in stats)
    view = np.s_[max(0, y - reach) : y + h + reach, max(0, x - reach) : x + w + reach]
    near = cv2.dilate((labels[view] == label).astype(np.uint8), np.ones((2 * reach + 1, 2 * reach + 1), np.uint8)) > 0
    return [int(k) for k in np.unique(labels[view][near]) if k not in (0, label)]


def _belong(one: _Piece, other: _Piece, reach: int) -> bool | None:
    """Whether two pieces near each other are parts of one thing; None when only their number can tell."""
    alike = float(one.histogram @ other.histogram) > _ALIKE
    if reach > _GAP:
        return alike and one.long and other.long
    if one.body and other.body:
        return None if alike else False
    return alike


def _groups(links: dict[int, set[int]]) -> list[list[int]]:
    """Groups of what is linked, directly or through others."""
    out, seen = [], set()
    for start in links:
        if start in seen:
            continue
        group, todo = [], [start]
        while todo:
            k = todo.pop()
            if k in seen:
                continue
            seen.add(k)
            group.append(k)
            todo += [other for other in links.get(k, ()) if other not in seen]
        out.append(group)
    return out
