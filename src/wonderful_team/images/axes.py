"""Labelled axes along a picture's edges, inside the picture, so that pixel coordinates of the sent picture stay exact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Axes, Point
from wonderful_team.images.canvas import WHITE, Canvas


class Ticks(Enum):
    """What the numbers along the axes mean: pixels, or shares of the picture's width and height."""

    PIXELS = "pixels"
    THOUSANDTHS = "thousandths"
    PERCENT = "percent"
    UNIT = "unit"


SPANS: dict[Ticks, float] = {Ticks.THOUSANDTHS: 1000.0, Ticks.PERCENT: 100.0, Ticks.UNIT: 100.0}
"""The number at the far edge; shares from 0 to 1 are counted in hundredths and written as 0.05."""


@dataclass(frozen=True)
class Tick:
    """One tick: the number written and where it stands along its axis [picture px]."""

    value: int
    at_px: float


def axis_step(frame: Frame, axes: Axes, ticks: Ticks, axis: int, spacing_px: float) -> int:
    """The round step of one axis that keeps its ticks at least `spacing_px` [picture px] apart."""
    low, high = _ends(frame, axes, ticks, axis)
    return round_step(spacing_px * (high - low) / frame.size_px[axis])


def axis_ticks(frame: Frame, axes: Axes, ticks: Ticks, axis: int, step: int) -> list[Tick]:
    """Ticks of one axis at the multiples of a step, from the low to the high end, inside the picture.

    Args:
        frame: The picture's own frame.
        axes: Which frame's pixels the labels name.
        ticks: Pixels or thousandths of that frame's picture.
        axis: 0 for x, 1 for y.
        step: Distance of the numbers.
    """
    low, high = _ends(frame, axes, ticks, axis)
    per_px = (high - low) / frame.size_px[axis]
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    end_px = float(frame.size_px[axis])
    return [Tick(k * step, min(max((k * step - low) / per_px, 0.0), end_px)) for k in range(first, last + 1)]


def _ends(frame: Frame, axes: Axes, ticks: Ticks, axis: int) -> tuple[float, float]:
    """The numbers at the low and the high end of an axis."""
    end = float(frame.size_px[axis])
    return _label_of(frame, axes, ticks, axis, 0.0), _label_of(frame, axes, ticks, axis, end)


def round_step(least: float) -> int:
    """The smallest of 1, 2, 5, 10, 20, 25, 50, 100, … that is at least `least`."""
    power = 10 ** max(0, math.floor(math.log10(max(least, 1e-9))))
    for factor in (1, 2, 2.5, 5, 10, 20, 25):
        step = factor * power
        if step >= least - 1e-9 and step == int(step) and step >= 1:
            return int(step)
    return int(50 * power)


def draw_axes(canvas: Canvas, frame: Frame, axes: Axes, ticks: Ticks) -> None:
    """Ticks on all four edges, numbers along the top (x) and the left edge (y), each centred on its tick."""
    width, height = canvas.size_px
    font = canvas.font_px
    digits = 4 if ticks is Ticks.UNIT else len(str(_largest(frame, axes, ticks)))
    wide = canvas.plate_size("0" * digits, font)[0]
    tall = canvas.plate_size("0", font)[1]
    least = (max(wide * 1.35, 40 * canvas.unit), max(tall * 2.0, 40 * canvas.unit))
    step = max(axis_step(frame, axes, ticks, axis, least[axis]) for axis in (0, 1))
    across, down = (axis_ticks(frame, axes, ticks, axis, step) for axis in (0, 1))
    long = max(5, round(7 * canvas.unit))
    lines = [
        line
        for axis, row in enumerate((across, down))
        for tick in row
        for line in _tick_lines(canvas, tick, axis, long)
    ]
    canvas.lines(lines, WHITE, width_px=max(1, canvas.stroke_px - 1))
    if axes.reference is None:
        canvas.plate("0", 0, 0, font_px=font)
    for tick in across:
        text = _written(tick.value, ticks)
        plate_width, _ = canvas.plate_size(text, font)
        _label(canvas, text, round(tick.at_px - plate_width / 2), long, font)
    for tick in down:
        text = _written(tick.value, ticks)
        _, plate_height = canvas.plate_size(text, font)
        _label(canvas, text, long, round(tick.at_px - plate_height / 2), font)


def _label(canvas: Canvas, text: str, x0: int, y0: int, font: int) -> None:
    """A number on its plate, or nothing where it would leave the picture or cover another number."""
    plate_width, plate_height = canvas.plate_size(text, font)
    x1, y1 = x0 + plate_width, y0 + plate_height
    width, height = canvas.size_px
    inside = x0 >= 0 and y0 >= 0 and x1 <= width and y1 <= height
    if inside and not any(x0 < c and a < x1 and y0 < d and b < y1 for a, b, c, d in canvas.taken):
        canvas.plate(text, x0, y0, font_px=font)


def _tick_lines(canvas: Canvas, tick: Tick, axis: int, long: int) -> list[list[Point]]:
    side = canvas.size_px[1 - axis]
    at = min(max(tick.at_px, 0.5), canvas.size_px[axis] - 0.5)
    spans = ((0.0, float(long)), (float(side - long), float(side)))
    if axis == 0:
        return [[(at, start), (at, end)] for start, end in spans]
    return [[(start, at), (end, at)] for start, end in spans]


def _label_of(frame: Frame, axes: Axes, ticks: Ticks, axis: int, at_px: float) -> float:
    """The number that belongs to a place along one axis of the picture."""
    value, length = at_px, frame.size_px[axis]
    if axes.reference is not None:
        point = (at_px, 0.0) if axis == 0 else (0.0, at_px)
        value = axes.reference.point_to_picture(frame.point_to_view(point))[axis]
        length = axes.reference.size_px[axis]
    return value if ticks is Ticks.PIXELS else value / length * SPANS[ticks]


def _largest(frame: Frame, axes: Axes, ticks: Ticks) -> int:
    if ticks is not Ticks.PIXELS:
        return int(SPANS[ticks])
    return max((axes.reference or frame).size_px)


def _written(value: int, ticks: Ticks) -> str:
    """A tick's number as it is written."""
    return f"{value / SPANS[ticks]:g}" if ticks is Ticks.UNIT else str(value)
