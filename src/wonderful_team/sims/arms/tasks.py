"""The tasks of an arm. A task is a function that sets the table, as on the tabletop; what it draws follows from the seed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wonderful_team.core.actions import ARM
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop import tasks as _tabletop_tasks
from wonderful_team.sims.tabletop.registering import SetTable, TabletopTask, find_task
from wonderful_team.sims.tabletop.scene import Scene

MOVES = 14
"""Actions that one pick and place may take: ten, and a few more for what went wrong."""
COLOURS = ("red", "green", "yellow", "purple", "orange")
BOWLS = ("blue", "cyan")
FRUITS = ("all_match", "no_area", "misplaced", "both")
_TASKS: dict[str, TabletopTask] = {}


def task(name: str, *, instruction: str, horizon: int) -> Callable[[SetTable], SetTable]:
    """Make a task of a function that sets the table."""

    def register(set_table: SetTable) -> SetTable:
        words = (set_table.__doc__ or instruction).strip().splitlines()[0]
        _TASKS[name] = TabletopTask(name, instruction, horizon, set_table, words, ARM)
        return set_table

    return register


def find_arm_task(name: str) -> TabletopTask:
    """The task of that name.

    Raises:
        UnknownNameError: No such task; lists the known ones.
    """
    if name not in _TASKS:
        raise UnknownNameError("task", name, _TASKS)
    return _TASKS[name]


def task_names() -> dict[str, str]:
    """All tasks with one line of help each."""
    return {name: found.help for name, found in _TASKS.items()}


@task("block_in_bowl", instruction="put the {colour} block into the bowl", horizon=2 * MOVES)
def block_in_bowl(scene: Scene, rng: np.random.Generator) -> None:
    """Put the block of the named colour into the bowl; another block stands beside it."""
    colours = [str(name) for name in scene.colours.permutation(COLOURS)[:2]]
    bowl = scene.add("bowl", str(scene.colours.choice(BOWLS)), name="bowl")
    wanted, other = (scene.add("cube", colour, name=f"{colour} block") for colour in colours)
    scene.say(colour=colours[0])
    scene.ends_when_reached = False
    scene.goal(wanted, inside=bowl)
    scene.goal(other, off=[bowl])


for _variation in FRUITS:
    _found = find_task(f"fruit_placement/{_variation}")
    _TASKS[_found.name] = TabletopTask(
        _found.name, _found.instruction, _found.horizon * MOVES, _found.set_table, _found.help, ARM
    )
del _tabletop_tasks
