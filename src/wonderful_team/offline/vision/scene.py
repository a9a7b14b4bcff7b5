"""see(): the things in one picture, with names for their colours, patterns and shapes, from its pixels alone."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.images.colours import to_lab
from wonderful_team.offline.vision.outlines import filled, kernel, window
from wonderful_team.offline.vision.recent import recent
from wonderful_team.offline.vision.segments import Segment, find_segments
from wonderful_team.offline.vision.table import Table, find_table
from wonderful_team.offline.vision.things import Scene, Thing, study_look

_WORKING_SIDE = 640
"""Longest side that pictures are looked at in [px]; larger ones are shrunk first."""


def working_zoom(picture: Picture) -> float:
    """Picture pixels per working pixel: enlarged pictures are looked at in twice the view's resolution at most."""
    longest = max(picture.size_px)
    return max(1.0, longest / _WORKING_SIDE, picture.frame.scale / 2)


def shrink(picture: Picture, zoom: float) -> tuple[Array, Array | None, Array]:
    """Colours, depth and valid pixels at working resolution."""
    width, height = (max(1, round(side / zoom)) for side in picture.size_px)
    rgb = np.asarray(picture.rgb)
    depth = None if picture.depth_m is None else np.asarray(picture.depth_m)
    if depth is None and abs(zoom - picture.frame.scale / 2) < 1e-6 and picture.frame.scale >= 2:
        rgb = _crisp(rgb, (width, height))
    elif zoom > 1:
        rgb = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA)
        if depth is not None:
            depth = cv2.resize(depth, (width, height), interpolation=cv2.INTER_NEAREST)
    columns, rows = (np.arange(width) + 0.5) * zoom, (np.arange(height) + 0.5) * zoom
    box = picture.frame.valid
    valid = ((rows > box.y0) & (rows < box.y1))[:, None] & ((columns > box.x0) & (columns < box.x1))[None, :]
    return rgb, depth, valid


def _crisp(rgb: Array, size: tuple[int, int]) -> Array:
    """The view's own pixels, two by two: what an enlargement mixed between them is left out.

    At the middle of a block little of the neighbours is mixed in, and the sample that is least like them has least of it.
    """
    small = (max(1, size[0] // 2), max(1, size[1] // 2))
    pixels = cv2.resize(rgb, small, interpolation=cv2.INTER_LINEAR)
    scale = rgb.shape[1] // small[0]
    if scale % 2 == 0 and rgb.shape[:2] == (small[1] * scale, small[0] * scale):
        low = scale // 2 - 1
        samples = np.stack([rgb[low + dy :: scale, low + dx :: scale] for dy in (0, 1) for dx in (0, 1)])
        around = cv2.blur(pixels, (3, 3), borderType=cv2.BORDER_REPLICATE)
        pixels = np.where(pixels >= around, samples.max(axis=0), samples.min(axis=0))
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_NEAREST_EXACT))


@recent
def see(picture: Picture) -> Scene:
    """Find the things in a picture of a table.

    Args:
        picture: Its pixels, its depth if it has one, and which part of it is no padding; marks are not read.
    """
    zoom = working_zoom(picture)
    rgb, depth, valid = shrink(picture, zoom)
    lab = to_lab(rgb)
    if not valid.any():
        empty = np.ones(valid.shape, dtype=bool)
        return Scene((), empty, zoom, picture.frame.scale, picture.size_px, picture.frame.valid, False)
    table = find_table(lab, valid, depth)
    segments = find_segments(lab, valid, table)
    things = [_thing(segment, _lying_on(segment, segments), rgb, lab, table, zoom, valid) for segment in segments]
    things.sort(key=lambda thing: thing.centre)
    things = _stacked([replace(thing, number=number) for number, thing in enumerate(things)])
    occupied = table.stands_out | ~valid
    if table.raised is not None:
        occupied = occupied | table.raised
    return Scene(
        tuple(things), occupied, zoom, picture.frame.scale, picture.size_px, picture.frame.valid,
        table.height_m is not None,
    )  # fmt: skip


def _lying_on(segment: Segment, segments: list[Segment]) -> Array | None:
    """What smaller things hide of a segment, with their rims; None when nothing lies on it."""
    size = segment.mask.sum()
    hidden = [other.mask for other in segments if other.mask.sum() < 0.8 * size and (other.mask & segment.mask).any()]
    return cv2.dilate(np.any(hidden, axis=0).astype(np.uint8), kernel(5)) > 0 if hidden else None


def _thing(
    segment: Segment, lying: Array | None, rgb: Array, lab: Array, table: Table, zoom: float, valid: Array
) -> Thing:
    view = window(segment.mask, margin=0)
    y0, y1, x0, x1 = view[0].start, view[0].stop, view[1].start, view[1].stop
    mask = segment.mask[view].copy()  # a part of it would hold on to all of it, for every thing
    whole = filled(mask)
    moments = cv2.moments(whole.astype(np.uint8), True)
    shown = mask if lying is None else mask & ~lying[view]
    if segment.shows is not None:
        shown = shown & segment.shows[view]
    if shown.sum() <= 20:
        shown = mask
    height = None
    if table.height_m is not None:
        seen = table.height_m[view][shown]
        height = float(np.nanmedian(seen) if segment.flat else np.nanpercentile(seen, 85))
    look = study_look(rgb[view], lab[view], mask, shown)
    rim = cv2.dilate((~valid).astype(np.uint8), kernel(3)) > 0
    rim[0], rim[-1], rim[:, 0], rim[:, -1] = True, True, True, True
    return Thing(
        number=0,
        box=Box(x0 * zoom, y0 * zoom, x1 * zoom, y1 * zoom),
        centre=(
            (moments["m10"] / moments["m00"] + 0.5 + x0) * zoom,
            (moments["m01"] / moments["m00"] + 0.5 + y0) * zoom,
        ),
        mask=mask,
        offset=(x0, y0),
        zoom=zoom,
        area_px=float(whole.sum()) * zoom**2,
        look=look,
        height_m=height,
        flat=bool(segment.flat),
        cut=bool((segment.mask & rim).any()),
    )


def _stacked(things: list[Thing]) -> list[Thing]:
    """Say what each thing lies on or in, and which plain things must be areas because others lie on them."""
    hosts: dict[int, int] = {}
    for thing in things:
        under = [other for other in things if other.area_px >= 1.3 * thing.area_px and other.covers(thing.centre)]
        if under:
            hosts[thing.number] = min(under, key=lambda other: other.area_px).number
    out = []
    for thing in things:
        carries = thing.number in hosts.values()
        plain = thing.look.patterns["plain"] > 0.6 and thing.look.outline.hole_share < 0.03
        flat = thing.flat or (thing.height_m is None and carries and plain and thing.look.outline.solidity > 0.9)
        out.append(replace(thing, on=hosts.get(thing.number), flat=flat))
    return out
