"""How a table is lit, where its cameras stand and what covers it; harder tiers draw all of it from the seed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.cameras import CAMERA_NAMES, TABLE_HIGH_M, TABLE_LOW_M, Lens, lens
from wonderful_team.sims.tabletop.options import Tiers
from wonderful_team.sims.tabletop.seeds import generator
from wonderful_team.sims.tabletop.textures import TABLE_COVERS

__all__ = ["Light", "Look", "look_of", "plain_look"]


@dataclass(frozen=True, eq=False)
class Light:
    """A light from very far away.

    Attributes:
        direction: Unit vector along which it shines, shape (3,).
        ambient, diffuse: Shares of red, green and blue that reach every surface, and one that faces it.
    """

    direction: Array
    ambient: tuple[float, float, float]
    diffuse: tuple[float, float, float]
    shadows: bool = False


@dataclass(frozen=True, eq=False)
class Look:
    """All that is drawn of a scene beside its things.

    Attributes:
        lenses: The cameras by name.
        table_cover: Texture of the table; None for its plain colour.
    """

    lenses: dict[str, Lens]
    light: Light
    table_cover: str | None = None


_PLAIN_DIRECTION = np.array([-0.35, 0.25, -1.0]) / math.sqrt(0.35**2 + 0.25**2 + 1)
PLAIN_LIGHT = Light(_PLAIN_DIRECTION, (0.62,) * 3, (0.42,) * 3)

# One entry per tier from 1 on.
SUN_DEG = ((60, 70), (45, 60), (30, 45))
"""How high the light stands over the table [degrees]."""
BRIGHTNESS = ((0.9, 1.0), (0.75, 0.9), (0.55, 0.75))
"""Of a level surface, where the plain light gives 1."""
AMBIENT_SHARE = (0.55, 0.5, 0.4)
"""How much of that comes from everywhere: so bright is the inside of a shadow."""
TINT = (0.06, 0.14, 0.24)
"""How much of its blue, or red, the light lacks; of green half as much."""
SHADOWS_FROM = 2
TILT_DEG, ROLL_DEG = (4.0, 8.0, 12.0), (3.0, 6.0, 10.0)
"""The most that the top camera looks aslant and is turned about its axis [degrees]; at least 0.6 of it."""
SHIFT_M = (0.01, 0.02, 0.03)
"""The most that it looks past the middle of the table [m]."""
UNCALIBRATED_FROM = 3
WRONG_M, WRONG_RAD = 0.003, math.radians(0.4)
"""The calibration error of the hardest tier, along both of the picture's axes and about its own: up to 3 mm and 0.4
degrees, together at most 8 mm at the table's corners."""
MARGIN, CLEAR_M = 1.03, 0.08
"""What the picture holds is 3 % wider than the table and everything up to this high over it [m]."""


def plain_look(size_px: tuple[int, int]) -> Look:
    """The usual one."""
    return Look({name: lens(name, size_px) for name in CAMERA_NAMES}, PLAIN_LIGHT)


def look_of(seed: int, tiers: Tiers, size_px: tuple[int, int]) -> Look:
    """The look of a scene; each tier draws from a generator of its own, so that one leaves the others alone."""
    look = plain_look(size_px)
    if tiers.lighting:
        look = replace(look, light=_light(generator(seed, "lighting", tiers.lighting), tiers.lighting - 1))
    if tiers.camera:
        moved = _moved(look.lenses["top"], generator(seed, "camera", tiers.camera), tiers.camera)
        look = replace(look, lenses={**look.lenses, "top": moved})
    if tiers.texture:
        look = replace(look, table_cover=TABLE_COVERS[tiers.texture - 1])
    return look


def _light(rng: np.random.Generator, step: int) -> Light:
    around, height = rng.uniform(-math.pi, math.pi), math.radians(rng.uniform(*SUN_DEG[step]))
    direction = -np.array([math.cos(height) * math.cos(around), math.cos(height) * math.sin(around), math.sin(height)])
    bright = rng.uniform(*BRIGHTNESS[step])
    tint = np.array([1.0, 1 - TINT[step] / 2, 1 - TINT[step]])
    if rng.random() < 0.5:
        tint = tint[::-1]
    ambient = AMBIENT_SHARE[step] * bright
    diffuse = (bright - ambient) / math.sin(height)
    return Light(direction, _rgb(ambient * tint), _rgb(diffuse * tint), step + 1 >= SHADOWS_FROM)


def _rgb(values: Array) -> tuple[float, float, float]:
    red, green, blue = (float(value) for value in values)
    return red, green, blue


def _moved(usual: Lens, rng: np.random.Generator, tier: int) -> Lens:
    """The camera tilted about a level axis, rolled about its own, and looking past the middle; all of the table is seen."""
    aside, (right, down, forward) = aslant(usual, rng, tier - 1)
    # It stays a metre from the point of the table that it looks at.
    pivot = np.array([0.5, 0.0, 0.0]) + aside
    moved = replace(usual, position_m=pivot - forward, right=right, down=down, forward=forward)
    corners = np.array(
        [
            (x, y, z)
            for x in (TABLE_LOW_M[0], TABLE_HIGH_M[0])
            for y in (TABLE_LOW_M[1], TABLE_HIGH_M[1])
            for z in (0, CLEAR_M)
        ]
    )
    seen = corners - moved.position_m
    aspect = usual.size_px[0] / usual.size_px[1]
    width = 2 * MARGIN * max(np.abs(seen @ right).max(), aspect * np.abs(seen @ down).max())
    moved = replace(moved, seen_width_m=max(float(width), usual.seen_width_m))
    if tier < UNCALIBRATED_FROM:
        return moved
    signs = rng.choice([-1.0, 1.0], size=3)
    return replace(moved, wrong_m=(WRONG_M * signs[0], WRONG_M * signs[1]), wrong_rad=WRONG_RAD * signs[2])


def aslant(usual: Lens, rng: np.random.Generator, step: int) -> tuple[Array, tuple[Array, Array, Array]]:
    """How a camera was moved: how far it looks past where it looked, shape (3,) [m], and its right, down and forward now, shape (3,) each.

    Args:
        usual: How it stood.
        rng: Draws it.
        step: How much, 0 to 2.
    """
    tilt, roll = (math.radians(most) * rng.uniform(0.6, 1.0) for most in (TILT_DEG[step], ROLL_DEG[step]))
    roll *= rng.choice([-1.0, 1.0])
    way = rng.uniform(-math.pi, math.pi)
    aside = np.append(rng.uniform(-SHIFT_M[step], SHIFT_M[step], size=2), 0.0)
    turn = _turn(np.array([math.cos(way), math.sin(way), 0.0]), tilt) @ _turn(usual.forward, roll)
    return aside, (turn @ usual.right, turn @ usual.down, turn @ usual.forward)


def _turn(axis: Array, angle_rad: float) -> Array:
    """Rotation about a unit axis, shape (3, 3). Source: Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle_rad) * cross + (1 - math.cos(angle_rad)) * cross @ cross)
