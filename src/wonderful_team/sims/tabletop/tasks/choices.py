"""Choices that several tasks make alike: which shapes and textures things may have at each generalisation level.

The levels follow VIMA-Bench (Jiang et al. 2023, arXiv:2210.03094), with our own split of its shapes:
L1 known shapes and textures at new places; L2 known ones newly combined (what is carried wears what holds it wore, and
the other way round); L3 shapes that L1 and L2 never show; L4 tasks that the others never show. Without a level, all shapes.
"""

from __future__ import annotations

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.shapes import BASES, FULL_TURN, KIT
from wonderful_team.sims.tabletop.textures import texture_names

_LIGHT = texture_names()
KIT_TEXTURES, BASE_TEXTURES = _LIGHT[:24], _LIGHT[24:]
"""As in VIMA-Bench, what is carried and what holds it are covered from two halves of the same list."""
NEW_KIT = ("letter R", "diamond", "hexagon", "round", "star")
NEW_BASES = ("pallet", "pan")
L123, L12, L4 = ("L1", "L2", "L3"), ("L1", "L2"), ("L4",)


def one_of(rng: np.random.Generator, names: tuple[str, ...] | list[str]) -> str:
    """One of the names, each equally likely."""
    return names[int(rng.integers(len(names)))]


def some_of(rng: np.random.Generator, names: tuple[str, ...] | list[str], count: int) -> list[str]:
    """Different names in random order."""
    return [names[int(k)] for k in rng.choice(len(names), size=count, replace=False)]


def kit_shapes(scene: Scene, among: tuple[str, ...] = KIT) -> tuple[str, ...]:
    """Shapes of what is carried, at the scene's level."""
    return _at_level(scene, among, NEW_KIT)


def turning_shapes(scene: Scene) -> tuple[str, ...]:
    """Shapes of what is carried that look the same only after a full turn."""
    return _at_level(scene, FULL_TURN, NEW_KIT)


def base_shapes(scene: Scene, among: tuple[str, ...] = BASES) -> tuple[str, ...]:
    """Shapes of what holds it, at the scene's level."""
    return _at_level(scene, among, NEW_BASES)


def _at_level(scene: Scene, among: tuple[str, ...], new: tuple[str, ...]) -> tuple[str, ...]:
    if scene.partition is None:
        return among
    wanted = tuple(name for name in among if (name in new) == (scene.partition == "L3"))
    return wanted or among


def kit_textures(scene: Scene) -> tuple[str, ...]:
    """Textures of what is carried, at the scene's level."""
    return BASE_TEXTURES if scene.partition == "L2" else KIT_TEXTURES


def base_textures(scene: Scene) -> tuple[str, ...]:
    """Textures of what holds it, at the scene's level."""
    return KIT_TEXTURES if scene.partition == "L2" else BASE_TEXTURES


def add_distractor(scene: Scene, rng: np.random.Generator, kit: Thing, base: Thing, taken: tuple[str, ...]) -> Thing:
    """Add a thing that must stay away: the same shape in another texture, or another shape in any."""
    like = kit if rng.random() < 0.5 else base
    if like is kit:
        pool, textures = kit_shapes(scene), kit_textures(scene)
    else:
        pool, textures = base_shapes(scene), base_textures(scene)
    if rng.random() < 0.5:
        shape_name = like.shape
    else:
        shape_name = one_of(rng, [name for name in pool if name != like.shape])
    free = [name for name in textures if name not in taken]
    return scene.add(shape_name, scene.pick_textures(1, free)[0], distractor=True)
