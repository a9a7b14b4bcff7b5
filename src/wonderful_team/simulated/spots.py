"""Free room on the table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import shapely
import shapely.affinity

from wonderful_team.core.values import TrueThing
from wonderful_team.simulated.seeing import Seen

EDGE = 0.12
"""How far from the edge of the view free room is looked for, as a share of its sides."""
STEPS = 24
"""Places that are tried along each side."""
ROOMY = 0.6
"""A place with this share of the most room there is has room enough."""
BEFORE_M = 0.15
"""How far before its open side the room before a container lies, from its middle [m]."""


def free_spot(seen: Seen, things: Mapping[str, TrueThing]) -> tuple[float, float] | None:
    """The middle of the largest free room in the whole view [m]; None without a camera."""
    camera = seen.sight.view.camera
    if camera is None:
        return None
    width, height = seen.sight.view.size_px
    columns = np.linspace(EDGE * width, (1 - EDGE) * width, STEPS)
    rows = np.linspace(EDGE * height, (1 - EDGE) * height, STEPS)
    points = camera.on_plane(np.array([(x, y) for y in rows for x in columns]), 0.0)[:, :2]
    taken = shapely.unary_union([shapely.Polygon(thing.outline_m) for thing in things.values()])
    room = shapely.distance(shapely.points(points), taken)
    best = int(np.argmax(np.minimum(room, 0.15) - 0.05 * np.hypot(*(points - points.mean(axis=0)).T)))
    x, y = points[best]
    return None if math.isnan(float(x)) else (float(x), float(y))


def room_spot(
    container: TrueThing,
    *,
    inside: bool,
    off: Sequence[TrueThing] = (),
    short_of: Sequence[TrueThing] = (),
    others: Sequence[TrueThing] = (),
    comes: TrueThing | None = None,
) -> tuple[float, float] | None:
    """The place with the most room around it inside a container, or before its open side [m]; None when there is none.

    Args:
        container: A thing that is open on one side: its material lies off the middle of its hull, away from the opening.
        inside: In it; else before its open side.
        off: Things to keep away from.
        short_of: Things that what comes in through the open side must not pass.
        others: What else takes room.
        comes: What the room is for: of good places, the nearest to it is taken.
    """
    walls = _polygon(container)
    hull = walls.convex_hull
    opening = np.array(hull.centroid.coords[0]) - np.array(walls.centroid.coords[0])
    opening = opening / max(float(np.linalg.norm(opening)), 1e-9)
    region = hull.difference(walls)
    if not inside:
        region = shapely.affinity.translate(hull, *(opening * BEFORE_M))
    low_x, low_y, high_x, high_y = region.bounds
    xs, ys = np.meshgrid(np.linspace(low_x, high_x, STEPS), np.linspace(low_y, high_y, STEPS))
    points = np.column_stack([xs.ravel(), ys.ravel()])
    points = points[shapely.covers(region, shapely.points(points))]
    for line in short_of:
        points = points[(points - line.position_m[:2]) @ opening > 0]
    if not len(points):
        return None
    taken = shapely.unary_union([walls, *(_polygon(thing) for thing in (*off, *others))])
    room = shapely.distance(shapely.points(points), taken)
    best = int(np.argmax(room))
    if comes is not None:
        away = np.linalg.norm(points - comes.position_m[:2], axis=1)
        best = int(np.argmin(np.where(room >= ROOMY * room.max(), away, np.inf)))
    x, y = points[best]
    return float(x), float(y)


def _polygon(thing: TrueThing) -> shapely.Polygon:
    return shapely.Polygon(thing.outline_m)
