"""Outlines of things as seen from above: polygons (holes allowed) in a drawing plane, a to the right and b up.

Every outline fits a unit square round the origin; sizes in metres are given where shapes are made of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from shapely import LineString, MultiLineString, Point, Polygon, unary_union
from shapely.affinity import scale, translate
from shapely.geometry.base import BaseGeometry

STROKE = 0.24
"""Width of a letter's stroke, as a share of the letter's height."""


def _regular(corners: int, turn_deg: float = 0.0) -> Polygon:
    angles = [math.radians(90 + turn_deg + 360 * k / corners) for k in range(corners)]
    return Polygon([(0.5 * math.cos(a), 0.5 * math.sin(a)) for a in angles])


def _strokes(*lines: Sequence[tuple[float, float]], width: float = STROKE) -> Polygon:
    """Letters from centre lines with square ends."""
    drawn = [LineString(line).buffer(width / 2, cap_style="flat", join_style="mitre") for line in lines]
    return unary_union(drawn)


def _star() -> Polygon:
    reach = (0.5, 0.235)
    points = [(reach[k % 2], math.radians(90 + 36 * k)) for k in range(10)]
    return Polygon([(r * math.cos(a), r * math.sin(a)) for r, a in points])


def _flower() -> Polygon:
    petals = [Point(0.3 * math.cos(a), 0.3 * math.sin(a)).buffer(0.2) for a in _angles(6)]
    return unary_union([*petals, Point(0, 0).buffer(0.28)])


def _angles(count: int) -> list[float]:
    return [2 * math.pi * k / count + math.pi / 2 for k in range(count)]


def _heart() -> Polygon:
    points = []
    for k in range(72):
        t = 2 * math.pi * k / 72
        a = 16 * math.sin(t) ** 3
        b = 13 * math.cos(t) - 5 * math.cos(2 * t) - 2 * math.cos(3 * t) - math.cos(4 * t)
        points.append((a / 32, b / 32))
    return Polygon(points)


def _letter_g() -> Polygon:
    middle = 0.5 - STROKE / 2
    arc = [(middle * math.cos(math.radians(d)), middle * math.sin(math.radians(d))) for d in range(42, 333, 10)]
    bar = [(0.04, -0.03), (0.5, -0.03)]
    stem = [(0.5 - STROKE / 2, 0.06), (0.5 - STROKE / 2, -0.36)]
    whole = unary_union([_strokes(arc), _strokes(bar, width=0.18), _strokes(stem)])
    return whole.buffer(0.03, join_style="mitre").buffer(-0.03, join_style="mitre")


def _letter_a() -> Polygon:
    outer = Polygon(
        [
            (-0.5, -0.5),
            (-0.14, 0.5),
            (0.14, 0.5),
            (0.5, -0.5),
            (0.24, -0.5),
            (0.16, -0.26),
            (-0.16, -0.26),
            (-0.24, -0.5),
        ]
    )
    return outer.difference(Polygon([(-0.1, -0.07), (0.1, -0.07), (0.0, 0.24)]))


def _letter_r() -> Polygon:
    half = STROKE / 2
    stem = _strokes([(-0.4 + half, -0.5), (-0.4 + half, 0.5)])
    bowl = translate(Point(0, 0).buffer(0.29), 0.1, 0.21).union(
        Polygon([(-0.3, -0.08), (0.1, -0.08), (0.1, 0.5), (-0.3, 0.5)])
    )
    hole = translate(Point(0, 0).buffer(0.1), 0.1, 0.21).union(
        Polygon([(-0.16, 0.11), (0.1, 0.11), (0.1, 0.31), (-0.16, 0.31)])
    )
    leg = Polygon([(-0.08, -0.02), (0.14, -0.5), (0.43, -0.5), (0.18, 0.0)])
    return stem.union(bowl).difference(hole).union(leg)


def _letter_m() -> Polygon:
    return Polygon(
        [(-0.5, -0.5), (-0.5, 0.5), (-0.24, 0.5), (0.0, 0.08), (0.24, 0.5), (0.5, 0.5), (0.5, -0.5), (0.27, -0.5)]
        + [(0.27, 0.1), (0.08, -0.24), (-0.08, -0.24), (-0.27, 0.1), (-0.27, -0.5)]
    )


def _cross() -> Polygon:
    return unary_union([_strokes([(-0.5, 0), (0.5, 0)], width=0.34), _strokes([(0, -0.5), (0, 0.5)], width=0.34)])


def _square() -> Polygon:
    return Polygon([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])


def _rail(height: float) -> list[tuple[float, float]]:
    return [(-0.5, height), (0.5, height)]


OUTLINES: dict[str, Callable[[], BaseGeometry]] = {
    "block": _square,
    "L-shaped block": lambda: Polygon(
        [(-0.4, -0.5), (-0.4, 0.5), (-0.08, 0.5), (-0.08, -0.18), (0.4, -0.18), (0.4, -0.5)]
    ),
    "letter A": _letter_a,
    "letter E": lambda: _strokes(
        [(0.38, 0.4), (-0.28, 0.4), (-0.28, -0.4), (0.38, -0.4)], [(-0.3, 0.0), (0.28, 0.0)], width=0.2
    ),
    "letter G": _letter_g,
    "letter M": _letter_m,
    "letter R": _letter_r,
    "letter T": lambda: _strokes([(-0.46, 0.38), (0.46, 0.38)], [(0, 0.4), (0, -0.5)]),
    "letter V": lambda: Polygon(
        [(-0.5, 0.5), (-0.2, 0.5), (0, -0.12), (0.2, 0.5), (0.5, 0.5), (0.14, -0.5), (-0.14, -0.5)]
    ),
    "cross": _cross,
    "diamond": lambda: scale(_regular(4), 0.72, 1.0),
    "triangle": lambda: _regular(3),
    "flower": _flower,
    "heart": _heart,
    "hexagon": lambda: _regular(6, 30),
    "pentagon": lambda: _regular(5),
    "ring": lambda: Point(0, 0).buffer(0.5).difference(Point(0, 0).buffer(0.26)),
    "round": lambda: Point(0, 0).buffer(0.5),
    "star": _star,
    "square": _square,
    "slats": lambda: MultiLineString([_rail(-0.42), _rail(-0.14), _rail(0.14), _rail(0.42)]).buffer(
        0.09, cap_style="flat", join_style="mitre"
    ),
    "crossbars": lambda: MultiLineString([[(s, -0.5), (s, 0.5)] for s in (-0.42, 0.0, 0.42)]).buffer(
        0.08, cap_style="flat", join_style="mitre"
    ),
}


def outline(name: str, width_m: float) -> BaseGeometry:
    """An outline scaled so that its larger side measures `width_m` [m], its centre of area at the origin."""
    drawn = OUTLINES[name]()
    a0, b0, a1, b1 = drawn.bounds
    middle = drawn.centroid
    moved = translate(drawn, -middle.x, -middle.y)
    factor = width_m / max(a1 - a0, b1 - b0)
    return scale(moved, factor, factor, origin=(0, 0))
