"""Words for things, so that one who sees the picture finds each by its words alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from wonderful_team.core.text import ordinal
from wonderful_team.core.values import GroundTruthView, TrueThing

TALLER = 1.3
"""A thing this many times as high as another of the same words is called the taller one."""


def unique_words(sight: GroundTruthView, things: Mapping[str, TrueThing]) -> dict[str, str]:
    """Words for everything in a view: what it is; where several share these, also its place from the left.

    Args:
        sight: The view.
        things: What is known of the things in it.
    """
    groups: dict[str, list[str]] = {}
    for name, thing in things.items():
        groups.setdefault(thing.words, []).append(name)
    words = {}
    for said, names in groups.items():
        if len(names) == 1:
            words[names[0]] = said
            continue
        heights = {name: things[name].height_m for name in names}
        high, low = max(names, key=heights.__getitem__), min(names, key=heights.__getitem__)
        if len(names) == 2 and heights[high] > TALLER * heights[low]:
            words[high], words[low] = f"taller {said}", f"shorter {said}"
            continue
        for number, name in enumerate(sorted(names, key=lambda name: _across(sight, things[name])), 1):
            words[name] = f"{ordinal(number)} {said} from the left"
    return words


def _across(sight: GroundTruthView, thing: TrueThing) -> tuple[float, float]:
    """Where a thing's centre lies in the view, from the left, then from the top [px]."""
    camera = sight.view.camera
    if camera is not None:
        x, y = camera.project(np.asarray(thing.position_m)[None])[0]
        return float(x), float(y)
    rows, columns = np.nonzero(sight.masks[thing.name])
    return (float(columns.mean()), float(rows.mean())) if len(rows) else (0.0, 0.0)
