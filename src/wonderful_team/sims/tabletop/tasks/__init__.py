"""The tasks that come with the tabletop; importing this registers them."""

from wonderful_team.sims.tabletop.tasks import fruit_placement, rotate, scene_understanding, visual_manipulation

__all__ = ["fruit_placement", "rotate", "scene_understanding", "visual_manipulation"]
