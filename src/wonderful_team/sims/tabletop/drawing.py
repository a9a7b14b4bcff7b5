"""Drawing a scene: what every renderer answers, and the choice of one that works here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.model import BuiltModel


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

    def bodies(self, state: Any, camera: str) -> Array:
        """Id of the body that each pixel shows, 0 for the table and floor, shape (H, W)."""
        ...

    def close(self) -> None: ...


def open_renderer(built: BuiltModel, wanted: str | None = None) -> tuple[Renderer, tuple[str, ...]]:
    """A renderer that works here and notes on the choice.

    Args:
        built: What is to be drawn.
        wanted: None for the best that works, or "rays" for ray casting.
    """
    from wonderful_team.sims.tabletop.drawing_rays import RayRenderer

    if wanted == "rays":
        return RayRenderer(built), ()
    from wonderful_team.sims.tabletop.drawing_gl import OpenGLRenderer

    try:
        return OpenGLRenderer(built), ()
    except RuntimeError as error:
        note = f"pictures are drawn by ray casting, which is slower and has no smoothing: {error}"
        return RayRenderer(built), (note,)
