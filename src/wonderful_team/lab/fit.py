"""Which numbers does a model use for places? A robust fit over marks whose true places are known.

Tried are both orders, all units, and many ways in which a model may resize a picture before it counts pixels; for each,
scale and offset by least squares. Points on the wrong thing are held out as outliers, numbers that a model clamps are left
out of the fit. The simplest hypothesis that explains the answers is taken; when none does, the fit says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.lab.regress import Line, clamp_bounds, robust_line
from wonderful_team.lab.resizes import candidate_resizes
from wonderful_team.models.conventions import SPANS, Convention, Order, Resize, Shape, Size, Unit

REFERENCE_PX = 1000.0
"""Residuals of pictures of different sizes are compared as if each diagonal had this length."""
WILD = 0.04
"""An answer further off than this share of the diagonal points at something else."""
GOOD_MEDIAN = 0.015
"""Most that the median residual of a usable convention may be, as a share of the diagonal (12 px at 640 x 480)."""
LEAST_INLIERS = 0.7
"""Least share of the answered marks that a usable convention must explain."""
LEAST_PER_PICTURE = 0.5
"""Least share of one picture's answers that it must explain."""
LEAST_ANSWERED = 0.6
"""Least share of the marks that must have been answered at all."""
LEAST_MARKS = 8
"""Fewer answers than this decide nothing."""
_FLOOR = 0.6
"""Differences below this (per mille of the diagonal) are rounding and decide nothing between hypotheses."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """One picture's marks and what the model said.

    Attributes:
        size_px: Width and height of the picture as it was sent.
        points_px: True places, shape (N, 2).
        said: The model's two numbers in its own order, shape (N, 2); NaN where it gave none.
    """

    size_px: Size
    points_px: Array
    said: Array

    def __post_init__(self) -> None:
        points, said = (np.asarray(values, dtype=float).reshape(-1, 2) for values in (self.points_px, self.said))
        if points.shape != said.shape:
            raise ValueError(f"sighting: {len(points)} points but {len(said)} answers")
        object.__setattr__(self, "points_px", points)
        object.__setattr__(self, "said", said)


@dataclass(frozen=True)
class Fit:
    """The convention that explains the answers best, and how well it does.

    Attributes:
        good: It may be relied on. When False, `why` says in words what is wrong, and `convention` must not be used.
        asked, answered, outliers: Marks; outliers are answered more than WILD of the diagonal off.
        median_px, p90_px, worst_px: Residual over the marks that are no outliers [px of the pictures sent].
        clamped: The numbers that the model never passes (low, high; None where it has no such end), or None.
    """

    convention: Convention
    good: bool
    why: str
    asked: int
    answered: int
    outliers: int
    median_px: float
    p90_px: float
    worst_px: float
    clamped: tuple[float | None, float | None] | None = None


@dataclass(frozen=True)
class _Marks:
    """All answered marks as flat arrays."""

    points: Array  # (N, 2) px
    said: Array  # (N, 2)
    sizes: Array  # (N, 2) px
    per_mille: Array  # (N,): residual px -> per mille of the diagonal


@dataclass(frozen=True)
class _Trial:
    """One hypothesis at its best."""

    convention: Convention
    evidence: float
    residual: Array  # (N,) px, clamped marks 0
    held: Array  # (N,) bool: clamped marks
    held_numbers: Array  # (N, 2) bool: clamped numbers, in the model's order


def fit_convention(
    sightings: Sequence[Sighting], *, guess: Convention | None = None, shape: Shape | None = None
) -> Fit:
    """The convention behind answers to known marks.

    Args:
        sightings: Best three pictures or more, of different sizes and aspects.
        guess: A convention to prefer when it explains the answers as well as any other.
        shape: How the model writes points and boxes; taken over.
    """
    asked = sum(len(sighting.said) for sighting in sightings)
    marks = _gathered(sightings)
    answered = len(marks.said)
    nothing = Convention("probed", shape=shape or Shape())
    if answered < max(LEAST_MARKS, LEAST_ANSWERED * asked):
        why = f"only {answered} of {asked} marks were answered"
        return Fit(nothing, False, why, asked, answered, 0, np.inf, np.inf, np.inf)
    best = min(_trials(sightings, marks, guess), key=lambda trial: trial.evidence)
    return _judged(replace(best.convention, name=nothing.name, shape=nothing.shape), best, marks, asked)


def _judged(convention: Convention, best: _Trial, marks: _Marks, asked: int) -> Fit:
    share = best.residual * marks.per_mille / REFERENCE_PX
    near = share <= WILD
    kept = best.residual[near & ~best.held]
    answered, outliers = len(share), int((~near).sum())
    median = float(np.median(kept)) if len(kept) else np.inf
    p90, worst = (float(np.quantile(kept, q)) if len(kept) else np.inf for q in (0.9, 1.0))
    middle = float(np.median(share[near])) if near.any() else np.inf
    why = ""
    if near.mean() < LEAST_INLIERS:
        why = f"no convention explains more than {int(near.sum())} of {answered} answers"
    elif (strange := _strange_sizes(near, marks)) != "":
        why = f"no convention explains the answers for pictures of {strange} px together with the others"
    elif middle > GOOD_MEDIAN:
        why = f"half the answers are more than {100 * middle:.1f} % of the diagonal off (limit {100 * GOOD_MEDIAN:g} %)"
    elif best.held.mean() > 0.4:
        why = f"{int(best.held.sum())} of {answered} answers lie at the end of the model's range"
    clamped = clamp_bounds(marks.said, best.held_numbers)
    return Fit(convention, not why, why, asked, answered, outliers, median, p90, worst, clamped)


def _strange_sizes(near: Array, marks: _Marks) -> str:
    """Sizes of pictures of which less than LEAST_PER_PICTURE of the answers are explained; "" when there are none."""
    strange = [
        f"{size[0]:.0f} x {size[1]:.0f}"
        for size in np.unique(marks.sizes, axis=0)
        if near[(marks.sizes == size).all(axis=1)].mean() < LEAST_PER_PICTURE
    ]
    return ", ".join(strange)


def _gathered(sightings: Sequence[Sighting]) -> _Marks:
    rows = [(s, np.isfinite(s.said).all(axis=1)) for s in sightings]
    points = np.concatenate([s.points_px[there] for s, there in rows] or [np.empty((0, 2))])
    said = np.concatenate([s.said[there] for s, there in rows] or [np.empty((0, 2))])
    sizes = np.concatenate([np.tile(np.asarray(s.size_px, float), (there.sum(), 1)) for s, there in rows])
    return _Marks(points, said, sizes, REFERENCE_PX / np.linalg.norm(sizes, axis=1))


def _trials(sightings: Sequence[Sighting], marks: _Marks, guess: Convention | None) -> list[_Trial]:
    trials = []
    for order in _orders(marks):
        forms: list[tuple[Unit, Resize | None]] = [(unit, None) for unit in SPANS]
        ordered = [_straight(sighting, order) for sighting in sightings]
        forms += [
            ("pixels", resize) for resize in candidate_resizes([(s.size_px, s.points_px, s.said) for s in ordered])
        ]
        if guess is not None and guess.resize is not None:
            forms.append((guess.unit, guess.resize))
        for unit, resize in forms:
            trials += _best(order, unit, resize, marks, guess)
    return trials


def _orders(marks: _Marks) -> list[Order]:
    """Orders worth trying: both, unless the numbers follow one of them and not the other."""
    shares = marks.points / marks.sizes
    follows = [
        float(np.mean([_follows(shares[:, k], marks.said[:, k if order == "xy" else 1 - k]) for k in (0, 1)]))
        for order in ("xy", "yx")
    ]
    both: list[Order] = ["xy", "yx"]
    return [order for order, value in zip(both, follows, strict=True) if value > max(follows) - 0.3]


def _follows(places: Array, said: Array) -> float:
    """Rank correlation of numbers with places."""
    ranks: list[Array] = [np.argsort(np.argsort(values)).astype(np.float64) for values in (places, said)]
    off = [rank - rank.mean() for rank in ranks]
    return float(off[0] @ off[1] / np.sqrt((off[0] @ off[0]) * (off[1] @ off[1])))


def _straight(sighting: Sighting, order: Order) -> Sighting:
    return sighting if order == "xy" else Sighting(sighting.size_px, sighting.points_px, sighting.said[:, ::-1])


def _best(order: Order, unit: Unit, resize: Resize | None, marks: _Marks, guess: Convention | None) -> list[_Trial]:
    """The hypothesis without errors, and with a scale, an offset (in its unit or in px), or both."""
    plain = Convention("trial", order, unit, resize)
    said = marks.said if order == "xy" else marks.said[:, ::-1]
    spans = {tuple(size): plain.span((int(size[0]), int(size[1]))) for size in np.unique(marks.sizes, axis=0)}
    per_px = np.array([spans[tuple(size)] for size in marks.sizes]) / marks.sizes
    lost = (
        0.0
        if resize is None
        else 1.0 + (resize.multiple > 1) + (resize.max_pixels is not None and resize.min_pixels is not None)
    )
    trials = []
    for scaled, shift in ((False, ""), (True, ""), (False, "unit"), (False, "px"), (True, "unit"), (True, "px")):
        lines = [
            robust_line(
                marks.points[:, k] * per_px[:, k],
                said[:, k],
                per_px[:, k],
                marks.per_mille,
                marks.sizes[:, k] * per_px[:, k],
                scaled,
                shift,
            )  # fmt: skip
            for k in (0, 1)
        ]
        if any(line is None or not 0.02 < line.scale < 50 for line in lines):
            continue
        first, second = (line for line in lines if line is not None)
        trial = _scored(plain, (first, second), marks, said, per_px)
        cost = lost + 2 * scaled + 2 * bool(shift)
        if guess is not None and (guess.order, guess.unit, guess.resize) == (order, unit, resize):
            cost -= 1.0
        # Of units that differ by a scale alone, the one that needs the least.
        cost += 0.01 * abs(float(np.log(first.scale * second.scale)))
        trials.append(replace(trial, evidence=trial.evidence + cost * float(np.log(2 * len(said)))))
    return trials


def _scored(plain: Convention, lines: tuple[Line, Line], marks: _Marks, said: Array, per_px: Array) -> _Trial:
    convention = replace(
        plain,
        scale=(lines[0].scale, lines[1].scale),
        offset=(lines[0].offset, lines[1].offset),
        offset_px=(lines[0].offset_px, lines[1].offset_px),
    )
    off = np.stack([line.residual / (line.scale * per_px[:, k]) for k, line in enumerate(lines)], axis=1)
    held = lines[0].held | lines[1].held
    numbers = np.stack([lines[0].held, lines[1].held], axis=1)
    off = np.where(numbers, 0.0, off)
    scaled = np.abs(off) * marks.per_mille[:, None]
    loss = np.mean(np.minimum(scaled, WILD * REFERENCE_PX) ** 2)
    evidence = 2 * len(said) * float(np.log(loss + _FLOOR**2))
    in_order = numbers if plain.order == "xy" else numbers[:, ::-1]
    return _Trial(convention, evidence, np.linalg.norm(off, axis=1), held, in_order)
