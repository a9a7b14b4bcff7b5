"""Plain light: a picture as it would look in white, even light, so that colours are named by what things are.

The table tells the colour of the light (von Kries 1902: one gain per channel): tables are pale and a little warm. With depth,
heights tell where one lamp's shadows fall, and they are lit again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.images.colours import to_lab
from wonderful_team.offline.vision.recent import recent
from wonderful_team.offline.vision.table import NO_TABLE, RAISED_M, Table, find_table, height_above_table

_SIDE = 320
"""Longest side at which light is measured [px]."""

_TABLE = np.array([222.0, 219.0, 211.0])
"""A table in plain light: pale and a little warm (R, G, B)."""

_OWN_COLOUR = (0.02, 0.05)
"""Up to the first log-ratio of channels a table's tint is its own, from the second on it is the light's."""

_DIM = (0.036, 0.06)
"""The same for its darkness: a lamp that is off in colour is likely to be off in brightness too."""

_STRONGEST = (0.24, 0.30)
"""Tints beyond these log-ratios are the table's own colour, such as wood's."""

_DARK = (0.9, 1.2)
"""Tables darker than pale ones by these log-ratios are dark themselves and tell nothing of the light."""

_DARKEST, _LIGHTEST = 0.2, 0.93
"""Share of the light that may be left in a shadow."""

_BRIGHTER, _LARGE = 1.15, 0.06
"""Tables are the palest of large things: none as much brighter takes up such a share of the picture."""

_SAME_HUE = 0.05
"""Difference of the channels' ratios to the table up to which a pixel is table in less light."""

_AGREES = 0.5
"""Intersection over union of shadows seen and shadows that heights and one lamp predict, from which there are shadows."""

_EVEN = 0.02
"""Median deviation of the light that is left in shadows; what varies more is a surface of its own."""


@dataclass(frozen=True, eq=False)
class _Shadows:
    """How one far lamp's shadows fall.

    Attributes:
        reach: Way of a shadow per metre of height, as shares of the picture's width (right, down) [1/m].
        left: Share of the light that is left in them.
    """

    reach: tuple[float, float]
    left: float


def in_plain_light(picture: Picture) -> Picture:
    """The picture in white, even light; itself where its light is plain or nothing tells."""
    plain = _relit(picture)
    return picture if plain is None else replace(picture, rgb=plain)


@recent
def _relit(picture: Picture) -> Array | None:
    """A picture's pixels in plain light; None where they are so already or nothing tells."""
    rgb, depth, valid = _small(picture)
    if not valid.any():
        return None
    lab = to_lab(rgb.astype(np.uint8))
    table = find_table(lab, valid, depth)
    # What is brighter than the camera can tell has lost its colour.
    bare = valid & ~table.stands_out & (rgb < 255).all(axis=-1)
    if table.raised is not None:
        bare &= ~table.raised
    if bare.mean() < 0.1 or (table.spread >= NO_TABLE).any():
        return None
    colour = np.median(rgb[bare], axis=0)
    if ((rgb.mean(axis=-1) > _BRIGHTER * colour.mean()) & valid).mean() > _LARGE:
        return None  # what was taken for the table is something darker round it
    gain = _gain(colour, np.percentile(rgb[valid], 99, axis=0))
    shadows = None if table.height_m is None else _find_shadows(rgb, _colour_of(table), table, valid)
    if shadows is None and np.abs(np.log(gain)).max() < 0.005:
        return None
    lit = picture.rgb.astype(np.float32)
    if shadows is not None:
        lit = _without_shadows(lit, picture, _colour_of(table), shadows)
    return np.clip(np.rint(lit * gain.astype(np.float32)), 0, 255).astype(np.uint8)


def _small(picture: Picture) -> tuple[Array, Array | None, Array]:
    """Colours, depth and valid pixels at the size at which light is measured."""
    width, height = picture.size_px
    share = min(1.0, _SIDE / max(width, height))
    size = (max(1, round(width * share)), max(1, round(height * share)))
    rgb = cv2.resize(np.ascontiguousarray(picture.rgb), size, interpolation=cv2.INTER_AREA)
    depth = None
    if picture.depth_m is not None:
        depth = cv2.resize(np.asarray(picture.depth_m), size, interpolation=cv2.INTER_NEAREST)
    box, (columns, rows) = picture.frame.valid, ((np.arange(side) + 0.5) / share for side in size)
    valid = ((rows > box.y0) & (rows < box.y1))[:, None] & ((columns > box.x0) & (columns < box.x1))[None, :]
    return rgb, depth, valid


def _colour_of(table: Table) -> Array:
    """The table's own colour at each pixel, RGB 0 to 255, shape (H, W, 3)."""
    return np.asarray(np.clip(cv2.cvtColor(table.surface.astype(np.float32), cv2.COLOR_LAB2RGB), 0.02, 1) * 255)


def _share(value: float, bounds: tuple[float, float]) -> float:
    """0 up to the first bound, 1 from the second on."""
    return float(np.clip((value - bounds[0]) / (bounds[1] - bounds[0]), 0, 1))


def _gain(colour: Array, brightest: Array) -> Array:
    """Factor per channel that takes the light's colour out, shape (3,).

    Args:
        colour: The table's, RGB.
        brightest: What the brightest surfaces reach in each channel; nothing reflects more than all light.
    """
    tint = np.log(np.maximum(colour, 1.0) / _TABLE)
    level = float(tint.mean())
    tint = tint - level
    strength = float(np.abs(tint).max())
    fades = (1 - _share(strength, _STRONGEST)) * (1 - _share(-level, _DARK))
    gain = np.exp(-tint * fades * _share(strength, _OWN_COLOUR))
    gain *= math.exp(max(-level, 0.0) * fades * _share(strength, _DIM))
    return np.asarray(np.minimum(gain, np.maximum(255 / np.maximum(brightest, 1.0), np.minimum(gain, 1.0))))


def _find_shadows(rgb: Array, table_rgb: Array, table: Table, valid: Array) -> _Shadows | None:
    """The lamp whose shadows, as heights predict them, are the dark parts of the table; None without one."""
    assert table.height_m is not None
    assert table.raised is not None
    height = np.nan_to_num(table.height_m)
    level = valid & (np.abs(height) < RAISED_M)
    less = _less_light(rgb, table_rgb)
    dark = level & (less > _DARKEST) & (less < _LIGHTEST)
    dark = cv2.morphologyEx(dark.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)) > 0
    lit = level & (less >= _LIGHTEST)
    if not table.raised.any() or dark.sum() < 0.05 * table.raised.sum():
        return None
    top = float(height[table.raised & valid].max())
    far = float(cv2.distanceTransform((~table.raised).astype(np.uint8), cv2.DIST_L2, 3)[dark].max())
    best, shared = (0.0, far / top), 0.0
    # From all directions to a third of a degree; coarsely at half the size.
    for stride, turn, stretch in ((2, 15.0, 0.2), (2, 5.0, 0.1), (1, 2.0, 0.04), (1, 0.7, 0.015)):
        turns = range(24) if shared == 0 else range(-2, 3)
        around, length = best
        tried = {}
        for way_deg in (around + turn * k for k in turns):
            for reach in (length * (1 + stretch * k) for k in (-2, -1, 0, 1, 2)):
                part = np.s_[::stride, ::stride]
                shade = _shaded(height[part], _along(way_deg, reach / stride), top) & (dark | lit)[part]
                tried[way_deg, reach] = float((shade & dark[part]).sum() / max((shade | dark[part]).sum(), 1))
        best = max(tried, key=tried.__getitem__)
        shared = tried[best]
    if shared < _AGREES:
        return None
    seen = dark & _shaded(height, _along(*best), top)
    left = float(np.median(less[seen]))
    if np.median(np.abs(less[seen] - left)) > _EVEN:
        return None  # a grey thing's texture, not one shade of the table
    return _Shadows(_along(best[0], best[1] / rgb.shape[1]), left)


def _along(way_deg: float, length: float) -> tuple[float, float]:
    return length * math.cos(math.radians(way_deg)), length * math.sin(math.radians(way_deg))


def _less_light(rgb: Array, table_rgb: Array) -> Array:
    """The share of the table's light that each pixel shows, shape (H, W); 0 where it is of another colour."""
    ratio = rgb.astype(np.float32) / table_rgb
    mean = ratio.mean(axis=-1)
    return np.where(np.abs(ratio - mean[..., None]).max(axis=-1) < _SAME_HUE, mean, 0.0)


def _shaded(height_m: Array, reach: tuple[float, float], top: float) -> Array:
    """Pixels that the lamp does not reach, because something stands in its way, bool.

    Args:
        height_m: Over the table, shape (H, W).
        reach: Way of a shadow per metre of height [px/m], right and down.
        top: The highest thing [m].
    """
    steps = max(1, math.ceil(float(np.hypot(*reach)) * top))
    shaded = np.zeros(height_m.shape, dtype=bool)
    for step in range(1, steps + 1):
        rise = top * step / steps
        dx, dy = (round(way * rise) for way in reach)
        if abs(dx) >= height_m.shape[1] or abs(dy) >= height_m.shape[0]:
            break
        (to_x, from_x), (to_y, from_y) = _overlap(dx, height_m.shape[1]), _overlap(dy, height_m.shape[0])
        shaded[to_y, to_x] |= height_m[from_y, from_x] > height_m[to_y, to_x] + rise
    return shaded


def _overlap(shift: int, side: int) -> tuple[slice, slice]:
    """Where a row moved by `shift` comes to lie, and what of it does."""
    return slice(max(0, shift), min(side, side + shift)), slice(max(0, -shift), min(side, side - shift))


def _without_shadows(rgb: Array, picture: Picture, table_rgb: Array, shadows: _Shadows) -> Array:
    """A picture's pixels [RGB 0 to 255] with the light that shadows lack given back."""
    assert picture.depth_m is not None
    width, height = picture.size_px
    heights = height_above_table(np.asarray(picture.depth_m), np.ones((height, width), dtype=bool))
    if heights is None:
        return rgb
    heights = np.nan_to_num(heights)
    reach = (shadows.reach[0] * width, shadows.reach[1] * width)
    shade = _shaded(heights, reach, float(heights.max()))
    out = rgb.copy()
    out[shade] /= shadows.left
    # On the table itself what is seen decides, half-lit edges included.
    whole = cv2.resize(table_rgb.astype(np.float32), (width, height), interpolation=cv2.INTER_LINEAR)
    level = np.abs(heights) < RAISED_M
    less = _less_light(rgb, whole)
    near = cv2.dilate(shade.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    bare = level & near & (less > shadows.left - 0.1) & (less < 1.2)
    out[bare] = rgb[bare] / less[bare][:, None]
    return out
