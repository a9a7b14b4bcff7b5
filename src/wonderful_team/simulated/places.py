"""Boxes and points of what a target means, in pixels of the picture that is shown, from what shows there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import PointRole
from wonderful_team.simulated.draft import Meaning
from wonderful_team.simulated.seeing import Seen


@dataclass(frozen=True)
class Place:
    """A target in a picture.

    Attributes:
        box: Tight round what shows of it, or round an area [picture px].
        whole: Nothing of it is cut off by the picture's edge.
    """

    meaning: Meaning
    box: Box
    whole: bool = True


def place_of(meaning: Meaning, seen: Seen) -> Place | None:
    """Where a target is; None when it does not show in this picture."""
    if meaning.thing is not None:
        box = seen.box(meaning.thing)
        if box is None:
            return None
        whole = seen.sight.masks[meaning.thing].sum() == seen.count(meaning.thing)
        return Place(meaning, box, bool(whole))
    if meaning.at_m is None:
        return None
    x, y = meaning.at_m
    (long, wide), z = meaning.sides_m, _shows_at_m(meaning, seen)
    corners = [seen.project(np.array([x + a * long, y + b * wide, z])) for a in (-0.5, 0.5) for b in (-0.5, 0.5)]
    centre = seen.project(np.array([x, y, z]))
    if centre is None or not seen.inside(centre):
        return None
    box = Box.bounding([corner for corner in corners if corner is not None])
    shown = box.intersection(seen.picture.frame.valid)
    return None if shown is None else Place(meaning, shown, shown == box)


def point_of(place: Place, role: PointRole, seen: Seen) -> Point:
    """The action point for a role [picture px]."""
    meaning = place.meaning
    if meaning.thing is not None:
        point = seen.centre(meaning.thing) if role in ("place", "push_end") else seen.grasp(meaning.thing)
        return point if point is not None and seen.inside(point) else place.box.centre
    assert meaning.at_m is not None  # place_of gives no place without it
    point = seen.project(np.array([*meaning.at_m, _shows_at_m(meaning, seen)]))
    return place.box.centre if point is None else point


def _shows_at_m(meaning: Meaning, seen: Seen) -> float:
    """At which height an area shows [m]: that of its floor, but where something lies on the rim of what it is a part of, the rim's.

    A camera that is no orthographic one sees the two at different pixels, and what is pointed at is what shows.
    """
    container = None if meaning.on is None else seen.thing(meaning.on)
    if container is None or meaning.at_m is None:
        return 0.0
    point = seen.project(np.array([*meaning.at_m, container.height_m]))
    return 0.0 if point is None or seen.at(point) in (None, meaning.on) else container.height_m
