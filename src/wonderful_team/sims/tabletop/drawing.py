"""Drawing a scene: what every renderer answers, and the choice of one that works here."""

from __future__ import annotations

from wonderful_team.sims.tabletop.model import BuiltModel
from wonderful_team.sims.tabletop.renderer import Renderer


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
