"""Example pictures: what a picture shows alone on an empty background, and how like it a thing in a scene is."""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.images.colours import to_lab
from wonderful_team.offline.vision.outlines import (
    Outline,
    components,
    deep_inside,
    filled,
    kernel,
    mean_width,
    same_outline,
    study_outline,
)
from wonderful_team.offline.vision.recent import recent
from wonderful_team.offline.vision.scene import shrink, working_zoom
from wonderful_team.offline.vision.segments import close_ring, fill_specks
from wonderful_team.offline.vision.table import RAISED_M, height_above_table
from wonderful_team.offline.vision.things import Example, Look, NotSeen, Thing, inner_part, study_look

_STANDS_OUT = 7.0
"""CIELAB distance from the background at which a pixel belongs to the thing shown."""

_STANDS_OUT_EXACT = 2.5
"""The same on a background of one exact colour, as computed pictures have: white there shows on brighter white."""

_GAPS = 0.1
"""Share of a thing from which gaps in it may be white parts that melt into the background."""


@recent
def study_example(picture: Picture) -> Example:
    """Describe the one thing that a picture shows on an empty background.

    White parts of its texture may melt into a white background; gaps between its parts are closed.

    Raises:
        NotSeen: Nothing stands out from the background.
    """
    zoom = working_zoom(picture)
    rgb, depth, valid = shrink(picture, zoom)
    lab = to_lab(rgb)
    border = valid & (cv2.erode(valid.astype(np.uint8), np.ones((5, 5), np.uint8), borderValue=0) == 0)
    background = np.median(lab[border if border.any() else valid], axis=0)
    gap = np.sqrt(((lab - background) ** 2 * np.array([0.8, 1.0, 1.0])).sum(axis=-1))
    even = (np.abs(rgb[border] - np.median(rgb[border], axis=0)) <= 1).mean() > 0.98 if border.any() else False
    shows = (gap > (_STANDS_OUT_EXACT if even else _STANDS_OUT)) & valid
    raised = None
    if depth is not None:
        height = height_above_table(depth, valid)
        raised = None if height is None else (np.nan_to_num(height) > RAISED_M) & valid
        near_all = raised is not None and raised.sum() > 0.5 * valid.sum()
        if raised is not None and raised.sum() > 30 and not near_all:
            shows = raised
    gapped = _one_thing(shows, exact=bool(even))
    if gapped is None:
        raise NotSeen(f"picture {picture.name!r} shows nothing that stands out from its background")
    mask = fill_specks(close_ring(gapped) if even else gapped)
    rows, columns = np.nonzero(mask)
    y0, y1, x0, x1 = int(rows.min()), int(rows.max()) + 1, int(columns.min()), int(columns.max()) + 1
    view = np.s_[y0:y1, x0:x1]
    look = study_look(rgb[view], lab[view], mask[view], inner_part((gapped & shows)[view]) if even else None)
    gaps = even and (mask & ~shows)[view].sum() > _GAPS * mask.sum()
    area = float(filled(mask[view]).sum()) * (zoom / picture.frame.scale) ** 2
    return Example(
        look=look,
        box=Box(x0 * zoom, y0 * zoom, x1 * zoom, y1 * zoom),
        area_view_px=area,
        wide_view_px=mean_width(deep_inside(mask[view])) * zoom / picture.frame.scale,
        open_outline=None if (gapped == mask).all() else study_outline(gapped[view]),
        gapless=study_look(rgb[view], lab[view], mask[view]) if gaps else None,
    )


def _one_thing(shows: Array, *, exact: bool) -> Array | None:
    """Everything that belongs to the thing shown, joined across vanished texture; None when nothing."""
    tidy = shows if exact else cv2.morphologyEx(shows.astype(np.uint8), cv2.MORPH_OPEN, kernel(3)) > 0
    parts = components(tidy, 12)
    if not parts:
        return None
    biggest = float(parts[0].sum())
    mask = np.any([part for part in parts if part.sum() > 0.02 * biggest], axis=0)
    for size in (3, 5, 7, 9, 13, 17):
        closed = _closed(mask, size)
        if len(components(closed, 1)) == 1:
            mask = closed
            break
    else:
        mask = components(_closed(mask, 17), 1)[0]
    return mask


def _closed(mask: Array, size: int) -> Array:
    padded = np.pad(mask.astype(np.uint8), size)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel(size))
    return np.asarray(closed[size:-size, size:-size] > 0)


def alike(
    example: Example, thing: Thing, view_scale: float, only: Literal["texture", "shape"] | None = None
) -> dict[str, float]:
    """How like an example a thing is: colour, pattern, outline and size, each 0 to 1, at any rotation.

    Args:
        example: What is looked for.
        thing: What was seen.
        view_scale: Picture pixels per view pixel of the picture that holds the thing.
        only: Which aspects count; all when None.
    """
    parts: dict[str, float] = {}
    if only != "shape":
        # A small thing, a rim or a line shows too little of a texture to be told by it.
        wide = min(thing.wide_px / view_scale, example.wide_view_px)
        told = float(np.clip((wide - 7.0) / 8.0, 0.15, 1))
        looks = [example.look, *([example.gapless] if example.gapless is not None else [])]
        rated = [(alike_colour(look, thing.look), 1 - told * (1 - alike_pattern(look, thing.look))) for look in looks]
        parts["colour"], parts["pattern"] = max(rated, key=lambda pair: (pair[0] * pair[1], pair))
    if only != "texture":
        forms = [example.look.outline, *([example.open_outline] if example.open_outline is not None else [])]
        if only == "shape" and example.look.patterns["plain"] > PLAIN:
            forms = forms[-1:]  # a plain thing has no texture that could have vanished: its gaps are holes
        parts["outline"] = max(same_outline(form, thing.look.outline) for form in forms)
        parts["outline"] = max(parts["outline"], thin_likeness(example.look.outline, thing.look.outline))
        ratio = thing.area_px / view_scale**2 / example.area_view_px
        # Where looks do not count, size is all that tells like shapes apart.
        full, fall = (1.05, 1.2) if only == "shape" else (1.25, 0.5)
        parts["size"] = float(np.clip(full - fall * abs(np.log(ratio)), 0.25, 1.0))
    return parts


PLAIN = 0.5
"""Plainness from which a picture's thing has no texture."""
THIN_FILL, THIN_ASPECT = 0.3, 6.0
"""A rim fills at most this share of the rectangle round it; a line is at least so many times as long as wide."""


def thin_likeness(one: Outline, other: Outline) -> float:
    """Likeness of two thin or open forms by the rectangle round them, 0 to 0.8; 0 where either is a full form.

    Gaps that a texture tears into a rim change its outline, but not the rectangle round it.
    """
    thin = [form.fill < THIN_FILL or form.aspect > THIN_ASPECT for form in (one, other)]
    if not all(thin):
        return 0.0
    gap = abs(float(np.log(one.aspect / other.aspect))) / max(1.0, float(np.log(min(one.aspect, other.aspect))))
    return float(0.8 * np.clip(1.25 - 2.5 * gap, 0, 1))


def likeness(one: Thing, other: Thing) -> float:
    """How much two things in two pictures look like the same one, 0 to 1, at any place and turn."""
    colours = float(one.look.histogram @ other.look.histogram)
    outline = same_outline(one.look.outline, other.look.outline)
    size = min(one.area_px, other.area_px) / max(one.area_px, other.area_px)
    return colours * (0.4 + 0.6 * outline) * (0.5 + 0.5 * size)


def alike_colour(one: Look, other: Look) -> float:
    """Likeness of two surfaces' colours, 0 to 1."""
    return float(np.clip((one.histogram @ other.histogram - 0.3) / 0.55, 0, 1))


def alike_pattern(one: Look, other: Look) -> float:
    """Likeness of two surfaces' textures, 0 to 1."""
    weights = np.array([1.0, 1.0, 0.7, 1.0, 0.5, 0.3, 0.4])
    plain = one.patterns["plain"] * other.patterns["plain"]
    gap = float((weights * np.abs(one.surface.numbers - other.surface.numbers)).sum())
    return float(max(np.clip(1.15 - 0.6 * gap, 0, 1), plain))
