"""Free places on the table."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.outlines import filled
from wonderful_team.offline.vision.relations import DIRECTIONS, is_at
from wonderful_team.offline.vision.things import Match, Scene, Thing, whole_mask, with_margins


def free_spots(
    scene: Scene,
    *,
    relations: Sequence[tuple[str, Sequence[Thing]]] = (),
    radius_px: float | None = None,
    inside: Thing | None = None,
    side: str = "",
    count: int = 8,
) -> list[Match]:
    """Free places, best first; [] when there is no room.

    Args:
        scene: What was seen.
        relations: What must hold, such as ("left_of", [bowl]).
        radius_px: Room that is needed round the spot [picture px]; the size of a typical thing when None.
        inside: A flat thing that the spot must lie on ("a free place on the red paper").
        side: A side, corner or the middle of the table that it must lie at.
        count: At most so many.
    """
    zoom = scene.zoom
    if radius_px is None:
        sizes = [thing.radius_px for thing in scene.objects] or [0.06 * min(scene.valid.width, scene.valid.height)]
        radius_px = float(np.median(sizes))
    free = _room(scene, inside)
    rating = np.clip(free * zoom / (1.6 * radius_px), 0, 1) * (free * zoom > 0.8 * radius_px)
    rows, columns = np.mgrid[0 : free.shape[0], 0 : free.shape[1]]
    x, y = (columns + 0.5) * zoom, (rows + 0.5) * zoom
    for relation, things in relations:
        rating = rating * _wish(relation, things, x, y, radius_px, scene)
    if side:
        rating = rating * is_at(scene, (x, y), side)
    return _best_spots(rating, radius_px, zoom, count)


def _room(scene: Scene, inside: Thing | None) -> Array:
    """Distance from each working pixel to the nearest thing or edge."""
    shape = scene.occupied.shape
    blocked = scene.occupied.copy()
    for thing in scene.things:
        blocked |= filled(whole_mask(thing, shape))
    if inside is not None:
        blocked = ~filled(whole_mask(inside, shape))
        for thing in scene.on(inside):
            blocked |= filled(whole_mask(thing, shape))
    # Single pixels that stand out are noise, not things.
    blocked = cv2.morphologyEx(blocked.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    framed = np.pad(blocked, 1, constant_values=1)
    return np.asarray(cv2.distanceTransform(1 - framed, cv2.DIST_L2, 5)[1:-1, 1:-1])


def _wish(relation: str, things: Sequence[Thing], x: Array, y: Array, radius_px: float, scene: Scene) -> Array:
    """How well each pixel stands in a relation to things, 0 to 1."""
    thing = things[0]
    dx, dy = x - thing.centre[0], y - thing.centre[1]
    distance = np.hypot(dx, dy)
    reach = 0.5 * max(thing.box.width, thing.box.height) + 1.7 * radius_px
    diagonal = float(np.hypot(scene.valid.width, scene.valid.height))
    if relation in DIRECTIONS:
        ux, uy = DIRECTIONS[relation]
        angle = np.degrees(np.arccos(np.clip((dx * ux + dy * uy) / np.maximum(distance, 1e-6), -1, 1)))
        straight = np.clip(1 - np.maximum(angle - 10, 0) / 50, 0, 1)
        return np.asarray(straight * np.exp(-((np.maximum(distance - reach, 0) / (0.35 * diagonal)) ** 2)))
    if relation == "near":
        return np.asarray(np.exp(-((np.maximum(distance - reach, 0) / (0.15 * diagonal)) ** 2)))
    if relation == "far_from":
        return np.asarray(np.clip(distance / (0.5 * diagonal), 0, 1))
    if relation in ("on", "inside"):
        whole = filled(whole_mask(thing, scene.occupied.shape))
        return np.asarray(whole.astype(np.float64))
    if relation == "between":
        middle = (np.array(thing.centre) + np.array(things[1].centre)) / 2
        span = float(np.hypot(*(np.array(thing.centre) - np.array(things[1].centre))))
        return np.asarray(np.exp(-((np.hypot(x - middle[0], y - middle[1]) / max(0.25 * span, 1.0)) ** 2)))
    return np.ones_like(x)


def _best_spots(rating: Array, radius_px: float, zoom: float, count: int) -> list[Match]:
    """The best places that keep apart from each other."""
    left = rating.astype(np.float32).copy()
    rows, columns = np.mgrid[0 : left.shape[0], 0 : left.shape[1]]
    out: list[Match] = []
    middle = (left.shape[0] / 2, left.shape[1] / 2)
    # Of equal places, the one nearest the middle: it is the easiest to reach.
    left -= 1e-4 * np.hypot(rows - middle[0], columns - middle[1]).astype(np.float32) / max(left.shape)
    for _ in range(count):
        row, column = np.unravel_index(int(left.argmax()), left.shape)
        score = float(rating[row, column])
        if score < 0.25:
            break
        point = (float((column + 0.5) * zoom), float((row + 0.5) * zoom))
        box = Box.around(point, 2 * radius_px, 2 * radius_px)
        out.append(Match(None, box, point, score, 0.0, f"free place with room for a radius of {radius_px:.0f} px"))
        left[np.hypot(rows - row, columns - column) * zoom < 2 * radius_px] = -1
    return with_margins(out)
