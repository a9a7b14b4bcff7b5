"""What stands on the table: a box, its lid, and things of different heights, from simple solids."""

from __future__ import annotations

from dataclasses import dataclass

BOX_INSIDE_M, WALL_M, FLOOR_M, RIM_M = (0.12, 0.16), 0.005, 0.006, 0.085
"""Of the box: its inside, along x and y, its walls and floor, and the height of its rim [m]."""
LID_M = (0.136, 0.176, 0.008)
HANDLE_M = (0.044, 0.022, 0.032)
"""Sides of the lid's plate, and of the handle on its middle [m]."""
BLUE, PALE_BLUE, BLACK = (0.12, 0.27, 0.75), (0.2, 0.38, 0.85), (0.06, 0.06, 0.07)


@dataclass(frozen=True)
class Solid:
    """A part of a thing.

    Attributes:
        shape: box, cylinder, or wheel (a cylinder that lies along y).
        size_m: Half sides (x, y, z); radius and half height.
        at_m: Its middle over the middle of the thing's foot.
    """

    shape: str
    size_m: tuple[float, ...]
    at_m: tuple[float, float, float]
    rgb: tuple[float, float, float]


@dataclass(frozen=True)
class Kind:
    """A kind of thing.

    Attributes:
        half_m: Half of what it covers of the table, along x and y [m].
        round: Whether it covers a disc.
        grasp_m: Where its top is held, seen from the middle of its foot (x, y).
    """

    words: str
    solids: tuple[Solid, ...]
    half_m: tuple[float, float]
    height_m: float
    kg: float
    round: bool = False
    grasp_m: tuple[float, float] = (0.0, 0.0)


def _can(words: str, radius_m: float, height_m: float, rgb: tuple[float, float, float], top: tuple[float, float, float], kg: float) -> Kind:  # fmt: skip
    lid = 0.004
    return Kind(
        words,
        (
            Solid("cylinder", (radius_m, (height_m - lid) / 2), (0, 0, (height_m - lid) / 2), rgb),
            Solid("cylinder", (radius_m * 0.92, lid / 2), (0, 0, height_m - lid / 2), top),
        ),
        (radius_m, radius_m),
        height_m,
        kg,
        round=True,
    )


_WOOD, _DARK = (0.72, 0.5, 0.28), (0.3, 0.18, 0.1)
KINDS: dict[str, Kind] = {
    "train": Kind(
        "wooden toy train",
        (
            Solid("box", (0.042, 0.014, 0.012), (0, 0, 0.022), _WOOD),
            Solid("box", (0.014, 0.018, 0.014), (-0.012, 0, 0.045), _DARK),
            *(Solid("wheel", (0.011, 0.017), (x, 0, 0.011), _DARK) for x in (-0.026, 0.026)),
        ),
        (0.042, 0.018),
        0.059,
        0.1,
        grasp_m=(-0.012, 0.0),
    ),
    "block": Kind("green block", (Solid("box", (0.02, 0.02, 0.019), (0, 0, 0.019), (0.13, 0.6, 0.2)),), (0.02, 0.02), 0.038, 0.08),
    "cup": _can("orange cup", 0.027, 0.075, (0.95, 0.5, 0.1), (0.8, 0.4, 0.05), 0.1),
    "can": _can("red can", 0.03, 0.097, (0.8, 0.08, 0.1), (0.7, 0.7, 0.72), 0.15),
    "candle": _can("purple candle", 0.018, 0.116, (0.5, 0.15, 0.6), (0.9, 0.85, 0.6), 0.08),
    "bottle": Kind(
        "yellow bottle",
        (
            Solid("box", (0.024, 0.018, 0.054), (0, 0, 0.054), (0.93, 0.78, 0.1)),
            Solid("cylinder", (0.012, 0.014), (0, 0, 0.122), (0.85, 0.1, 0.1)),
        ),
        (0.024, 0.018),
        0.136,
        0.12,
    ),
}  # fmt: skip
"""All of different heights."""
_X, _Y = BOX_INSIDE_M[0] / 2, BOX_INSIDE_M[1] / 2
_W, _UP = WALL_M / 2, (RIM_M - FLOOR_M) / 2
BOX = Kind(
    "small blue box",
    (
        Solid("box", (_X + WALL_M, _Y + WALL_M, FLOOR_M / 2), (0, 0, FLOOR_M / 2), BLUE),
        *(Solid("box", (_W, _Y + WALL_M, _UP), (s * (_X + _W), 0, FLOOR_M + _UP), BLUE) for s in (-1, 1)),
        *(Solid("box", (_X, _W, _UP), (0, s * (_Y + _W), FLOOR_M + _UP), BLUE) for s in (-1, 1)),
    ),
    (_X + WALL_M, _Y + WALL_M),
    RIM_M,
    1.2,
)
LID = Kind(
    "lid",
    (
        Solid("box", (LID_M[0] / 2, LID_M[1] / 2, LID_M[2] / 2), (0, 0, LID_M[2] / 2), PALE_BLUE),
        Solid("box", (HANDLE_M[0] / 2, HANDLE_M[1] / 2, HANDLE_M[2] / 2), (0, 0, LID_M[2] + HANDLE_M[2] / 2), BLACK),
    ),
    (LID_M[0] / 2, LID_M[1] / 2),
    LID_M[2] + HANDLE_M[2],
    0.12,
)
HANDLE = 1
"""Which of the lid's solids is its handle."""
