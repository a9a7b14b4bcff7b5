"""Free areas in a crop: is the box on free table, and where is the freest place near it?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wonderful_team.contracts import ShownSlot
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.images.colours import to_lab
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import eyes_of
from wonderful_team.offline.vision import BoxFit, Scene, free_spots, see
from wonderful_team.offline.vision.scene import shrink, working_zoom
from wonderful_team.offline.vision.table import find_table

PLACE_SLACK = 0.25
"""How far the middle of a box may lie from the place shown, in shares of the place's sides."""
FREE_ENOUGH = 0.08
"""Share of a box that things may cover while it still counts as free."""
SMOOTH, LEAST_TABLE = 8.0, 0.2
"""At least this share of a picture lies within this distance (CIELAB) of its table's fitted colour, else it has no table."""
SAME_TABLE = 18.0
"""CIELAB distance within which two pictures of one camera show the same table."""
LOST = (0, 255)
"""A picture that holds one of these values and nothing else shows nothing."""


def table_of(picture: Picture) -> Array | None:
    """The table's colour in a picture, CIELAB, shape (3,); None where it shows no table."""
    rgb, depth, valid = shrink(picture, working_zoom(picture))
    if not valid.any() or any((rgb[valid] == value).all() for value in LOST):
        return None
    lab = to_lab(rgb)
    table = find_table(lab, valid, depth)
    smooth = np.linalg.norm(lab - table.surface, axis=-1)[valid] < SMOOTH
    if smooth.mean() < LEAST_TABLE:
        return None
    return np.asarray(np.median(table.surface[valid], axis=0))


def judge_area(crop: Picture, box: Box) -> BoxFit:
    """How free the box is, by what lies in it."""
    if table_of(crop) is None:
        return BoxFit("absent", "the crop shows no table")
    scene = see(crop)
    covered, under = 0.0, None
    for thing in scene.objects:
        shared = thing.box.intersection(box)
        if shared is not None and shared.area / box.area > covered:
            covered, under = shared.area / box.area, thing
    if covered <= FREE_ENOUGH:
        return BoxFit(
            "tight", f"free table: {covered:.0%} of the box is covered", best=box, iou=1.0, score=1.0 - covered
        )
    best = Box.around(nearest_free(scene, box), box.width, box.height)
    seen = under.look.words if under is not None else "something"
    why = f"a {seen} covers {covered:.0%} of the box"
    return BoxFit("empty", why, best=best, iou=best.iou(box), under=under, score=1.0 - covered)


def nearest_free(scene: Scene, box: Box) -> Point:
    """The free place nearest to the middle of a box; its middle itself when the picture shows none."""
    radius = 0.5 * min(box.width, box.height)
    spots = free_spots(scene, radius_px=radius, count=30) or free_spots(scene, radius_px=0.6 * radius, count=30)
    if not spots:
        return box.centre
    cx, cy = box.centre
    return min((spot.point for spot in spots), key=lambda point: (point[0] - cx) ** 2 + (point[1] - cy) ** 2)


def judge_place(description: Description, crop: Picture, box: Box, slots: Sequence[ShownSlot]) -> BoxFit:
    """How a box stands to the place that one of the instruction's pictures shows."""
    found = eyes_of(crop, slots).find(description)
    if not found:
        return BoxFit("absent", f"no picture shows the {description.text}")
    seen = table_of(crop)
    if seen is None:
        return BoxFit("absent", "the crop shows no table")
    shown = next((slot.pictures[0] for slot in slots if slot.name == description.like and slot.pictures), None)
    known = None if shown is None else table_of(shown)
    if known is not None and float(np.linalg.norm(seen - known)) > SAME_TABLE:
        return BoxFit("absent", f"the crop is not of the table in {{{description.like}}}")
    there = found[0].box
    iou = there.iou(box)
    near = max(abs(there.centre[0] - box.centre[0]) / there.width, abs(there.centre[1] - box.centre[1]) / there.height)
    why = f"{found[0].why}, {f'{near:.2f} of its sides away' if near < PLACE_SLACK else 'not in the box'}"
    return BoxFit("tight" if near < PLACE_SLACK else "empty", why, best=there, iou=iou, score=1.0)
