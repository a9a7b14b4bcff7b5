"""The height of the tool and of what it carries along its way, over what depth shows; smallest clearances marked in millimetres."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.pages.legs import Leg, millimetres, touches
from wonderful_team.pages.pictures import text_in_svg

_WIDTH, _HEIGHT = 960, 340
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 14, 30, 44
_SIZE = 12.0
_LETTER = 0.58 * _SIZE
"""Width of a letter, about."""
STEPS = (1, 2, 5)


@dataclass(frozen=True, eq=False)
class _Axes:
    length_m: float
    low_m: float
    high_m: float

    def x(self, along_m: float) -> float:
        return _LEFT + along_m / self.length_m * (_WIDTH - _LEFT - _RIGHT)

    def y(self, z_m: float) -> float:
        return _HEIGHT - _BOTTOM - (z_m - self.low_m) / (self.high_m - self.low_m) * (_HEIGHT - _TOP - _BOTTOM)


def profile_drawing(legs: Sequence[Leg]) -> Markup:
    """All actions of a plan one after another, along the way of the tool."""
    along, total = [], 0.0
    for leg in legs:
        steps = np.linalg.norm(np.diff(leg.points_m, axis=0), axis=1)
        along.append(total + np.concatenate([[0.0], np.cumsum(steps)]))
        total = float(along[-1][-1])
    heights = np.concatenate([_heights(leg, name) for leg in legs for name in ("low_m", "surface_m", "goal_m")])
    heights = np.concatenate([heights[np.isfinite(heights)], [0.0], *(leg.points_m[:, 2] for leg in legs)])
    span = max(0.05, float(heights.max() - heights.min()))
    axes = _Axes(max(total, 1e-3), float(heights.min()) - 0.04 * span, float(heights.max()) + 0.04 * span)
    layers = [_grid(axes)]
    for at, leg in zip(along, legs, strict=True):
        layers += [
            _area(axes, at, _heights(leg, "goal_m"), "ground goal"),
            _area(axes, at, _heights(leg, "surface_m"), "ground"),
        ]
    layers += [_carried(axes, at, leg) for at, leg in zip(along, legs, strict=True)]
    layers += [_line(axes, at, leg.points_m[:, 2], "way") for at, leg in zip(along, legs, strict=True)]
    layers += [_borders(axes, along, legs), _clearances(axes, along, legs)]
    return Markup('<svg class="chart" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>').format(
        _WIDTH,
        _HEIGHT,
        f"Height of the tool along {total:.2f} m of its way, over what is seen",
        Markup("").join(layers),
    )


def _heights(leg: Leg, name: str) -> Array:
    return np.array([np.nan if value is None else value for value in leg.profile[name]], dtype=np.float64)


def _grid(axes: _Axes) -> Markup:
    marks = []
    step = nice_step(axes.high_m - axes.low_m, 6)
    for count in range(math.ceil(axes.low_m / step), math.floor(axes.high_m / step) + 1):
        y = axes.y(count * step)
        marks.append(
            Markup('<line x1="{}" x2="{}" y1="{y}" y2="{y}" class="grid"/>').format(
                _LEFT, _WIDTH - _RIGHT, y=f"{y:.1f}"
            )
        )
        marks.append(text_in_svg(_LEFT - 7, y + 4, f"{1000 * count * step:.0f}", "tick end", _SIZE))
    marks.append(text_in_svg(6, 14, "height in mm", "tick start", _SIZE))
    step = nice_step(axes.length_m, 8)
    digits = max(0, -math.floor(math.log10(step)))
    for count in range(math.floor(axes.length_m / step) + 1):
        marks.append(
            text_in_svg(axes.x(count * step), _HEIGHT - _BOTTOM + 18, f"{count * step:.{digits}f}", "tick", _SIZE)
        )
    marks.append(text_in_svg(_WIDTH - _RIGHT, _HEIGHT - 6, "way of the tool in m", "tick end", _SIZE))
    return Markup("").join(marks)


def nice_step(span: float, most: int) -> float:
    """A step of 1, 2 or 5 times a power of ten, of which at most so many fit into a span."""
    scale = 10.0 ** math.floor(math.log10(max(span, 1e-6) / most))
    return next((step * scale for step in STEPS if span / (step * scale) <= most), 10 * scale)


def _area(axes: _Axes, at: Array, heights: Array, css: str) -> Markup:
    """What is seen, filled down to the lower edge; where nothing is known, nothing is drawn."""
    floor, parts = axes.y(axes.low_m), []
    for first, last in _known(heights):
        xs = [axes.x(float(value)) for value in at[first:last]]
        ys = [axes.y(float(value)) for value in heights[first:last]]
        if len(xs) == 1 or xs[-1] - xs[0] < 1:
            xs, ys = [xs[0] - 0.5, xs[-1] + 0.5], [min(ys), min(ys)]
        top = "L".join(f"{x:.1f} {y:.1f}" for x, y in zip(xs, ys, strict=True))
        parts.append(f"M{xs[0]:.1f} {floor:.1f}L{top}L{xs[-1]:.1f} {floor:.1f}Z")
    return Markup('<path d="{}" class="{}"/>').format("".join(parts), css) if parts else Markup("")


def _known(values: Array) -> list[tuple[int, int]]:
    """Runs of finite values, as (first, one after the last)."""
    known = np.concatenate([[0], np.isfinite(values).astype(int), [0]])
    edges = np.flatnonzero(np.diff(known))
    return [(int(first), int(last)) for first, last in zip(edges[::2], edges[1::2], strict=True)]


def _line(axes: _Axes, at: Array, heights: Array, css: str) -> Markup:
    path = "M" + "L".join(f"{axes.x(float(x)):.1f} {axes.y(float(z)):.1f}" for x, z in zip(at, heights, strict=True))
    return Markup('<path d="{}" class="{}"/>').format(path, css)


def _carried(axes: _Axes, at: Array, leg: Leg) -> Markup:
    """What hangs below the tool, as a band."""
    low, parts = _heights(leg, "low_m"), []
    for first, last in _known(np.where(leg.points_m[:, 2] - low > 1e-4, low, np.nan)):
        there = [
            (axes.x(float(x)), axes.y(float(z)))
            for x, z in zip(at[first:last], leg.points_m[first:last, 2], strict=True)
        ]
        back = [(axes.x(float(x)), axes.y(float(z))) for x, z in zip(at[first:last], low[first:last], strict=True)]
        parts.append("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in [*there, *reversed(back)]) + "Z")
    return Markup('<path d="{}" class="hanging"/>').format("".join(parts)) if parts else Markup("")


def _borders(axes: _Axes, along: Sequence[Array], legs: Sequence[Leg]) -> Markup:
    """Where each action begins, with its number as far as there is room."""
    marks, free = [], -math.inf
    for at, leg in zip(along, legs, strict=True):
        start, end = axes.x(float(at[0])), axes.x(float(at[-1]))
        marks.append(
            Markup('<line x1="{x}" x2="{x}" y1="{}" y2="{}" class="border"/>').format(
                _TOP - 6, _HEIGHT - _BOTTOM, x=f"{start:.1f}"
            )
        )
        name, middle = str(leg.number), (start + end) / 2
        half = _LETTER * len(name) / 2 + 2
        if middle - half > free:
            marks.append(text_in_svg(middle, _TOP - 10, name, "tick", _SIZE))
            free = middle + half
    return Markup("").join(marks)


def _clearances(axes: _Axes, along: Sequence[Array], legs: Sequence[Leg]) -> Markup:
    """The smallest clearance of each action; that of all is drawn stronger, and the others as far as there is room."""
    known = [
        (leg.profile["clearance_m"], float(at[leg.profile["nearest"]]), leg)
        for at, leg in zip(along, legs, strict=True)
        if leg.profile.get("clearance_m") is not None and leg.profile.get("nearest") is not None
    ]
    marks, taken = [], list[tuple[float, float, float, float]]()
    ordered = sorted(known, key=lambda one: (touches(one[2].profile), one[0]))
    for rank, (clearance, at, leg) in enumerate(ordered):
        k, x = leg.profile["nearest"], axes.x(at)
        low = leg.profile["low_m"][k]
        top, foot = axes.y(low), axes.y(low - clearance)
        text = millimetres(clearance)
        # Beside its mark; above one that is too short for that.
        middle = (top + foot) / 2 - (0 if abs(foot - top) > _SIZE else _SIZE + 4)
        place = _free_place(x, middle, _LETTER * len(text) + 6, taken)
        if place is None:
            continue
        taken.append(place)
        css = "least" if rank == 0 else "gap"
        marks.append(
            Markup('<path d="M{x} {a}V{b}M{l} {a}H{r}M{l} {b}H{r}" class="{}"/><rect x="{}" y="{}" width="{}" height="{}" rx="3" class="plate"/>').format(
                css, *(f"{value:.1f}" for value in (place[0], place[1], place[2] - place[0], place[3] - place[1])),
                x=f"{x:.1f}", a=f"{top:.1f}", b=f"{foot:.1f}", l=f"{x - 4:.1f}", r=f"{x + 4:.1f}",
            )
        )  # fmt: skip
        marks.append(text_in_svg((place[0] + place[2]) / 2, place[3] - 4.5, text, f"{css}-label", _SIZE))
    return Markup("").join(marks)


def _free_place(
    x: float, y: float, width: float, taken: Sequence[tuple[float, float, float, float]]
) -> tuple[float, float, float, float] | None:
    """Room for a label near a mark: (x0, y0, x1, y1); None where there is none."""
    height = _SIZE + 6
    for dy in (0.0, -height, height, -2 * height, 2 * height, -3 * height):
        for left in (x + 8, x - 8 - width):
            top = min(max(y - height / 2 + dy, _TOP - 4), _HEIGHT - _BOTTOM - height)
            box = (left, top, left + width, top + height)
            inside = _LEFT <= box[0] and box[2] <= _WIDTH - _RIGHT
            if inside and all(box[2] < o[0] or o[2] < box[0] or box[3] < o[1] or o[3] < box[1] for o in taken):
                return box
    return None
