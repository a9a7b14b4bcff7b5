"""What an action does to the scene, whatever its kind: checks, pictures and expected scenes know these few motions only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from wonderful_team.core.geometry.arrays import Array


@dataclass(frozen=True, eq=False)
class Carry:
    """A thing is gripped at the start, lifted, turned on the way, and put down at the end.

    Attributes:
        start_m, end_m: Surfaces that are touched, shape (3,) [m], base frame.
        yaw_rad: How far it turns, counter-clockwise from above.
    """

    start_m: Array
    end_m: Array
    yaw_rad: float = 0.0


@dataclass(frozen=True, eq=False)
class Slide:
    """The tool goes along the table from start to end, shape (3,) [m] each, and pushes what lies before it."""

    start_m: Array
    end_m: Array


@dataclass(frozen=True, eq=False)
class Reach:
    """The tool goes straight from point to point, shape (N, 3) [m], with whatever it holds.

    Attributes:
        planned: Depth must leave room for it; False for the small steps of a learned policy, which end where it feels contact.
    """

    points_m: Array
    planned: bool = True


@dataclass(frozen=True, eq=False)
class Drive:
    """A mobile base goes along a path on the floor, shape (N, 2) [m]."""

    path_m: Array


@dataclass(frozen=True)
class Stay:
    """The tool stays where it is; it may open or close."""

    grip: Literal["open", "close"] | None = None


@dataclass(frozen=True)
class Leave:
    """The tool goes where only the world knows."""


@dataclass(frozen=True)
class Lost:
    """A motion relative to where the tool is, which nobody knows."""


Motion: TypeAlias = Carry | Slide | Reach | Drive | Stay | Leave | Lost
