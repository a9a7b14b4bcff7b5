"""The arrows of a plan's steps: a colour and a bow for each, so that no two lie on each other, its number where it starts."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from wonderful_team.core.pictures import Point
from wonderful_team.images.canvas import BLUE, GREEN, INK, PURPLE, SKY, VERMILLION, WHITE, YELLOW, Canvas, Colour
from wonderful_team.images.placing import PointLabel

STEP_COLOURS: tuple[Colour, ...] = (GREEN, BLUE, PURPLE, SKY, YELLOW, VERMILLION)
"""Taken in turn by the steps; the boxes of targets are orange."""
_DARK = frozenset({GREEN, BLUE, VERMILLION})
BOW = 0.14
"""How far an arrow bows out, as a share of its length."""
_MORE = 0.7
"""How much farther each further arrow between the same two places bows."""
_SAME_PX = 12.0
"""Ends nearer than this are the same place."""
_POINTS = 25


def step_colour(number: int) -> Colour:
    """The colour of a step, counted from 1."""
    return STEP_COLOURS[(number - 1) % len(STEP_COLOURS)]


def bows(paths: Sequence[Sequence[Point]], size_px: tuple[int, int], bowed: Sequence[bool]) -> list[list[Point]]:
    """Paths between two points as bows to the left of their way, so that there and back part; others stay as they are.

    Of several between the same places each bows farther; none bows out of the picture.
    """
    drawn: list[list[Point]] = []
    for k, path in enumerate(paths):
        if len(path) != 2 or not bowed[k]:  # noqa: PLR2004  a start and an end
            drawn.append(list(path))
            continue
        before = sum(_same(path, other) for other, bow in zip(paths[:k], bowed, strict=False) if bow)
        drawn.append(_bow(path[0], path[1], BOW * (1 + _MORE * before), size_px))
    return drawn


def _same(path: Sequence[Point], other: Sequence[Point]) -> bool:
    return len(other) == len(path) and all(math.dist(one, two) < _SAME_PX for one, two in zip(path, other, strict=True))


def _bow(start: Point, end: Point, share: float, size_px: tuple[int, int]) -> list[Point]:
    (xa, ya), (xb, yb) = start, end
    dx, dy = xb - xa, yb - ya
    if math.hypot(dx, dy) < 1e-6:
        return [start, end]
    steps = np.linspace(0.0, 1.0, _POINTS)[:, None]
    straight = (1 - steps) * (xa, ya) + steps * (xb, yb)
    out = 4 * steps * (1 - steps) * (dy, -dx)  # the middle moves by the whole way across
    while share > 0.01:
        curve = straight + share * out
        if ((curve >= 2) & (curve <= np.array(size_px) - 2)).all():
            break
        share *= 0.7
    return [(float(x), float(y)) for x, y in straight + share * out]


def draw_arrows(canvas: Canvas, paths: Sequence[Sequence[Point]], numbers: Sequence[int] = ()) -> None:
    """Lines in the colours of their steps (numbered from 1 on when left out) with a dot where each starts and a head at its end.

    All heads come last, so that a step that starts where another ends hides no head. Plates placed later keep off both.
    """
    head = 6.0 * canvas.stroke_px
    numbered = zip(numbers or range(1, len(paths) + 1), paths, strict=True)
    coloured = [(path, step_colour(number)) for number, path in numbered]
    for path, colour in coloured:
        if len(path) > 1:
            canvas.polyline(path, colour, width_px=canvas.stroke_px + 1, halo=WHITE)
        for point in path:
            canvas.keep_clear(point, canvas.stroke_px * 1.5)
    for path, colour in coloured:
        canvas.disc(path[0], canvas.stroke_px * 1.6, colour, WHITE)
    for path, colour in coloured:
        if len(path) > 1:
            canvas.arrow_head(_before_tip(path, head), path[-1], colour, head)
            canvas.keep_clear(path[-1], head)


def _before_tip(path: Sequence[Point], length: float) -> Point:
    """The last point of the path that is about a head's length away from its end: the head points along the curve."""
    tip = path[-1]
    return next((point for point in reversed(path[:-1]) if math.dist(point, tip) >= length), path[0])


def start_label(canvas: Canvas, path: Sequence[Point], text: str, colour: Colour) -> PointLabel:
    """The number of a step beside the point where its arrow starts."""
    ink = WHITE if colour in _DARK else INK
    return PointLabel(path[0], text, 2.0 * canvas.stroke_px, colour, ink, off_things=True)
