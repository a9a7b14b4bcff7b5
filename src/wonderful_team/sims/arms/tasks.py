"""The tasks of an arm. A task is a function that sets the table, as on the tabletop; what it draws follows from the seed."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from wonderful_team.core.actions import ARM
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.arms.bottle_tasks import cap, shake
from wonderful_team.sims.arms.drawing import Drawing
from wonderful_team.sims.arms.lid import ClosedBox
from wonderful_team.sims.arms.scene import ArmScene
from wonderful_team.sims.arms.star import star_points, star_problem
from wonderful_team.sims.arms.wiping import Wiping
from wonderful_team.sims.tabletop import tasks as _tabletop_tasks
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.placing import Room
from wonderful_team.sims.tabletop.registering import SetTable, TabletopTask, find_task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.shapes import WELL_M

MOVES = 14
"""Actions that one pick and place may take: ten, and a few more for what went wrong."""
COLOURS = ("red", "green", "yellow", "purple", "orange")
BOWLS = ("blue", "cyan")
PLATE_COLOUR = "olive"
"""Of the plate beside the closed box: no block, box or lid has it."""
PAPERS = ("green", "yellow", "orange", "cyan", "pink")
NEAR_ROOM_M: Room = (0.3, -0.3, 0.66, 0.3)
STAR_M = 0.065
"""From the middle of the oracle's star to its tips [m]."""
BOX_ROOM_M: Room = (0.36, -0.3, 0.62, 0.3)
"""Where the closed box stands: its middle can be reached from above, and so can that of a lid beside it [m]."""
HEIGHTS = (0.7, 1.0, 1.3, 1.6)
"""Of the blocks beside the closed box, as many times as high as wide."""
IMPLICIT = {
    "fruit_placement": ("all_match", "no_area", "misplaced", "both"),
    "superhero_companions": ("exact", "similar", "two_coloured", "no_match"),
    "fruit_price_ranking": ("three", "four", "discount", "deals"),
}
"""The paper's implicit goals with their variations: the tabletop's scenes."""
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


@task("star", instruction="draw a five-pointed star on the {colour} paper", horizon=8)
def star(scene: Scene, rng: np.random.Generator) -> None:
    """Draw a five-pointed star on the paper of the named colour; judged on the ink."""
    colours = [str(name) for name in scene.colours.permutation(PAPERS)[:2]]
    paper = scene.add("paper", f"{colours[0]} paper", yaw_rad=0.0, name=f"{colours[0]} paper", within=NEAR_ROOM_M)
    scene.add("paper", f"{colours[1]} paper", yaw_rad=0.0, name=f"{colours[1]} paper")
    scene.say(colour=colours[0])
    assert isinstance(scene, ArmScene)

    def right(poses: Poses) -> Array:
        return star_points(poses[paper.name].position_m[:2], STAR_M, math.pi)

    scene.work = Drawing(paper, star_problem, right)


@task("wipe", instruction="wipe the {colour} plate with the sponge", horizon=8)
def wipe(scene: Scene, rng: np.random.Generator) -> None:
    """Wipe the plate of the named colour with the sponge; judged by how much of it the sponge has pressed on."""
    colours = [str(name) for name in scene.colours.permutation(COLOURS)[:2]]
    plate = scene.add("plate", colours[0], name=f"{colours[0]} plate", within=NEAR_ROOM_M)
    scene.add("cube", colours[1], name=f"{colours[1]} block")
    scene.say(colour=colours[0])
    assert isinstance(scene, ArmScene)
    scene.work = Wiping(plate, WELL_M)


task("shake", instruction="shake the {colour} bottle", horizon=2 * MOVES)(shake)
task("cap", instruction="open the {colour} bottle", horizon=2 * MOVES)(cap)


def _lid_box(scene: Scene, count: int) -> None:
    """A closed box and four blocks of different heights; the first `count` of them are to go in."""
    colours = [str(name) for name in scene.colours.permutation(COLOURS)[:4]]
    paints = [str(name) for name in scene.colours.permutation(BOWLS)]
    closed = scene.add("box", paints[0], yaw_rad=0.0, name="box", within=BOX_ROOM_M)
    lid = scene.add(
        "lid", paints[1], at=(closed.x_m, closed.y_m), yaw_rad=0.0, name="lid", lifted_m=closed.body.height_m
    )
    heights = [float(h) for h in scene.layout.permutation(HEIGHTS)]
    blocks = [
        scene.add("cube", colour, name=f"{colour} block", stretch=stretch)
        for colour, stretch in zip(colours, heights, strict=True)
    ]
    assert isinstance(scene, ArmScene)
    plate = [scene.add("plate", PLATE_COLOUR, name="plate")] if scene.other_container else []
    # There is room for the lid beside everything.
    scene.free_place(lid)
    scene.say(**{f"colour{k}" if count > 1 else "colour": colours[k] for k in range(count)})
    scene.work = ClosedBox(closed, lid, blocks[:count], [*blocks[count:], *plate])


@task("lid_box/one", instruction="put the {colour} block into the box", horizon=3 * MOVES)
def lid_box_one(scene: Scene, rng: np.random.Generator) -> None:
    """The box with a lid: one of four blocks of different heights goes in, and nothing says that the box is closed."""
    _lid_box(scene, 1)


@task("lid_box/two", instruction="put the {colour0} block and the {colour1} block into the box", horizon=4 * MOVES)
def lid_box_two(scene: Scene, rng: np.random.Generator) -> None:
    """The box with a lid: two of four blocks of different heights go in, and nothing says that the box is closed."""
    _lid_box(scene, 2)


for _found in (find_task(f"{goal}/{variation}") for goal, names in IMPLICIT.items() for variation in names):
    _TASKS[_found.name] = TabletopTask(
        _found.name, _found.instruction, _found.horizon * MOVES, _found.set_table, _found.help, ARM
    )
del _tabletop_tasks
