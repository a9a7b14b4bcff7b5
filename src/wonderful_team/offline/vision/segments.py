"""From what stands out of the table to single things: joining their parts, splitting what touches or overlaps."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.covered import uncovered
from wonderful_team.offline.vision.occlusion import part_overlaid
from wonderful_team.offline.vision.outlines import (
    components,
    filled,
    kernel,
    largest_contour,
    nearest_in,
    placed,
    window,
)
from wonderful_team.offline.vision.pieces import joined_pieces
from wonderful_team.offline.vision.table import Table
from wonderful_team.offline.vision.things import lab_histogram

LEAST_SHARE = 0.0006
"""Smallest thing that counts, as a share of the picture's valid area."""

_JUMP_M = 0.010
"""A step in height that separates two things [m]."""

_CRESCENT, _CIRCLE, _MOSTLY = (0.5, 0.85), 0.7, 0.5
"""Shares of its hull that a round thing fills of which another hides a part, of the circle round it that its hull fills at least, and of
that other one that lie within its hull."""

_HOLLOW, _TOUCHES = 1.5, 0.9
"""A ring's outline holds at least so many times its own area; two rings that are steps of a wall touch along this share."""

SAME_PAPER = 9.0
"""Flat patches whose median colours differ by no more than this in any channel may be parts of one thing (CIELAB)."""


@dataclass(frozen=True, eq=False)
class Segment:
    """One thing's pixels: a full working mask (H, W), bool, and whether it lies flat (None: unknown).

    Attributes:
        shows: Where table shows through its gaps, this is False, shape (H, W), bool; None when that is not known.
    """

    mask: Array
    flat: bool | None
    shows: Array | None = None


def find_segments(lab: Array, valid: Array, table: Table) -> list[Segment]:
    """Split what stands out into things.

    Args:
        lab: CIELAB, shape (H, W, 3).
        valid: Pixels that show the view, shape (H, W), bool.
        table: The table of the same picture.
    """
    least = max(24.0, LEAST_SHARE * float(valid.sum()))
    if table.raised is not None:
        found = _with_height(lab, table, least)
    elif table.clean:
        found = []
        for patch in joined_pieces(lab, table.stands_out, least):
            found += [
                Segment(part, None, table.stands_out)
                for part in part_overlaid(lab, fill_specks(close_ring(patch)), least)
            ]
    else:
        found = []
        for patch in _patches(table.stands_out, least):
            found += [Segment(part, None) for part in part_overlaid(lab, patch, least)]
    return [segment for segment in found if not _beyond_table(segment.mask, valid)]


def _patches(mask: Array, least: float, *, fill: bool = True) -> list[Array]:
    """Cleaned connected patches, true holes kept; gaps of a texture are filled where nothing measured them."""
    tidy = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, kernel(3))
    tidy = cv2.morphologyEx(tidy, cv2.MORPH_OPEN, kernel(3))
    return [fill_specks(patch) if fill else patch for patch in components(tidy > 0, least)]


def fill_specks(mask: Array) -> Array:
    """Fill gaps inside a mask that belong to its texture: small ones, and many alike ones."""
    view = window(mask)
    whole = filled(mask[view])
    gaps = whole & ~mask[view]
    count, labels, stats, _ = cv2.connectedComponentsWithStats(gaps.astype(np.uint8), connectivity=4)
    if count <= 1:
        return mask
    area = float(whole.sum())
    sizes = stats[1:, cv2.CC_STAT_AREA].astype(float)
    small = sizes < 0.022 * area
    middling = (sizes >= 0.006 * area) & (sizes < 0.12 * area)
    if middling.sum() >= 4:
        small |= middling
    keep = np.concatenate([[False], small])
    return placed(mask[view] | keep[labels], view, mask.shape)


def close_ring(mask: Array) -> Array:
    """A frame whose bars do not quite meet, closed; any other mask as it is."""
    view = window(mask, margin=6)
    inside = mask[view]
    closed = cv2.morphologyEx(inside.astype(np.uint8), cv2.MORPH_CLOSE, kernel(5)) > 0
    if filled(closed).sum() < 1.3 * filled(inside).sum():
        return mask
    return placed(closed, view, mask.shape)


def _beyond_table(mask: Array, valid: Array) -> bool:
    """Whether a patch is the room round the table: large and reaching two or more sides of the view."""
    rows, columns = np.flatnonzero(valid.any(axis=1)), np.flatnonzero(valid.any(axis=0))
    y0, y1, x0, x1 = rows[0], rows[-1], columns[0], columns[-1]
    sides = [
        mask[y0 : y0 + 2].any(),
        mask[y1 - 1 : y1 + 1].any(),
        mask[:, x0 : x0 + 2].any(),
        mask[:, x1 - 1 : x1 + 1].any(),
    ]
    share = mask.sum() / valid.sum()
    return bool((sum(sides) >= 2 and share > 0.12) or (sum(sides) >= 1 and share > 0.35))


def _with_height(lab: Array, table: Table, least: float) -> list[Segment]:
    """Raised things by height, papers by colour; a paper also covers what lies on it."""
    assert table.raised is not None
    assert table.height_m is not None
    rim = cv2.dilate(table.raised.astype(np.uint8), kernel(3)) > 0
    solid = table.raised | (table.stands_out & rim)
    raised: list[Array] = []
    for patch in _patches(solid, least, fill=False):
        view = window(patch)
        pieces = _split_by_height(lab[view], patch[view], table.height_m[view], least)
        pieces = uncovered(lab[view], pieces, table.height_m[view], least)
        raised += [patch] if len(pieces) == 1 else [placed(piece, view, patch.shape) for piece in pieces]
    raised = [_behind(piece, raised, table.height_m) for piece in raised]
    wide = cv2.dilate(table.raised.astype(np.uint8), kernel(5)) > 0
    papers: list[Array] = []
    wholes = [filled(thing) for thing in raised]
    for patch in _patches(table.stands_out & ~wide, least):
        round_it = [k for k, whole in enumerate(wholes) if (patch & whole).sum() > 0.8 * patch.sum()]
        # What shows through a ring that lies in a bowl is the bowl's.
        floor = lab_histogram(lab[patch])
        host = max(round_it, key=lambda k: float(floor @ lab_histogram(lab[raised[k]])), default=None)
        if host is not None and not (patch & raised[host]).sum() > 0.5 * patch.sum():
            # The floor inside walls belongs to the container.
            joined = cv2.morphologyEx((raised[host] | patch).astype(np.uint8), cv2.MORPH_CLOSE, kernel(7)) > 0
            raised[host] = fill_specks(joined & filled(raised[host]))
            continue
        grown = cv2.dilate(patch.astype(np.uint8), kernel(5)) > 0
        papers.append(patch | (grown & table.stands_out & ~table.raised))
    papers = _join_papers(lab, [part for paper in papers for part in part_overlaid(lab, paper, least)], raised)
    return [*(Segment(mask, False) for mask in raised), *(Segment(_under(paper, raised), True) for paper in papers)]


def _behind(piece: Array, raised: list[Array], height_m: Array) -> Array:
    """A raised thing with what a higher one on it hides of its rim, where both are seen aslant: the shoulder of a bottle behind its neck."""
    contour = largest_contour(piece)
    hull = np.zeros(piece.shape, np.uint8)
    cv2.fillConvexPoly(hull, cv2.convexHull(contour), 1)
    solid = float(piece.sum()) / max(float(hull.sum()), 1.0)
    _, radius = cv2.minEnclosingCircle(contour)
    if not _CRESCENT[0] < solid < _CRESCENT[1] or hull.sum() < _CIRCLE * np.pi * radius**2:
        return piece
    level, near = float(np.nanmedian(height_m[piece])), cv2.dilate(piece.astype(np.uint8), kernel(5)) > 0
    for other in raised:
        if other is piece or not (near & other).any() or (filled(piece) & other).sum() > _MOSTLY * other.sum():
            continue
        inside = other & (hull > 0)
        if inside.sum() > _MOSTLY * other.sum() and float(np.nanmedian(height_m[other])) > level + _JUMP_M:
            return np.asarray(cv2.morphologyEx((piece | inside).astype(np.uint8), cv2.MORPH_CLOSE, kernel(5)) > 0)
    return piece


def _under(paper: Array, raised: list[Array]) -> Array:
    """A paper with the places that raised things hide filled in, where they lie within its convex outline."""
    whole = filled(paper)
    contours, _ = cv2.findContours(paper.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = np.zeros(paper.shape, np.uint8)
    cv2.fillConvexPoly(hull, cv2.convexHull(np.concatenate(contours)), 1)
    for thing in raised:
        if (thing & (hull > 0)).any():
            whole |= (cv2.dilate(thing.astype(np.uint8), kernel(5)) > 0) & (hull > 0)
    return whole


def _join_papers(lab: Array, papers: list[Array], raised: list[Array]) -> list[Array]:
    """Join flat patches of one colour that lie a hair apart or that a thing lying across them has cut apart."""
    joined: list[Array] = []
    for paper in papers:
        apart, parts = list[Array](), [paper]
        colour, near = np.median(lab[paper], axis=0), cv2.dilate(paper.astype(np.uint8), kernel(5)) > 0
        for other in joined:
            far = cv2.dilate(other.astype(np.uint8), kernel(5)) > 0
            meet = (near & far).any() or any((near & thing).any() and (far & thing).any() for thing in raised)
            alike = np.abs(np.median(lab[other], axis=0) - colour).max() <= SAME_PAPER
            (parts if meet and alike else apart).append(other)
        joined = [*apart, np.any(parts, axis=0)]
    return joined


def _split_by_height(lab: Array, patch: Array, height_m: Array, least: float) -> list[Array]:
    """Cut a raised patch where its height jumps; every pixel goes to the nearest piece."""
    height = np.nan_to_num(height_m).astype(np.float32)
    size = kernel(3)
    step = cv2.dilate(height, size) - cv2.erode(height, size)
    core = patch & (step < _JUMP_M)
    pieces = components(core, max(least * 0.5, 12.0))
    if len(pieces) < 2:
        return [patch]
    pieces = _same_level(lab, pieces, height)
    if len(pieces) < 2:
        return [patch]
    markers = np.zeros(patch.shape, np.int32)
    for number, piece in enumerate(pieces, start=1):
        markers[piece] = number
    nearest = markers[nearest_in(markers > 0)]
    return [patch & (nearest == number) for number in range(1, len(pieces) + 1)]


def _same_level(lab: Array, pieces: list[Array], height: Array) -> list[Array]:
    """Put together pieces of one thing: those that a narrow neck or a lower floor parts, with the same height and
    colours, and the steps of one wall.
    """
    out: list[Array] = []
    for piece in pieces:
        level, look = float(np.median(height[piece])), lab_histogram(lab[piece])
        near = cv2.dilate(piece.astype(np.uint8), kernel(7)) > 0
        for k, other in enumerate(out):
            if _stepped(piece, other):
                out[k] = other | piece
                break
            if abs(float(np.median(height[other])) - level) > 0.006 or look @ lab_histogram(lab[other]) < 0.5:
                continue
            if (near & other).any() or (filled(piece) & other).sum() > 0.5 * other.sum():
                out[k] = other | piece
                break
        else:
            out.append(piece)
    return out


def _stepped(one: Array, other: Array) -> bool:
    """Whether two pieces are steps of one wall: rings, one within the other, that touch all the way round."""
    outer, inner = (one, other) if filled(one).sum() >= filled(other).sum() else (other, one)
    hole = filled(outer)
    # Seen a little aslant, a step is a pixel wide on one side, and its ring is open there.
    whole = cv2.fillConvexPoly(np.zeros(inner.shape, np.uint8), cv2.convexHull(largest_contour(inner)), 1) > 0
    if hole.sum() < _HOLLOW * outer.sum() or whole.sum() < _HOLLOW * inner.sum() or (whole & ~hole).any():
        return False
    rim = whole & ~(cv2.erode(whole.astype(np.uint8), kernel(3)) > 0)
    near = cv2.dilate(outer.astype(np.uint8), kernel(9)) > 0
    return bool((rim & near).sum() >= _TOUCHES * rim.sum())
