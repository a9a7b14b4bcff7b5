"""How tall things are, from a second picture that looks at the table from the side: more of a tall thing's side shows there.

Both cameras are taken to look along the same direction over the table, so that left and right are the same in both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.vision.scene import see
from wonderful_team.offline.vision.things import Scene, Thing

_ACROSS = 0.02
"""Difference in left-right place [share of the width] at which a pair of sightings gets doubtful."""

_ALONG = 0.2
"""The same for near and far, which the slant of the view stretches [share of the height]."""

_LEAST = 0.15
"""Least score at which two sightings are of one thing (0 to 1)."""

_GREY = 0.15
"""Chroma over lightness up to which a surface is grey."""

_ONE_HUE = 0.94
"""Cosine of the hue difference up to which two surfaces are shades of one colour."""


def with_heights(scene: Scene, side: Picture) -> Scene:
    """The scene with `tall_px` measured for the things that the side picture shows too.

    Args:
        scene: What was seen from above.
        side: The same table at the same time, seen from the side.
    """
    from_side = _whole_again(see(side))
    if not scene.things or not from_side.things:
        return scene
    pairs = _pairs(scene, from_side)
    if not pairs:
        return scene
    top = {k: scene.things[k].box.height / scene.view_scale for k in pairs}
    slant = {k: from_side.things[pairs[k]].box.height / from_side.view_scale for k in pairs}
    # A thing without height shows its foreshortened outline only.
    share = float(np.clip(min(slant[k] / top[k] for k in pairs), 0.3, 1.0))
    things = [
        replace(thing, tall_px=slant[thing.number] - share * top[thing.number]) if thing.number in pairs else thing
        for thing in scene.things
    ]
    return replace(scene, things=tuple(things))


def _whole_again(side: Scene) -> Scene:
    """The side view with tops and the shaded sides below them, which differ in lightness only, as one thing."""
    things: list[Thing] = []
    for thing in sorted(side.things, key=lambda thing: thing.box.y0):
        for k, top in enumerate(things):
            shared = min(top.box.x1, thing.box.x1) - max(top.box.x0, thing.box.x0)
            meets = thing.box.y0 <= top.box.y1 + 2 * thing.zoom
            if meets and shared > 0.6 * min(top.box.width, thing.box.width) and _one_hue(top, thing):
                things[k] = replace(top, box=Box.bounding([*top.box.corners, *thing.box.corners]))
                break
        else:
            things.append(thing)
    return replace(side, things=tuple(things))


def _one_hue(one: Thing, other: Thing) -> bool:
    """Whether two surfaces are shades of one colour."""
    hues = []
    for thing in (one, other):
        lab = np.sum([np.array(colour.lab) * colour.share for colour in thing.look.colours], axis=0)
        hues.append(lab[1:] / max(float(lab[0]), 10.0))
    lengths = [float(np.linalg.norm(hue)) for hue in hues]
    if max(lengths) < _GREY:
        return True
    return min(lengths) > _GREY and float(hues[0] @ hues[1]) > _ONE_HUE * lengths[0] * lengths[1]


def _pairs(above: Scene, side: Scene) -> dict[int, int]:
    """Number of each thing seen from above with its number in the side picture, the surest pairs first."""
    one, other = (_places(scene) for scene in (above, side))
    across = np.abs(one[:, None, 0] - other[None, :, 0]) / _ACROSS
    along = one[:, None, 1] - other[None, :, 1]
    along = np.abs(along - np.median(along)) / _ALONG
    looks = np.array([[_alike(a, b) for b in side.things] for a in above.things])
    score = np.exp(-(across**2) / 2 - along**2 / 2) * (0.4 + 0.6 * looks)
    pairs: dict[int, int] = {}
    for flat in np.argsort(-score, axis=None):
        k, m = (int(v) for v in np.unravel_index(int(flat), score.shape))
        if score[k, m] < _LEAST:
            break
        if k not in pairs and m not in pairs.values():
            pairs[k] = m
    return pairs


def _places(scene: Scene) -> Array:
    """Middles of the things' boxes as shares of the picture, shape (N, 2)."""
    width, height = scene.size_px
    return np.array([(thing.box.centre[0] / width, thing.box.centre[1] / height) for thing in scene.things])


def _alike(one: Thing, other: Thing) -> float:
    """Likeness of colours; sides in the shade are darker, so names of colours count, not their lightness."""
    names = one.look.memberships.keys() & other.look.memberships.keys()
    return float(sum(min(one.look.memberships[name], other.look.memberships[name]) for name in names))
