"""Choices that several tasks make alike: which textures things may have, and what may stand in the way."""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.shapes import BASES, KIT
from wonderful_team.sims.tabletop.textures import texture_names

_LIGHT = texture_names()
KIT_TEXTURES, BASE_TEXTURES = _LIGHT[:24], _LIGHT[24:]
"""As in VIMA-Bench, what is carried and what holds it are covered from two halves of the same list."""


def one_of(rng: np.random.Generator, names: tuple[str, ...] | list[str]) -> str:
    """One of the names, each equally likely."""
    return names[int(rng.integers(len(names)))]


def add_distractor(scene: Scene, rng: np.random.Generator, kit: Thing, base: Thing, taken: tuple[str, ...]) -> Thing:
    """Add a thing that must stay away: the same shape in another texture, or another shape in any."""
    like = kit if rng.random() < 0.5 else base
    pool, textures = (KIT, KIT_TEXTURES) if like is kit else (BASES, BASE_TEXTURES)
    if rng.random() < 0.5:
        shape_name = like.shape
    else:
        shape_name = one_of(rng, [name for name in pool if name != like.shape])
    free = [name for name in textures if name not in taken]
    return scene.add(shape_name, scene.pick_textures(1, free)[0], distractor=True)
