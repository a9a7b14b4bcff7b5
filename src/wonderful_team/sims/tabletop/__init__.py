"""Our own tabletop: a MuJoCo table with procedural things, two cameras, a suction cup and tasks that follow from a seed."""

from wonderful_team.sims.tabletop import tasks as _tasks
from wonderful_team.sims.tabletop.options import TIERS
from wonderful_team.sims.tabletop.registering import made_in_main, partitions, task, task_names, task_of
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.world import TabletopWorld

make_world = TabletopWorld
"""make_world("visual_manipulation", seed=3, partition="L3", size_px=(256, 128), clutter=1, lighting=0, camera=0, texture=0,
recolour=None, renderer=None); the name may say the same: "visual_manipulation@L3@small@clutter=1"."""

__all__ = [
    "TIERS",
    "Scene",
    "TabletopWorld",
    "made_in_main",
    "make_world",
    "partitions",
    "task",
    "task_names",
    "task_of",
]
del _tasks
