"""Tasks by name: the decorator that makes one, and the table that make_world looks in."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from wonderful_team.core.actions import PICK_PLACE, Vocabulary
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.sims.tabletop.clutter import add_clutter
from wonderful_team.sims.tabletop.options import Tiers
from wonderful_team.sims.tabletop.scene import CrowdedError, Scene
from wonderful_team.sims.tabletop.seeds import generator

SetTable: TypeAlias = Callable[[Scene, np.random.Generator], None]
ATTEMPTS = 60
SLOT = re.compile(r"\{(\w+)\}")
_TASKS: dict[str, TabletopTask] = {}


@dataclass(frozen=True)
class TabletopTask:
    """A task: words, how the table is set, how many actions it may take."""

    name: str
    instruction: str
    horizon: int
    set_table: SetTable
    help: str
    vocabulary: Vocabulary = PICK_PLACE
    partitions: tuple[str, ...] = ()

    def scene(
        self,
        seed: int,
        recolour: int | None = None,
        partition: str | None = None,
        tiers: Tiers | None = None,
        made: Callable[..., Scene] = Scene,
    ) -> Scene:
        """Set the table; the same seed sets the same table, and things stand at the same places at every tier.

        `made` is the kind of table, such as one that an arm reaches all of.

        Raises:
            UnknownNameError: The task does not exist at this generalisation level.
            ConfigError: The task never finds room for its things, sets no goal, or leaves a slot of its words open.
        """
        self.check_partition(partition)
        tiers = tiers or Tiers()
        for attempt in range(ATTEMPTS):
            paint = seed if recolour is None else recolour
            use = "colours" if recolour is None else "recolour"
            layout, colours, choices = (
                generator(number, f"{self.name}/{purpose}", attempt)
                for number, purpose in ((seed, "layout"), (paint, use), (seed, "choices"))
            )
            scene = made(layout, colours, partition=partition, alike=tiers.texture)
            try:
                self.set_table(scene, choices)
            except CrowdedError:
                continue
            self._check(scene)
            add_clutter(scene, generator(seed, f"{self.name}/clutter", attempt), tiers.clutter)
            return scene
        raise ConfigError(f"task {self.name!r} with seed {seed}: no room for its things in {ATTEMPTS} tries")

    def check_partition(self, partition: str | None) -> None:
        """Whether the task exists at a generalisation level.

        Raises:
            UnknownNameError: It does not; lists those at which it does.
        """
        if partition is not None and partition not in self.partitions:
            raise UnknownNameError(f"partition of {self.name}", partition, self.partitions)

    def _check(self, scene: Scene) -> None:
        wanted = set(SLOT.findall(self.instruction))
        inner = {slot for word in scene.words.values() for slot in SLOT.findall(word)}
        given = set(scene.words) | set(scene.pictures)
        if wanted | inner != given:
            raise ConfigError(
                f"task {self.name!r}: its instruction has the slots {sorted(wanted | inner)}, "
                f"but the scene fills {sorted(given)}"
            )
        if not scene.wants_something:
            raise ConfigError(f"task {self.name!r}: it sets no goal; call scene.goal(...) or scene.count(...)")


def filled(text: str, words: Mapping[str, str]) -> str:
    """Words in place of their slots; picture slots stay."""
    for slot, word in words.items():
        text = text.replace(f"{{{slot}}}", word)
    return text


def task(
    name: str,
    *,
    instruction: str,
    horizon: int,
    vocabulary: Vocabulary = PICK_PLACE,
    partitions: tuple[str, ...] = (),
) -> Callable[[SetTable], SetTable]:
    """Make a task of a function that sets the table: `def cups(scene, rng): ...`.

    Args:
        name: What make_world is asked for.
        instruction: Words for the robot; each {slot} is filled by scene.say, scene.show or scene.show_table.
        horizon: How many actions are judged.
        vocabulary: What the robot can do: pick and place with a suction cup, or push with a spatula.
        partitions: Generalisation levels that the function knows of, by `scene.partition`.

    Raises:
        ConfigError: The name is taken by another function, or the horizon is not positive.
    """
    if horizon < 1:
        raise ConfigError(f"task {name!r}: horizon must be at least 1, got {horizon}")
    if vocabulary.kinds not in (("pick_place",), ("push",)):
        raise ConfigError(f"task {name!r}: the table runs pick_place or push, not {', '.join(vocabulary.kinds)}")

    def register(set_table: SetTable) -> SetTable:
        before = _TASKS.get(name)
        if before is not None and _origin(before.set_table) != _origin(set_table):
            raise ConfigError(f"task {name!r} exists already; choose another name")
        lines = (inspect.getdoc(set_table) or instruction).strip().splitlines()
        _TASKS[name] = TabletopTask(name, instruction, horizon, set_table, lines[0], vocabulary, partitions)
        return set_table

    return register


def _origin(function: SetTable) -> tuple[str, str]:
    """The same file read twice may register its tasks twice."""
    return inspect.getsourcefile(function) or "", function.__qualname__


def find_task(name: str) -> TabletopTask:
    """The task of that name; a leading "tabletop/" is allowed.

    Raises:
        UnknownNameError: No such task; lists the known ones.
    """
    short = name.removeprefix("tabletop/")
    if short not in _TASKS:
        raise UnknownNameError("task", name, _TASKS)
    return _TASKS[short]


def task_names() -> dict[str, str]:
    """All tasks with one line of help each."""
    return {name: found.help for name, found in _TASKS.items()}


def task_of(function: object) -> str | None:
    """The name of the task that a function was made into; None when it was made into none."""
    return next((name for name, found in _TASKS.items() if found.set_table is function), None)


def made_in_main(name: str) -> bool:
    """Whether a task was made in the script that is running."""
    return str(find_task(name).set_table.__module__) in ("__main__", "__mp_main__")


def partitions(name: str) -> tuple[str, ...]:
    """The generalisation levels at which a task exists; `make_world("rotate@L3")` sets its table at one.

    Raises:
        UnknownNameError: No such task.
    """
    return find_task(name).partitions
