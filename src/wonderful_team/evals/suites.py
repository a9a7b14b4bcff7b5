"""Suites by name: which tasks, how many seeds, and how often a method may plan again (the paper's protocols)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from wonderful_team.core.text import counted
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.toy import ANNOTATIONS, BOX_KINDS, BOXCHECK, POINTING, is_toy
from wonderful_team.evals.trials import DEVELOPMENT_BELOW

VIMA_TASKS = (
    *("visual_manipulation", "scene_understanding", "rotate", "rearrange", "rearrange_then_restore", "novel_adj"),
    *("novel_noun", "novel_adj_and_noun", "twist", "follow_motion", "follow_order", "sweep_without_exceeding"),
    *("sweep_without_touching", "same_texture", "same_shape", "manipulate_old_neighbor", "pick_in_order_then_restore"),
)
"""The 17 tasks of VIMA-Bench in its own order (Jiang et al. 2023, arXiv:2210.03094)."""
PARTITIONS = ("L1", "L2", "L3", "L4")
IMPLICIT_GOALS = {
    "fruit": ("fruit_placement", "sort fruits by colour"),
    "companions": ("superhero_companions", "bring together fruits and snacks of similar colours"),
    "prices": ("fruit_price_ranking", "rank fruits by price tags and discounts"),
}
"""The paper's implicit goals: by suite, the folder of its variations and what they want."""
SPATIAL_TASKS = ("shake", "star", "wipe", "cap")
"""The paper's spatial planning, as the world `arms` has it: shake a bottle, draw a star, wipe a plate, open a bottle."""
LID_TASKS = ("lid", "lid_two")
ABLATED = (
    "visual_manipulation", "scene_understanding", "rotate", "novel_adj", "novel_noun", "sweep_without_exceeding", "same_shape",
    "manipulate_old_neighbor", "pick_in_order_then_restore",
)  # fmt: skip
"""The tasks of the paper's ablations: 1, 2, 3, 6, 7, 12, 15, 16 and 17."""


@dataclass(frozen=True)
class Protocol:
    """How trials are run (Wang, Shen & Stadie 2024, arXiv:2407.19094, appendix D.1).

    Attributes:
        runs: Seeds per task, from 1000 on, unless others are asked for.
        replans: Plans after the first.
    """

    name: str
    runs: int
    replans: int


OPEN_LOOP = Protocol("multimodal reasoning: 10 runs a task, single attempt, open loop", 10, 0)
IMPLICIT_GOAL = Protocol("implicit goals: 2 runs for each of 4 variations, single attempt, open loop", 2, 0)
LID = Protocol(
    "the box with a lid: single attempt; the paper states no number of runs, its steps of 5 % imply 20", 20, 0
)
LID_AGAIN = Protocol("the box with a lid: up to 3 replans, 20 runs", 20, 3)
SPATIAL = Protocol("spatial planning: 5 runs a task, closed loop, up to 3 replans", 5, 3)


@dataclass(frozen=True)
class Suite:
    """Tasks with the protocol they are run by; `note` says what is missing of a suite that is not whole.

    Attributes:
        methods: Whom it compares unless others are named.
    """

    name: str
    tasks: tuple[str, ...]
    protocol: Protocol
    help: str = ""
    note: str = ""
    methods: tuple[str, ...] = ()


def all_suites(known_tasks: Sequence[str], partitions: Mapping[str, Sequence[str]] | None = None) -> dict[str, Suite]:
    """Every suite that the registered tasks make up; it grows as tasks are registered.

    Args:
        known_tasks: Names as WORLD/TASK.
        partitions: Tasks of each generalisation level, as WORLD/TASK@LEVEL, where a world has them.
    """
    suites: dict[str, Suite] = {}
    vima = [f"tabletop/{name}" for name in VIMA_TASKS if f"tabletop/{name}" in known_tasks]
    if vima:
        missing = [name for name in VIMA_TASKS if f"tabletop/{name}" not in known_tasks]
        note = f"{len(missing)} of its 17 tasks do not exist yet: {', '.join(missing)}" if missing else ""
        words = "the tasks of VIMA-Bench on our own tabletop, not in the VIMA-Bench simulator"
        suites["vima17"] = Suite("vima17", tuple(vima), OPEN_LOOP, words, note)
        first = tuple(task for task in vima if task.rpartition("/")[2] in VIMA_TASKS[:3])
        suites["vima3"] = Suite("vima3", first, OPEN_LOOP, "its three tasks of simple object manipulation")
        ablated = tuple(task for task in vima if task.rpartition("/")[2] in ABLATED)
        suites["ablation"] = Suite("ablation", ablated, OPEN_LOOP, "the nine tasks of the paper's ablations")
        for level in PARTITIONS:
            tasks = tuple(task for task in (partitions or {}).get(level, ()) if task.startswith("tabletop/"))
            if tasks:
                suites[f"vima17/{level}"] = Suite(f"vima17/{level}", tasks, OPEN_LOOP, f"generalisation level {level}")
    suites.update(_real_vima(known_tasks, partitions or {}))
    for world, ending, where in (
        ("tabletop", "", "on the tabletop"),
        ("arms", "/arm", "on an arm that grips by contact"),
    ):
        suites.update(_implicit(known_tasks, world, ending, where))
    spatial = tuple(f"arms/{name}" for name in SPATIAL_TASKS if f"arms/{name}" in known_tasks)
    if spatial:
        words = "the paper's spatial planning, on an arm that grips by contact"
        suites["spatial"] = Suite("spatial", spatial, SPATIAL, words)
    lid = tuple(f"fetch/{name}" for name in LID_TASKS if f"fetch/{name}" in known_tasks)
    if lid:
        words = "the paper's box with a lid, on gymnasium-robotics' Fetch"
        suites["lid"] = Suite("lid", lid, LID, words)
        suites["lid/replanning"] = Suite("lid/replanning", lid, LID_AGAIN, f"{words}, closed loop")
    suites["pointing"] = Suite(
        "pointing", (POINTING,), Protocol("toy table: one question a picture (the paper states no number; 100 here)", 100, 0),
        "point at a circle on the toy table: the paper's Appendix F.1",
    )  # fmt: skip
    suites["annotations"] = Suite(
        "annotations", ANNOTATIONS, Protocol("toy table: each question with an annotation and without, 40 tables each", 40, 0),
        "what labelled axes, crops, strips of turned cut-outs and a picture of before each buy", methods=("annotated", "bare"),
    )  # fmt: skip
    suites["boxcheck"] = Suite(
        "boxcheck", tuple(f"{BOXCHECK}{kind}" for kind in BOX_KINDS), Protocol("toy table: 25 boxes of each of 4 kinds", 25, 0),
        "judge boxes on the toy table: the paper's Appendix F.2",
    )  # fmt: skip
    return suites


def _implicit(known_tasks: Sequence[str], world: str, ending: str, where: str) -> dict[str, Suite]:
    """The paper's implicit goals as a world has them: a suite for each, and one of all."""
    suites: dict[str, Suite] = {}
    for name, (folder, what) in IMPLICIT_GOALS.items():
        tasks = tuple(task for task in known_tasks if task.startswith(f"{world}/{folder}/"))
        if tasks:
            words = f"{what}: an implicit goal of the paper's, {counted(len(tasks), 'variation')}, {where}"
            suites[name + ending] = Suite(name + ending, tasks, IMPLICIT_GOAL, words)
    if suites:
        every = tuple(task for suite in suites.values() for task in suite.tasks)
        words = f"the paper's implicit goals, {counted(len(every), 'variation')}, {where}"
        suites[f"implicit{ending}"] = Suite(f"implicit{ending}", every, IMPLICIT_GOAL, words)
    return suites


def _real_vima(known_tasks: Sequence[str], partitions: Mapping[str, Sequence[str]]) -> dict[str, Suite]:
    """The benchmark's own simulator, where a world of that name is registered: whole, and by level."""
    tasks = tuple(f"vimabench/{name}" for name in VIMA_TASKS if f"vimabench/{name}" in known_tasks)
    if not tasks:
        return {}
    words = "the tasks of VIMA-Bench in your own copy of its simulator"
    suites = {"vimabench": Suite("vimabench", tasks, OPEN_LOOP, words)}
    for level in PARTITIONS:
        found = tuple(task for task in partitions.get(level, ()) if task.startswith("vimabench/"))
        if found:
            name = f"vimabench/{level}"
            suites[name] = Suite(name, found, OPEN_LOOP, f"{words}, generalisation level {level}")
    return suites


def resolve(
    names: Sequence[str], known_tasks: Sequence[str], suites: Mapping[str, Suite], is_own: Callable[[str], bool]
) -> tuple[Suite, ...]:
    """The suites that words of a command line mean: a suite, a task (with or without its world), FILE.py:TASK, PHOTOS.json.

    Raises:
        UnknownNameError: Neither a suite nor a task; lists the suites and the nearest task.
        ConfigError: Nothing is named, or a file is missing.
    """
    if not names:
        raise ConfigError(f"name a suite or a task: {', '.join([*suites, *known_tasks])}, FILE.py:TASK or PHOTOS.json")
    return tuple(_one(name, known_tasks, suites, is_own) for name in names)


def _one(name: str, known: Sequence[str], suites: Mapping[str, Suite], is_own: Callable[[str], bool]) -> Suite:
    if name in suites:
        return suites[name]
    if name.endswith(".json"):
        if not Path(name).is_file():
            raise ConfigError(f"photos {name!r}: there is no such file; valid: a COCO file with boxes and instructions")
        return Suite(name, (name,), Protocol("photos: each once", 1, 0), "grounding on photos, no simulator")
    if is_own(name):
        return Suite(name, (name,), OPEN_LOOP, "own task")
    for suite in suites.values():
        if is_toy(name) and name in suite.tasks:
            return Suite(name, (name,), suite.protocol, suite.help)
    for task in (name, f"tabletop/{name}"):
        if task.partition("@")[0] in known:
            return Suite(task, (task,), _protocol_of(task.partition("@")[0]))
    raise UnknownNameError("suite or task", name, [*suites, *known])


def _protocol_of(task: str) -> Protocol:
    """What the paper does with a task of that kind."""
    world, folder = task.split("/")[:2]
    if world == "arms" and folder in SPATIAL_TASKS:
        return SPATIAL
    return IMPLICIT_GOAL if folder in (folder for folder, _ in IMPLICIT_GOALS.values()) else OPEN_LOOP


def read_seeds(words: str) -> tuple[int, ...]:
    """Seeds from "1000:1020" (the end is left out), "1003", or several with commas.

    Raises:
        ConfigError: Another form, an empty range, or a seed twice.
    """
    seeds: list[int] = []
    for word in words.split(","):
        first, colon, end = word.strip().partition(":")
        try:
            seeds += range(int(first), int(end)) if colon else [int(first)]
        except ValueError:
            raise ConfigError(f"seeds {words!r}: valid is FIRST:END, one number, or several with commas") from None
    if not seeds or min(seeds) < 0 or len(set(seeds)) < len(seeds):
        raise ConfigError(f"seeds {words!r}: name at least one, none below 0 and none twice; as in 1000:1020")
    return tuple(seeds)


def default_seeds(protocol: Protocol) -> tuple[int, ...]:
    """The seeds of a protocol."""
    return tuple(range(DEVELOPMENT_BELOW, DEVELOPMENT_BELOW + protocol.runs))
