"""Points offered for choosing: a grid inside a box, a ring beside it. Pure numbers, in the pixels of the box."""

from __future__ import annotations

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point


def inside_points(box: Box, columns: int, rows: int) -> tuple[Point, ...]:
    """Centres of a grid of equal cells inside a box, row by row from the top left.

    Raises:
        ValueError: Fewer than one column or row.
    """
    if columns < 1 or rows < 1:
        raise ValueError(f"columns and rows must be at least 1, got {columns} and {rows}")
    return tuple(
        (box.x0 + (column + 0.5) * box.width / columns, box.y0 + (row + 0.5) * box.height / rows)
        for row in range(rows)
        for column in range(columns)
    )


def beside_points(box: Box, distance: float) -> tuple[Point, ...]:
    """Eight points round a box, clockwise from the middle above it.

    Args:
        box: The box.
        distance: From the box's edges, in the same pixels.

    Raises:
        ValueError: `distance` is negative.
    """
    if distance < 0:
        raise ValueError(f"distance must be 0 px or more, got {distance}")
    x, y = box.centre
    left, top, right, bottom = box.grown(distance, distance, distance, distance).as_tuple
    return ((x, top), (right, top), (right, y), (right, bottom), (x, bottom), (left, bottom), (left, y), (left, top))
