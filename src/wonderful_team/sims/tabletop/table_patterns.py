"""Patterns of tables for harder scenes: seamless tiles like those of `patterns.py`."""

from __future__ import annotations

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.patterns import Colour, blended, noise, tile_grid


def planks() -> Array:
    """Pale wood, a plank as wide as half a tile."""
    v, u = tile_grid()
    grain = 0.5 + 0.5 * np.sin(2 * np.pi * (9 * v + 0.9 * noise(71, 1, 3))) + 0.25 * noise(72, 10, 50)
    wood = blended(0.35 * grain, (222, 206, 178), (176, 148, 112))
    seam = np.minimum(v * 2 % 1, 1 - v * 2 % 1) < 0.02
    wood[seam] = (150, 124, 94)
    return wood


def gingham() -> Array:
    """A checked tablecloth, blue on white."""
    v, u = tile_grid()
    rows, columns = (v * 3 % 1 < 0.5).astype(float), (u * 3 % 1 < 0.5).astype(float)
    weave = 0.04 * noise(73, 20, 60)
    return blended((rows + columns) / 2 * 0.75 + weave, (238, 238, 234), (92, 116, 158))


def terrazzo() -> Array:
    """Chips of many colours in pale cement."""
    rng = np.random.default_rng(74)
    v, u = tile_grid()
    image = np.tile(np.array((206, 204, 198), dtype=float), (*v.shape, 1))
    chips: list[Colour] = [(178, 92, 74), (96, 128, 108), (88, 104, 140), (206, 170, 92), (70, 70, 74), (236, 234, 228)]
    for k in range(42):
        row, column = rng.uniform(size=2)
        long, wide, angle = rng.uniform(0.03, 0.075), rng.uniform(0.015, 0.04), rng.uniform(0, np.pi)
        du, dv = (u - column + 0.5) % 1 - 0.5, (v - row + 0.5) % 1 - 0.5
        along, across = np.cos(angle) * du + np.sin(angle) * dv, np.cos(angle) * dv - np.sin(angle) * du
        image[(np.abs(along) / long) ** 1.4 + (np.abs(across) / wide) ** 1.4 < 1] = chips[k % len(chips)]
    return image * (1 + 0.03 * noise(75, 10, 60))[..., None]
