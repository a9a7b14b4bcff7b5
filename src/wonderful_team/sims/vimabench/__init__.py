"""VIMA-Bench itself: an adapter to the user's own, unmodified copy, which runs in a process and environment of its own."""

from wonderful_team.sims.vimabench.client import check_ready
from wonderful_team.sims.vimabench.finding import find_installation
from wonderful_team.sims.vimabench.tasks import partitions, task_names
from wonderful_team.sims.vimabench.world import VimaWorld

make_world = VimaWorld
"""make_world("rotate", seed=3, partition=None)"""

__all__ = ["VimaWorld", "check_ready", "find_installation", "make_world", "partitions", "task_names"]
