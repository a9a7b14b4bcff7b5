"""Worlds and tasks by name. A simulator is imported when it is first used."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from wonderful_team.core import deadline
from wonderful_team.core.protocols import World, offers
from wonderful_team.core.values import Instruction, KeepOut
from wonderful_team.errors import (
    ConfigError,
    UnknownNameError,
    WorldUnavailableError,
    code_of,
)
from wonderful_team.registry.files import is_file_name, load_from_file, make_from_file
from wonderful_team.registry.own_world import OwnWorld


@dataclass(frozen=True)
class WorldRow:
    """A simulator: what it is, and how its package is imported when it is first used.

    The package has `make_world(task, seed=…, **tiers)`, `task_names()` and `partitions(task)`; it may have `TIERS` (kinds of
    harder tier that it makes itself), `check_ready()`, `check_options(task)` where names may say more than a level, and, where users' functions become tasks, `task_of(function)` and
    `made_in_main(task)`.
    """

    words: str
    load: Callable[[], Any]

    def offer(self, name: str, otherwise: Any) -> Any:
        """What the package has under a name that it may leave out."""
        return getattr(self.load(), name, otherwise)


WORLDS: dict[str, WorldRow] = {
    "tabletop": WorldRow(
        "MuJoCo table, 1.0 x 0.5 m, suction, top and front cameras with depth",
        lambda: importlib.import_module("wonderful_team.sims.tabletop"),
    ),
    "arms": WorldRow(
        "MuJoCo, a UR5e with a two-finger gripper at a table: grasps by contact, colour and depth from above; the optional part arms. "
        "TASK@nudge=1 (also hand, remove, slip, depth, calibration, camera, each 1 to 3) disturbs it",
        lambda: importlib.import_module("wonderful_team.sims.arms"),
    ),
    "fetch": WorldRow(
        "gymnasium-robotics' Fetch at a table with a closed box, in a process and a Python environment of its own; colour and depth from above",
        lambda: importlib.import_module("wonderful_team.sims.fetch"),
    ),
    "vimabench": WorldRow(
        "VIMA-Bench itself: your own copy, in a process and a Python environment of its own; 256 x 128 px, no depth",
        lambda: importlib.import_module("wonderful_team.sims.vimabench"),
    ),
}
"""Every simulator by name; a task of it is WORLD/TASK."""


def task_names() -> dict[str, str]:
    """Every task of every world, as WORLD/TASK, with a line of help."""
    return {
        f"{world}/{name}": words for world, row in WORLDS.items() for name, words in row.load().task_names().items()
    }


def task_partitions() -> dict[str, tuple[str, ...]]:
    """The generalisation levels of every task, as WORLD/TASK: a world is then made as WORLD/TASK@LEVEL."""
    return {
        f"{world}/{name}": tuple(row.load().partitions(name))
        for world, row in WORLDS.items()
        for name in row.load().task_names()
    }


def check_ready(names: Iterable[str]) -> None:
    """Whether the simulators behind these tasks can be started, before many are; each is asked once.

    Raises:
        ConfigError: One is not installed; says how to get it.
    """
    for world in dict.fromkeys(name.partition("/")[0] for name in names if not is_file_name(name)):
        if world in WORLDS:
            WORLDS[world].offer("check_ready", lambda: None)()


def takes_options(name: str) -> bool:
    """Whether a world reads what stands behind a task's @ itself, and can make it; levels are `task_partitions`.

    Raises:
        ConfigError: It reads that itself, and cannot make it.
    """
    world, _, task = name.partition("/")
    check = WORLDS[world].offer("check_options", None) if world in WORLDS else None
    if check is None:
        return False
    check(task)
    return True


def own_tiers(name: str) -> tuple[str, ...]:
    """Kinds of harder tier that a world makes itself, in its simulator; () where only its pictures can be changed."""
    if is_file_name(name):
        name = task_made_of(load_from_file(name, "world")) or ""
    world = name.partition("/")[0]
    return tuple(WORLDS[world].offer("TIERS", ())) if world in WORLDS else ()


def make_world(
    name: str | Any,
    seed: int = 0,
    instruction: str | Instruction | None = None,
    keep_out: Sequence[KeepOut] = (),
    tiers: Mapping[str, int] | None = None,
    **arguments: Any,
) -> World:
    """A world with one scene set up in it.

    Args:
        name: WORLD/TASK such as "tabletop/rotate"; or FILE.py:NAME, a class with the World interface or a task
            made with `wonderful_team.task`; or an object that is a world but for its instruction, `stop` or `close`.
        seed: Of the scene. Seeds below 1000 are for development; suites start at 1000.
        instruction: Instead of the world's own; the scorer, which judges the world's own, is then dropped.
        keep_out: Regions nothing may enter, beside the world's own.
        tiers: How much harder than usual, 0 to 3, by kind; of `own_tiers(name)`.
        **arguments: For the constructor of a world of FILE.py:NAME, such as a robot's address.

    Raises:
        UnknownNameError: No such world or task; lists those that exist.
        ConfigError: The seed is negative, or the world has no instruction and none is given.
    """
    if seed < 0:
        raise ConfigError(f"seed {seed}: must be 0 or more")
    if not isinstance(name, str):
        world, name = _whole(name, f"world {type(name).__name__}"), type(name).__name__
        _take_none(name, arguments)
    else:
        wrong = [kind for kind in tiers or {} if kind not in own_tiers(name)]
        if wrong:
            raise ConfigError(f"world {name!r} makes no tiers of {', '.join(wrong)}; our tabletop does")
        harder = dict(tiers or {})
        if is_file_name(name):
            world = _world_from_file(name, seed, harder, arguments)
        else:
            _take_none(name, arguments)
            world = deadline.bounded(f"setting up world {name!r}", _named_world, name, seed, harder)
            if instruction is None and not keep_out:
                # Its instruction is not even looked at: that draws its pictures, and controls need none.
                return world
    with code_of(f"instruction of world {name!r}", WorldUnavailableError):
        own = getattr(world, "instruction", None)
        whole = offers(world, World)
    if own is not None and not isinstance(own, Instruction):
        raise WorldUnavailableError(
            f"instruction of world {name!r} is a {type(own).__name__}; valid: a wt.Instruction, or None"
        )
    wanted = _worded(instruction, own) if instruction is not None else own
    if wanted is None:
        raise ConfigError(
            f'world {name!r} brings no instruction: say one, as in: run {name} "put the red cup on the tray"'
        )
    if whole and wanted is own and not keep_out:
        return cast(World, world)
    return cast(World, OwnWorld(world, wanted, tuple(keep_out)))


def scene_name(name: str, seed: int) -> str:
    """How records name a scene."""
    return f"{name}#{seed}"


def _take_none(name: str, arguments: Mapping[str, Any]) -> None:
    if arguments:
        raise ConfigError(
            f"world {name!r} takes no arguments ({', '.join(arguments)}); those of FILE.py:NAME, a class, are for its constructor"
        )


def _worded(instruction: str | Instruction, own: Instruction | None) -> Instruction:
    if isinstance(instruction, Instruction):
        return instruction
    slots = dict(own.slots) if own is not None else {}
    return Instruction(instruction, {key: slot for key, slot in slots.items() if f"{{{key}}}" in instruction})


def _named_world(name: str, seed: int, harder: Mapping[str, int]) -> World:
    world, _, task = name.partition("/")
    if world not in WORLDS:
        known = [*WORLDS, "FILE.py:NAME"]
        worlds = [one for one, row in WORLDS.items() if name.partition("@")[0] in row.load().task_names()]
        if worlds:
            raise ConfigError(
                f"unknown world {name!r}: it is a task; say {' or '.join(f'{one}/{name}' for one in worlds)}"
            )
        raise UnknownNameError("world", world, known)
    if not task:
        raise ConfigError(f"world {name!r}: say which task, one of: {', '.join(task_names())}")
    simulator = WORLDS[world].load()
    if task.partition("@")[0] not in simulator.task_names():
        raise UnknownNameError("task", name, task_names())
    return cast(World, simulator.make_world(task, seed=seed, **harder))


def _world_from_file(name: str, seed: int, harder: Mapping[str, int], arguments: Mapping[str, Any]) -> Any:
    task = task_made_of(load_from_file(name, "world"))
    if task is not None:
        _take_none(name, arguments)
        return deadline.bounded(f"setting up world {name!r}", lambda: _named_world(task, seed, harder))
    made = make_from_file(name, "world", {"seed": seed}, WorldUnavailableError, arguments)
    return _whole(made, f"world {name!r}")


def _whole(made: Any, what: str) -> Any:
    """The same object, when it has what a world needs."""
    with code_of(f"{what}: {type(made).__name__}", WorldUnavailableError):
        missing = [need for need in ("vocabulary", "limits", "observe", "execute") if not hasattr(made, need)]
    if missing:
        raise ConfigError(
            f"{what}: {type(made).__name__} lacks {', '.join(missing)}; a world has vocabulary, limits, "
            "observe() and execute(action), a task is made with wonderful_team.task"
        )
    return made


def task_made_of(thing: Any) -> str | None:
    """The task, as WORLD/TASK, that a user's function was made into."""
    found = ((world, row.offer("task_of", lambda _: None)(thing)) for world, row in WORLDS.items())
    return next((f"{world}/{task}" for world, task in found if task is not None), None)


def made_in_main(name: str) -> bool:
    """Whether a task was made in the script that is running: only that script can make it again."""
    world, _, task = name.partition("/")
    if is_file_name(name) or world not in WORLDS:
        return False
    return bool(WORLDS[world].offer("made_in_main", lambda _: False)(task.partition("@")[0]))
