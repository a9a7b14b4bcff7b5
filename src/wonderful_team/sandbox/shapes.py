"""Shapes of paths that a helper function may call inside the sandbox: pure functions of numbers, nothing of this process.

This file's own text is run in the worker before the model's code. Points are pixels, x to the right and y down; angles are degrees,
clockwise as the picture shows them, from straight up. A closed path ends where it begins.
"""

import math


def polygon(centre: tuple[float, float], radius: float, sides: int, turn_deg: float = 0.0) -> list[tuple[float, float]]:
    """A closed regular polygon round a centre (x, y), a corner straight up."""
    if sides < 3:
        raise ValueError("polygon: sides must be 3 or more, got " + str(sides))
    return [_round(centre, radius, turn_deg + 360.0 * k / sides) for k in range(sides + 1)]


def star(
    centre: tuple[float, float], radius: float, tips: int = 5, inner: float = 0.382, turn_deg: float = 0.0
) -> list[tuple[float, float]]:
    """The closed outline of a star: tips at the radius, the first straight up, corners between them at `inner` times the radius."""
    if tips < 3 or not 0.0 < inner < 1.0:
        raise ValueError("star: tips must be 3 or more and inner between 0 and 1, got " + str((tips, inner)))
    return [
        _round(centre, radius * (inner if k % 2 else 1.0), turn_deg + 180.0 * k / tips) for k in range(2 * tips + 1)
    ]


def circle(
    centre: tuple[float, float], radius: float, points: int = 20, turn_deg: float = 0.0
) -> list[tuple[float, float]]:
    """A closed circle of so many points, its ends counted twice."""
    return polygon(centre, radius, points - 1, turn_deg)


def arc(
    centre: tuple[float, float], radius: float, start_deg: float, end_deg: float, points: int = 10
) -> list[tuple[float, float]]:
    """Part of a circle from one angle to another."""
    if points < 2:
        raise ValueError("arc: points must be 2 or more, got " + str(points))
    step = (end_deg - start_deg) / (points - 1)
    return [_round(centre, radius, start_deg + k * step) for k in range(points)]


def spiral(
    centre: tuple[float, float], radius: float, turns: float = 3.0, points: int = 20, start_radius: float = 0.0
) -> list[tuple[float, float]]:
    """From near the centre outwards in so many turns."""
    if points < 2:
        raise ValueError("spiral: points must be 2 or more, got " + str(points))
    step = 1.0 / (points - 1)
    return [
        _round(centre, start_radius + (radius - start_radius) * k * step, 360.0 * turns * k * step)
        for k in range(points)
    ]


def raster(box: tuple[float, float, float, float], lanes: int = 5, margin: float = 0.0) -> list[tuple[float, float]]:
    """To and fro over a box (x0, y0, x1, y1) in level lanes from its top down, `margin` pixels inside its edges."""
    if lanes < 2:
        raise ValueError("raster: lanes must be 2 or more, got " + str(lanes))
    left, top, right, low = box[0] + margin, box[1] + margin, box[2] - margin, box[3] - margin
    found: list[tuple[float, float]] = []
    for k in range(lanes):
        y = top + (low - top) * k / (lanes - 1)
        ends = [(left, y), (right, y)]
        found += ends if k % 2 == 0 else [ends[1], ends[0]]
    return found


def shake(centre: tuple[float, float], up: float, times: int = 4) -> list[tuple[float, float, float]]:
    """Up and down over a centre (x, y), in the air: so many times up by `up` metres and back."""
    if times < 1:
        raise ValueError("shake: times must be 1 or more, got " + str(times))
    x, y = centre
    return [(x, y, up if k % 2 else 0.0) for k in range(2 * times + 1)]


def _round(centre: tuple[float, float], radius: float, degrees: float) -> tuple[float, float]:
    """The point at an angle, clockwise from straight up."""
    angle = math.radians(degrees)
    return (centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle))
