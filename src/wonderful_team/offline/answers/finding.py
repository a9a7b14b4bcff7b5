"""Where a target is and where to act on it: shared by the grounding answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture, Point, PointMark
from wonderful_team.core.values import PointRole, Target
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import Eyes, target_description
from wonderful_team.offline.pushing.sweeping import pushes_of
from wonderful_team.offline.vision import Match, Scene, Thing, free_spots
from wonderful_team.offline.vision.kinds import part_on

STANDOFF = 0.35
"""How far beside a thing a push starts, in shares of its half side."""


@dataclass(frozen=True, eq=False)
class Found:
    """A target in a picture; coordinates are pixels of that picture."""

    match: Match
    box: Box
    description: Description

    @property
    def thing(self) -> Thing | None:
        return self.match.thing


def find_target(target: Target, eyes: Eyes, plan: Sequence[str] = ()) -> Found | None:
    """The best match of a target's words (and example), or None when it is not here."""
    found = candidates(target, eyes, plan)
    return found[0] if found else None


def candidates(target: Target, eyes: Eyes, plan: Sequence[str] = ()) -> list[Found]:
    """Everything that fits a target, best first; the plan's lines say what is pushed before it is."""
    description = target_description(target)
    if description.way is not None:
        return [Found(match, match.box, description) for match in eyes.on_the_way(description.way, plan)]
    return [Found(match, match.box, description) for match in eyes.find(description)]


def act_at(found: Found, role: PointRole, eyes: Eyes, towards: Point | None = None) -> Point:
    """The point for a role: on material to pick, the middle (free part) to place, beside to push from.

    Args:
        found: The target.
        role: What the point is for.
        eyes: The picture.
        towards: Where a push should go; decides the side it starts from.
    """
    thing = found.thing
    if thing is None:
        return found.match.point
    if role in ("pick", "grasp"):
        return held_by(thing, found.description, eyes.scene).steady_point()
    if role == "push_start":
        return _beside(found.box, towards)
    return middle_of(thing, found.description, eyes.scene)


def held_by(thing: Thing, description: Description, scene: Scene) -> Thing:
    """What of a thing fingers take hold of: the neck of a bottle, the handle of a lid; else the thing itself."""
    part = part_on(thing, scene) if description.noun in ("bottle", "lid") else None
    return thing if part is None else part


def middle_of(thing: Thing, description: Description, scene: Scene) -> Point:
    """Where to put something on or in a thing: a free part of an area, the middle of anything else."""
    if thing.flat or description.noun == "area":
        if not scene.on(thing):
            return thing.centre if thing.holds(thing.centre) else thing.steady_point()
        spots = free_spots(scene, inside=thing, count=1)
        if spots:
            return spots[0].point
    return thing.centre


def _beside(box: Box, towards: Point | None) -> Point:
    """A point beside a box, on the side away from where it should go; left of it when nothing is known."""
    cx, cy = box.centre
    dx, dy = (towards[0] - cx, towards[1] - cy) if towards is not None else (1.0, 0.0)
    length = float(np.hypot(dx, dy)) or 1.0
    dx, dy = dx / length, dy / length
    reach = min(
        box.width / 2 / abs(dx) if abs(dx) > 1e-6 else np.inf,
        box.height / 2 / abs(dy) if abs(dy) > 1e-6 else np.inf,
    )
    far = float(reach) * (1 + STANDOFF)
    return cx - dx * far, cy - dy * far


def push_goal(plan: Sequence[str], target: Target, eyes: Eyes, others: Sequence[Target] = ()) -> Point | None:
    """Where a target is pushed to, as far as this picture and the plan's words show it."""
    for other in others:
        if "push_end" in other.use and other.id != target.id and (found := find_target(other, eyes)) is not None:
            return found.match.point
    sides = {"leftmost": (-1e4, 0.0), "rightmost": (1e4, 0.0), "topmost": (0.0, -1e4), "bottommost": (0.0, 1e4)}
    for _, to in pushes_of(plan):
        if to.what is not None and (best := eyes.best(to.what)) is not None:
            return best.point
        if to.side in sides:
            return sides[to.side]
    return None


def tried(view: Picture) -> list[Point]:
    """Points that were tried and rejected, as marked."""
    return [mark.point for mark in view.marks if isinstance(mark, PointMark)]


def untried(found: Sequence[Found], points: Sequence[Point]) -> list[Found]:
    """Matches on which no rejected point lies."""
    return [item for item in found if not any(item.box.contains(point) for point in points)]


def varied(point: Point, found: Found, sample: int) -> Point:
    """Another honest pointing at the same thing: sample 0 is the point itself, others differ by up to a sixth of a radius."""
    if sample == 0:
        return point
    random = np.random.default_rng((sample, round(point[0] * 8), round(point[1] * 8)))
    reach = min(found.box.width, found.box.height) / 12
    moved = (point[0] + float(random.uniform(-reach, reach)), point[1] + float(random.uniform(-reach, reach)))
    return moved if found.thing is None or found.thing.holds(moved) else point


def told(found: Found) -> str:
    """What decided, in a short sentence."""
    return f"fits with {found.match.score:.2f} ({found.match.why}), ahead of the next by {found.match.margin:.2f}"
