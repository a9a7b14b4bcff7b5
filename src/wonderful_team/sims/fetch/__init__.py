"""The Fetch of gymnasium-robotics at a table with a closed box, as in the paper's appendix G.3; in a process and environment of its own."""

from wonderful_team.sims.fetch.finding import check_ready
from wonderful_team.sims.fetch.tasks import TIERS, asked, partitions, task_names
from wonderful_team.sims.fetch.world import FetchWorld

make_world = FetchWorld
"""make_world("lid", seed=3, depth=0); the name may say the same: "lid@depth=1"."""


def check_options(task: str) -> None:
    """Whether the options behind a task's name can be made.

    Raises:
        ConfigError: One cannot; says what would be valid.
    """
    asked(task, 0)


__all__ = ["TIERS", "FetchWorld", "check_options", "check_ready", "make_world", "partitions", "task_names"]
