"""How much covers look alike: for harder scenes, where colour alone does not tell things apart."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop import textures

NEAREST = {2: 6, 3: 2}
"""Among how many of the covers most like the first one the others are drawn, by tier."""
SPREAD_WEIGHT = 0.7


def look_alikes(drawn: Sequence[str], among: Sequence[str], before: Sequence[str], tier: int) -> list[str]:
    """Covers instead of those that were drawn at random: each is one of the few most like the first of the scene.

    Args:
        drawn: What chance chose; the first of a scene stays, the others say which of the few it is.
        among: What may be chosen.
        before: What the scene has drawn already; the same cover is never chosen twice, unless nothing else is left.
        tier: 2 or 3; at 1 everything stays as drawn.
    """
    if tier not in NEAREST:
        return list(drawn)
    chosen: list[str] = []
    for name in drawn:
        if not before and not chosen:
            chosen.append(name)
            continue
        first = (*before, *chosen)[0]
        free = [n for n in among if n not in before and n not in chosen] or [n for n in among if n not in chosen]
        near = sorted(free, key=lambda other: (unlikeness(first, other), other))[: NEAREST[tier]]
        chosen.append(near[among.index(name) % len(near)])
    return chosen


@cache
def unlikeness(first: str, second: str) -> float:
    """How far apart two covers look: their mean colours, and how far their colours spread, in grey levels."""
    one, two = _looks(first), _looks(second)
    return float(np.linalg.norm(one[0] - two[0]) + SPREAD_WEIGHT * np.linalg.norm(one[1] - two[1]))


@cache
def _looks(name: str) -> tuple[Array, Array]:
    pixels = textures.texture(name).reshape(-1, 3).astype(float)
    return pixels.mean(axis=0), pixels.std(axis=0)
