"""Ways in which a model may resize pictures before it counts pixels, as the answers to known marks suggest them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.lab.regress import repeated_median_slope
from wonderful_team.models.conventions import CONVENTIONS, Resize, Size

MULTIPLES = (1, 14, 16, 28, 32)
"""Patch sizes of common vision encoders, alone or merged in pairs [px]."""
KNOWN_SIDES = (
    336,
    384,
    448,
    512,
    560,
    640,
    672,
    720,
    768,
    800,
    896,
    960,
    1000,
    1008,
    1024,
    1120,
    1280,
    1344,
    1536,
    1568,
)
"""Round limits, preferred to odd ones that explain the answers as well [px]."""
_SHRUNK, _ENLARGED = 0.985, 1.015
_LEAST, _MOST = 0.1, 10.0
"""A model that counts pixels has between so many of them per pixel sent."""
_REACH = 0.035
"""How far round an estimate is searched."""

_ROUND_SLACK, _AREA_SLACK = 1.04, 1.01
"""Options whose loss is larger than the least by at most this factor are as good."""

Seen = tuple[Size, Array, Array]
"""A picture's size, the true points, and what was said, x first."""


def candidate_resizes(seen: Sequence[Seen]) -> list[Resize]:
    """Resizes worth trying, the likely ones first; each differs from "none" on at least one of the pictures."""
    sizes = [size for size, _, _ in seen]
    found = [row.resize for row in CONVENTIONS.values() if row.resize is not None]
    found += [Resize(multiple=multiple) for multiple in MULTIPLES[1:]]
    factors = [factor for factor in map(_factors, seen) if factor is not None]
    if len(factors) == len(seen) and all(_LEAST < factor < _MOST for pair in factors for factor in pair):
        found += _measured(sizes, factors, seen)
    unlike = [resize for resize in found if any(resize.size(size) != size for size in sizes)]
    return list(dict.fromkeys(unlike))


def _factors(seen: Seen) -> tuple[float, float] | None:
    """The model's pixels per pixel along x and y, as the answers alone say."""
    _, points, said = seen
    there = np.isfinite(said).all(axis=1)
    if there.sum() < 4:
        return None
    slopes = [repeated_median_slope(points[there, k], said[there, k]) for k in (0, 1)]
    return (
        None if any(slope is None or slope <= 0 for slope in slopes) else (float(slopes[0] or 0), float(slopes[1] or 0))
    )


def _measured(sizes: Sequence[Size], factors: Sequence[tuple[float, float]], seen: Sequence[Seen]) -> list[Resize]:
    """Limits on side and area that the measured factors suggest, taken as they are and relative to the least resized."""
    means = np.array([float(np.sqrt(fx * fy)) for fx, fy in factors])
    found: list[Resize] = []
    units = [1.0]
    if not any(_SHRUNK <= mean <= _ENLARGED for mean in means):
        # No picture is left as it is: perhaps all numbers are scaled as well.
        units += [float(means.max()), float(means[int(np.argmin([w * h for w, h in sizes]))])]
    for unit in dict.fromkeys(units):
        relative = means / unit
        shrunk = [k for k, factor in enumerate(relative) if factor < _SHRUNK]
        enlarged = [k for k, factor in enumerate(relative) if factor > _ENLARGED]
        if unit == 1.0:
            side = float(np.median([max(size) * factor for size, factor in zip(sizes, means, strict=True)]))
            found += _closest([Resize(longest_side=s, always=True) for s in _sides(side)], unit, seen)
        if shrunk:
            side = float(np.median([max(sizes[k]) * relative[k] for k in shrunk]))
            found += _closest([Resize(longest_side=s) for s in _sides(side)], unit, seen)
        area = [float(np.median([sizes[k][0] * sizes[k][1] * relative[k] ** 2 for k in group])) if group else None for group in (shrunk, enlarged)]  # fmt: skip
        for multiple in MULTIPLES if shrunk or enlarged else ():
            options = [
                Resize(max_pixels=most, min_pixels=least, multiple=multiple)
                for most in _areas(area[0], multiple)
                for least in _areas(area[1], multiple)
                if most is None or least is None or least < most
            ]
            found += _closest(options, unit, seen)
    return found


def _sides(side: float) -> list[int]:
    near = [known for known in KNOWN_SIDES if abs(known / side - 1) < _REACH]
    low, high = int(side * (1 - _REACH)), int(side * (1 + _REACH)) + 1
    return near + list(range(max(28, low), high + 1, max(1, (high - low) // 60)))


def _areas(area: float | None, multiple: int) -> list[int | None]:
    if area is None:
        return [None]
    # Sides are rounded down to the multiple, so that the limit itself may lie well above the area seen.
    reach = _REACH + 2 * multiple / float(np.sqrt(area))
    return [int(value) for value in np.linspace(area * (1 - _REACH), area * (1 + reach), 25)]


def _closest(options: Sequence[Resize], unit: float, seen: Sequence[Seen]) -> list[Resize]:
    """The one option that fits best; of equal ones the first, which for areas is the smallest limit.

    A smaller limit is the safe side: what is sent within it, the model leaves as it is.
    """
    if not options:
        return []
    by_sizes: dict[tuple[Size, ...], float] = {}
    losses = []
    for option in options:
        sizes = tuple(option.size(size) for size, _, _ in seen)
        if sizes not in by_sizes:
            by_sizes[sizes] = _loss(sizes, unit, seen)
        losses.append(by_sizes[sizes])
    least = min(losses)
    slack = _ROUND_SLACK if options[0].longest_side is not None else _AREA_SLACK
    return [next(option for option, loss in zip(options, losses, strict=True) if loss <= least * slack + 1e-4)]


def _loss(resized: Sequence[Size], unit: float, seen: Sequence[Seen]) -> float:
    """Mean squared error over all marks, an offset per axis left free [per mille of the diagonal, squared]."""
    off = []
    for (size, points, said), new in zip(seen, resized, strict=True):
        factor = np.asarray(new) / np.asarray(size) * unit
        off.append((said - points * factor) / factor * (1000.0 / float(np.hypot(*size))))
    left = np.concatenate(off)
    left = left[np.isfinite(left).all(axis=1)]
    left = left - np.median(left, axis=0)
    return float(np.mean(np.minimum(left**2, 40.0**2)))
