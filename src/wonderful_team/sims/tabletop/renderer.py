"""What every renderer of a scene answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from wonderful_team.core.geometry.arrays import Array


@dataclass(frozen=True, eq=False)
class Drawn:
    """One picture.

    Attributes:
        rgb: Shape (H, W, 3), uint8.
        depth_m: Distance along the optical axis, shape (H, W) [m].
    """

    rgb: Array
    depth_m: Array


class Renderer(Protocol):
    """Draws a built model; `name` says how: egl, osmesa or ray casting."""

    name: str

    def draw(self, state: Any, camera: str, *, alone: bool = False) -> Drawn:
        """Draw the table, or with `alone` the things only, on white."""
        ...

    def colours(self, state: Any, camera: str, *, alone: bool = False) -> Array:
        """The colours of what `draw` draws, shape (H, W, 3), uint8, for whoever reads no depth."""
        ...

    def bodies(self, state: Any, camera: str) -> Array:
        """Id of the body that each pixel shows, 0 for the table and floor, shape (H, W)."""
        ...

    def close(self) -> None: ...
