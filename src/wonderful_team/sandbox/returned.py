"""What a function returned, described inside of the worker as text of bounded size, and parsed outside as untrusted input.

A Python value that leaves the worker is rebuilt in this process, and a few characters of code can make one that needs
gigabytes to rebuild or to print. So no value leaves it.
"""

from __future__ import annotations

import math

from wonderful_team.core.pictures import PathPoint
from wonderful_team.core.values.function import MAX_COORDINATE_PX
from wonderful_team.sandbox.errors import SandboxError

MAX_UP_M = 1.0
"""No path in the air rises or falls by more [m]; how far it may go is the world's to say."""
MAX_ERROR_CHARACTERS = 1000
"""Longest error text; it goes back to the model, into the record and onto the page."""

_DESCRIBING = """
def _shown(value, depth):
    if value is None or isinstance(value, bool):
        return str(value)
    if isinstance(value, int):
        return str(value) if -{limit} <= value <= {limit} else 'a very large number'
    if isinstance(value, float):
        return str(value)
    if isinstance(value, str):
        return repr(value[:40]) + ('...' if len(value) > 40 else '')
    if isinstance(value, (list, tuple)):
        inside = ', '.join([_shown(item, depth + 1) for item in value[:4]]) if depth < 2 else '...'
        return '(' + inside + (', ...' if len(value) > 4 else '') + ')'
    return 'an object of type ' + type(value).__name__[:40]


def _described(value):
    if not isinstance(value, (list, tuple)):
        return 'error path(boxes) must return a list of (x, y), or of (x, y, up), it returned ' + _shown(value, 0)
    if not 2 <= len(value) <= {most}:
        return 'error path(boxes) returned ' + str(len(value)) + ' points; 2 to {most} are allowed'
    lines = []
    for number, point in enumerate(value):
        name = 'error point ' + str(number + 1)
        if not isinstance(point, (list, tuple)) or not 2 <= len(point) <= 3:
            return name + ' must be (x, y) or (x, y, up), it is ' + _shown(point, 1)
        if len(point) != len(value[0]):
            return name + ' must say up as point 1 does, or neither: it is ' + _shown(point, 1)
        for part in point:
            if isinstance(part, bool) or not isinstance(part, (int, float)):
                return name + ' must hold numbers, it is ' + _shown(point, 1)
        for part in point[:2]:
            if not -{limit} <= part <= {limit}:
                return name + ' is ' + _shown(point, 1) + '; x and y must be finite pixels'
        for part in point[2:]:
            if not -{up} <= part <= {up}:
                return name + ' is ' + _shown(point, 1) + '; up must be finite metres, from -{up} to {up}'
        lines.append('point ' + ' '.join([str(float(part)) for part in point]))
    return '\\n'.join(lines)


print(_described(_returned))
"""
"""Runs in the worker after the model's code. That code may have redefined any name used here: then the text is wrong, and still short
and only text."""


def describing(max_points: int) -> str:
    """The program that describes the value `_returned` inside of the worker."""
    return _DESCRIBING.format(limit=int(MAX_COORDINATE_PX), up=MAX_UP_M, most=max_points)


def parsed(text: str, max_points: int) -> tuple[PathPoint, ...]:
    """Points from the worker's description, all with a height or none.

    Raises:
        SandboxError: The description names a problem, or is not a description of 2 to `max_points` points.
    """
    lines = text.strip().splitlines()
    if lines and lines[0].startswith("error "):
        raise SandboxError(cut(lines[0].removeprefix("error ")))
    if not 2 <= len(lines) <= max_points:
        raise SandboxError(f"path(boxes) described {len(lines)} points; 2 to {max_points} are allowed")
    points = tuple(_point(line, number) for number, line in enumerate(lines, start=1))
    if len({len(point) for point in points}) > 1:
        raise SandboxError("either every point says up, or none")
    return points


def _point(line: str, number: int) -> PathPoint:
    words = line.split()
    try:
        kind, numbers = words[0], tuple(float(word) for word in words[1:])
    except (IndexError, ValueError):
        kind, numbers = "", ()
    if kind != "point" or len(numbers) not in (2, 3):
        raise SandboxError(
            f"point {number} must hold two or three numbers, the worker described it as {cut(line, 80)!r}"
        )
    if (
        not all(math.isfinite(value) for value in numbers)
        or max(abs(value) for value in numbers[:2]) > MAX_COORDINATE_PX
    ):
        raise SandboxError(f"point {number} is {numbers[:2]}; both numbers must be finite pixels")
    if len(numbers) == 3 and abs(numbers[2]) > MAX_UP_M:
        raise SandboxError(f"point {number} has up = {numbers[2]:g} m; valid: from {-MAX_UP_M} to {MAX_UP_M} m")
    return numbers if len(numbers) == 3 else (numbers[0], numbers[1])


def cut(text: str, most: int = MAX_ERROR_CHARACTERS) -> str:
    """Text of at most `most` characters; says how many were left out."""
    return text if len(text) <= most else f"{text[:most]}... ({len(text) - most} more characters)"
