"""Further things on a table that is set: no rule is about them, they look like nothing the instruction speaks of, and they
stand free of every place where something has to go.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely import Point, box
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.geometry import Pose
from wonderful_team.sims.tabletop import textures
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.goals import Poses, footprint_at, footprint_of
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.placing import EDGE_M, GAP_M
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.showing import Stand

COUNTS = (0, 2, 4, 6)
"""How many things each tier adds, where there is room."""
LARGE = ("letter A", "letter E", "letter G", "letter M", "letter R", "letter T", "letter V", "L-shaped block",
         "cross", "triangle", "heart", "star")  # fmt: skip
"""Neither round nor square, so that none of them has the profile of a container."""
LITTLE = ("small block",)
"""Where the table is too full for others."""
APART_M = 0.125
LANE_M = 0.06
"""Free table beside the way of things that are to be pushed [m]."""
TRIES = 80


def add_clutter(scene: Scene, rng: np.random.Generator, tier: int) -> list[Thing]:
    """Add 2, 4 or 6 things, or as many as there is room for; pictures of the whole table show them, too."""
    added: list[Thing] = []
    if not tier:
        return added
    kept_free = _kept_free(scene)
    covers = _covers(scene, rng)
    for _ in range(COUNTS[tier]):
        thing = _placed(scene, rng, kept_free, covers)
        if thing is None:
            break
        covers.remove(thing.texture)
        added.append(thing)
    scene.clutter += [thing.name for thing in added]
    for slot in scene.whole:
        shown = scene.pictures[slot]
        scene.pictures[slot] = replace(shown, stands=(*shown.stands, *(Stand(thing.name) for thing in added)))
    return added


def _placed(scene: Scene, rng: np.random.Generator, kept_free: BaseGeometry, covers: Sequence[str]) -> Thing | None:
    """One thing more, a large one if there is room."""
    taken = {thing.shape for thing in (*scene.things, *scene.props)}
    large = [name for name in LARGE if name not in taken] or list(LARGE)
    centres = [(thing.x_m, thing.y_m) for thing in scene.things]
    for shapes, apart_m in ((large, APART_M), (LITTLE, 0.0)):
        for _ in range(TRIES):
            shape_name, yaw = shapes[int(rng.integers(len(shapes)))], float(rng.uniform(-math.pi, math.pi))
            x, y = (float(rng.uniform(TABLE_LOW_M[k] + EDGE_M, TABLE_HIGH_M[k] - EDGE_M)) for k in (0, 1))
            at = (x, y)
            if any(math.dist(at, centre) < apart_m for centre in centres):
                continue
            draft = scene.made(shape_name, covers[0], None, yaw, 0.0, 1.0)
            place = footprint_at(draft, x, y, yaw).convex_hull
            whole = box(*TABLE_LOW_M[:2], *TABLE_HIGH_M[:2]).buffer(-EDGE_M, join_style="mitre")
            if not place.buffer(GAP_M).intersects(kept_free) and scene.fits(draft, at, room=whole):
                return scene.add(shape_name, covers[0], at=at, yaw_rad=yaw)
    return None


def _kept_free(scene: Scene) -> BaseGeometry:
    """Where things have to go, whichever way they are turned, and the way of those that are pushed."""
    poses: Poses = {t.name: Pose.at((t.x_m, t.y_m, t.z_m), t.yaw_rad) for t in scene.things}
    things = {thing.name: thing for thing in scene.things}
    kept = [
        Point(point).buffer(things[goal.thing].body.radius_m)
        for goal in scene.goals
        for point in goal.target_points(poses)
    ]
    for count in scene.counts:
        blocks = [footprint_of(things[name], poses[name]) for name in (*count.things, *count.strangers)]
        lane = shapely.unary_union([count.zone.region(poses), *blocks]).convex_hull
        kept.append(lane.buffer(LANE_M))
    return shapely.unary_union(kept)


def _covers(scene: Scene, rng: np.random.Generator) -> list[str]:
    """Covers that nothing wears, in random order; those that share a colour with what the instruction is about come last."""
    targets = {name for goal in scene.goals for name in (goal.thing, *goal.near, *goal.inside)}
    targets |= {name for count in scene.counts for name in (*count.things, count.zone.of)}
    worn = {thing.texture for thing in (*scene.things, *scene.props)}
    meant = {thing.texture for thing in scene.things if thing.name in targets} | {prop.texture for prop in scene.props}
    colours = {word for name in meant for word in name.split() if word in textures.PLAIN}
    free = [str(name) for name in rng.permutation([name for name in textures.texture_names() if name not in worn])]
    return sorted(free, key=lambda name: not colours.isdisjoint(name.split()))
