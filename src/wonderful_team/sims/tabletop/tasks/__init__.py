"""The tasks that come with the tabletop; importing this registers them."""

from wonderful_team.sims.tabletop.tasks import (
    follow,
    fruit_placement,
    fruit_price_ranking,
    in_order,
    neighbor,
    novel,
    rearrange,
    rotate,
    same,
    scene_understanding,
    superhero_companions,
    sweep,
    tidy_up,
    twist,
    visual_manipulation,
)

__all__ = [
    "follow",
    "fruit_placement",
    "fruit_price_ranking",
    "in_order",
    "neighbor",
    "novel",
    "rearrange",
    "rotate",
    "same",
    "scene_understanding",
    "superhero_companions",
    "sweep",
    "tidy_up",
    "twist",
    "visual_manipulation",
]
