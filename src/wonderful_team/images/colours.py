"""Names for colours: from CIELAB hue, chroma and lightness to the canonical names that people use.

The borders follow the usual basic colour terms (Berlin & Kay 1969; for CIELAB, Benavente et al. 2008): they are
ranges of hue with soft edges, not a palette.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.images.apart import middle_colour

COLOURS = (
    "red", "orange", "yellow", "green", "cyan", "blue", "purple", "pink", "brown", "olive", "white", "grey", "black",
)  # fmt: skip
"""Canonical colour names; the grammar maps violet, teal, tan, … to them or to a pair of neighbours."""


_HUES: tuple[tuple[str, float, float], ...] = (
    ("red", 2, 47),
    ("orange", 47, 79),
    ("yellow", 79, 108),
    ("green", 108, 172),
    ("cyan", 172, 234),
    ("blue", 234, 309),
    ("purple", 309, 341),
    ("pink", 341, 362),
)
"""CIELAB hue sectors [degrees] of the chromatic names at middle lightness."""

_TYPICAL_L = {
    "red": 50.0, "orange": 68.0, "yellow": 83.0, "green": 56.0, "cyan": 68.0, "blue": 48.0, "purple": 42.0,
    "pink": 72.0, "brown": 42.0, "olive": 52.0, "grey": 58.0, "white": 96.0, "black": 8.0,
}  # fmt: skip
"""Lightness L* at which a colour goes by its bare name; well below it is "dark", well above it "light"."""

_ACHROMATIC = 9.5
"""Chroma C* under which a colour is called white, grey or black."""

_HUE_EDGE = 5.0
"""Half width of a soft border between hue sectors [degrees]."""


@dataclass(frozen=True)
class ColourShare:
    """One colour of a thing.

    Attributes:
        name: Canonical colour.
        share: Part of the thing's surface, 0 to 1.
        lab: Its mean in CIELAB (L 0..100, a, b).
        dark: Degree to which it is dark for its name, 0 to 1.
        light: Degree to which it is light for its name, 0 to 1.
    """

    name: str
    share: float
    lab: tuple[float, float, float]
    dark: float
    light: float

    @property
    def words(self) -> str:
        """Such as "dark blue"."""
        return ("dark " if self.dark > 0.5 else "light " if self.light > 0.5 else "") + self.name


def to_lab(rgb: Array) -> Array:
    """CIELAB of an RGB image: shape (H, W, 3), float32, L 0..100."""
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(rgb).astype(np.float32) / 255.0, cv2.COLOR_RGB2LAB))


def _ramp(value: Array, centre: float | Array, half: float) -> Array:
    """0 below the soft border round `centre`, 1 above it."""
    return np.asarray(np.clip((value - centre) / (2 * half) + 0.5, 0.0, 1.0))


def memberships(lab: Array) -> Array:
    """How well each colour name fits, shape (..., 13) in the order of COLOURS, summing to 1.

    Args:
        lab: CIELAB values, shape (..., 3).
    """
    L, a, b = (np.asarray(lab[..., i], dtype=np.float64) for i in range(3))
    chroma = np.hypot(a, b)
    hue = np.degrees(np.arctan2(b, a)) % 360.0
    # Very dark and very light surfaces need less chroma to look grey; warm greys keep a little.
    limit = _ACHROMATIC + 3.0 * (1 - _ramp(L, 25, 15)) + 2.0 * _ramp(L, 92, 6)
    chromatic = _ramp(chroma, limit, 3.5)
    out = {name: np.zeros_like(L) for name in COLOURS}
    black = 1 - _ramp(L, 21, 5)
    white = _ramp(L, 84, 6)
    out["black"] = (1 - chromatic) * black
    out["white"] = (1 - chromatic) * white
    out["grey"] = (1 - chromatic) * (1 - black) * (1 - white)
    for name, low, high in _HUES:
        shifted = (hue - low + 180.0) % 360.0 - 180.0
        inside = _ramp(shifted, 0, _HUE_EDGE) * (1 - _ramp((hue - high + 180.0) % 360.0 - 180.0, 0, _HUE_EDGE))
        out[name] = out[name] + chromatic * inside
    _split_by_lightness(out, L, chroma, hue)
    stacked = np.stack([out[name] for name in COLOURS], axis=-1)
    return np.asarray(stacked / np.maximum(stacked.sum(axis=-1, keepdims=True), 1e-9))


def _split_by_lightness(out: dict[str, Array], L: Array, chroma: Array, hue: Array) -> None:
    """Names that share a hue and differ by lightness: pink from red, brown from orange, olive from yellow. In place."""
    # Pink: light or pale red; purple-reds need less lightness.
    warm = np.clip((hue + 20.0) % 360.0, 0.0, 70.0) / 70.0
    pink = np.maximum(_ramp(L, 58 + 16 * warm, 5), _ramp(L, 56 + 15 * warm, 5) * (1 - _ramp(chroma, 52, 8)))
    moved = out["red"] * pink
    out["red"], out["pink"] = out["red"] - moved, out["pink"] + moved
    # Dark purplish red: maroon side goes to red, plum side to purple.
    deep = out["pink"] * (1 - _ramp(L, 44, 5))
    plum = _ramp((360.0 - hue) % 360.0, 6, 6) * (hue > 180)
    out["pink"] = out["pink"] - deep
    out["purple"], out["red"] = out["purple"] + deep * plum, out["red"] + deep * (1 - plum)
    # Brown: dim or dull orange and dull warm red.
    dull = 1 - _ramp(chroma, 24 + 0.52 * np.clip(L, 0, 80), 6)
    dim = 1 - _ramp(L, 58, 7)
    brown = np.maximum(dim * np.maximum(dull, 1 - _ramp(L, 44, 5)), (1 - _ramp(chroma, 36, 6)) * (1 - _ramp(L, 82, 6)))
    moved = out["orange"] * brown
    out["orange"], out["brown"] = out["orange"] - moved, out["brown"] + moved
    moved = out["red"] * (1 - _ramp(chroma, 36, 6)) * _ramp(hue * (hue < 180), 24, 6) * (1 - _ramp(L, 60, 5))
    out["red"], out["brown"] = out["red"] - moved, out["brown"] + moved
    # Olive: dark or dull yellow, and the yellow side of dull green.
    olive = 1 - _ramp(L, 66, 6)
    yellowish = 1 - _ramp(hue, 124, 5)
    for name, share in (("yellow", olive), ("green", olive * yellowish * (1 - _ramp(chroma, 48, 8)))):
        moved = out[name] * share
        out[name], out["olive"] = out[name] - moved, out["olive"] + moved
    # Pale yellowish beige reads as brown on its dark side and white on its light side.
    beige = out["yellow"] * (1 - _ramp(chroma, 30, 6))
    light = _ramp(L, 84, 6)
    out["yellow"] = out["yellow"] - beige
    out["brown"], out["white"] = out["brown"] + beige * (1 - light), out["white"] + beige * light


@cache
def _table() -> tuple[Array, Array]:
    """For RGB in steps of 8: the best name's index (32, 32, 32) and all memberships (32, 32, 32, 13)."""
    levels = (np.arange(32) * 8 + 4).astype(np.uint8)
    r, g, b = np.meshgrid(levels, levels, levels, indexing="ij")
    lab = to_lab(np.stack([r, g, b], axis=-1).reshape(1, -1, 3))[0]
    scores = memberships(lab).reshape(32, 32, 32, len(COLOURS)).astype(np.float32)
    return scores.argmax(axis=-1).astype(np.uint8), scores


def name_index(rgb: Array) -> Array:
    """Index into COLOURS of each pixel's best name; same shape without the last axis."""
    quantised = rgb >> 3
    return np.asarray(_table()[0][quantised[..., 0], quantised[..., 1], quantised[..., 2]])


def membership_shares(pixels_rgb: Array) -> dict[str, float]:
    """Mean membership of each colour name over pixels, shape (N, 3) uint8; sums to 1."""
    quantised = pixels_rgb >> 3
    mean = _table()[1][quantised[:, 0], quantised[:, 1], quantised[:, 2]].mean(axis=0)
    return {name: float(value) for name, value in zip(COLOURS, mean, strict=True)}


def darkness(name: str, lab: Array | tuple[float, float, float]) -> tuple[float, float]:
    """How dark and how light a colour is for its name, each 0 to 1."""
    L = float(lab[0])
    typical = _TYPICAL_L[name]
    dark = float(np.clip((0.80 * typical - L) / (0.16 * typical), 0.0, 1.0))
    if name == "blue":  # Full blue has a low L* and a high chroma: not dark.
        dark *= float(np.clip((110.0 - np.hypot(lab[1], lab[2])) / 25.0, 0.0, 1.0))
    light = float(np.clip((L - typical - 0.28 * (100 - typical)) / (0.3 * (100 - typical)), 0.0, 1.0))
    light *= float(np.clip((90.0 - np.hypot(lab[1], lab[2])) / 25.0, 0.0, 1.0))  # vivid is not pale
    return (0.0, 0.0) if name in ("white", "black") else (dark, light)


def colour_shares(pixels_rgb: Array, at_least: float = 0.06) -> tuple[ColourShare, ...]:
    """The colours of a set of pixels, largest share first.

    Args:
        pixels_rgb: Shape (N, 3), uint8, N >= 1.
        at_least: Smaller shares are left out [share].
    """
    index = name_index(pixels_rgb)
    lab = to_lab(pixels_rgb[None])[0]
    found = []
    for number, name in enumerate(COLOURS):
        chosen = index == number
        share = float(chosen.mean())
        if share < at_least:
            continue
        L, a, b = (float(v) for v in np.median(lab[chosen], axis=0))
        found.append(ColourShare(name, share, (L, a, b), *darkness(name, (L, a, b))))
    return tuple(sorted(found, key=lambda colour: -colour.share))


def commonest(rgb: Array) -> Array:
    """The colour that most of a picture has, shape (3,): that of the table or ground."""
    coarse = (rgb >> 4).reshape(-1, 3).astype(np.int32)
    codes = coarse[:, 0] * 256 + coarse[:, 1] * 16 + coarse[:, 2]
    best = int(np.bincount(codes, minlength=4096).argmax())
    return middle_colour(rgb.reshape(-1, 3)[codes == best])
