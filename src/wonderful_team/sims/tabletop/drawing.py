"""Drawing a scene: what every renderer answers, and the choice of one that works here."""

from __future__ import annotations

from wonderful_team.sims.tabletop.kept_pictures import KeepingRenderer
from wonderful_team.sims.tabletop.model import BuiltModel
from wonderful_team.sims.tabletop.renderer import Renderer


def open_renderer(built: BuiltModel, wanted: str | None = None) -> tuple[Renderer, tuple[str, ...]]:
    """A renderer that works here and notes on the choice.

    Args:
        built: What is to be drawn.
        wanted: None for the best that works, or "rays" for ray casting.
    """
    renderer, notes = _working_renderer(built, wanted)
    if built.same_as is None or built.decorate is not None:
        return renderer, notes  # what is drawn beside the bodies is not told by their poses
    return KeepingRenderer(renderer, built.same_as), notes


def _working_renderer(built: BuiltModel, wanted: str | None) -> tuple[Renderer, tuple[str, ...]]:
    from wonderful_team.sims.tabletop.drawing_rays import RayRenderer

    if wanted == "rays":
        return RayRenderer(built), ()
    from wonderful_team.sims.tabletop.drawing_gl import OpenGLRenderer

    try:
        return OpenGLRenderer(built), ()
    except RuntimeError as error:
        note = f"pictures are drawn by ray casting, which is slower and has no smoothing: {error}"
        return RayRenderer(built), (note,)
