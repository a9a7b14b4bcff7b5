"""Suites by name, and whether what is asked of them can be run: before a study begins."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team import registry
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.perturb import IN_PICTURE, read_tier
from wonderful_team.evals.photos import SET, is_photo, read_photos
from wonderful_team.evals.plan import of_photos
from wonderful_team.evals.pointing_sets import count_of
from wonderful_team.evals.suites import PARTITIONS, Suite, all_suites
from wonderful_team.evals.toy import is_toy
from wonderful_team.registry.files import is_file_name


def check_scenes(suites: Sequence[Suite], tiers: Sequence[str]) -> None:
    """Every own world loads, and every tier can be made."""
    registry.check_ready(task for suite in suites for task in suite.tasks)
    kinds = dict.fromkeys(read_tier(tier)[0] for tier in tiers if tier)
    for task in dict.fromkeys(task for suite in suites for task in suite.tasks):
        if is_photo(task):
            if kinds:
                raise ConfigError(f"--perturb: {task} is photos, and no tier is made of photos")
            continue
        if is_toy(task):
            if kinds:
                raise ConfigError(f"--perturb: no tier is made of the toy table ({task})")
            continue
        if is_file_name(task):
            registry.make_world(task).close()
        missing = [kind for kind in kinds if kind in ("clutter",) and kind not in registry.own_tiers(task)]
        if missing:
            raise ConfigError(
                f"--perturb {missing[0]}: {task} cannot put more things on its table; our tabletop can. "
                f"Valid for any world: {', '.join((*IN_PICTURE, 'paraphrase'))}"
            )


def check_levels(suites: Sequence[Suite]) -> None:
    """Raises UnknownNameError when a task has not the generalisation level that is asked for."""
    known = registry.task_partitions()
    for task, at, level in (name.partition("@") for suite in suites for name in suite.tasks):
        if at and task in known and level not in known[task] and not registry.takes_options(f"{task}@{level}"):
            raise UnknownNameError(f"level of {task}", level, known[task])


def photo_counts(suites: Sequence[Suite]) -> dict[str, int]:
    """How many scenes photos and sets of pictures have, as a plan notes it."""
    photos = [one.name for one in suites if of_photos(one)]
    return {f"photos:{name}": count_of(name) if name.startswith(SET) else len(read_photos(name)) for name in photos}


def known_suites() -> dict[str, Suite]:
    """Every suite by name, made of the registered tasks."""
    levels = registry.task_partitions()
    found = {level: [f"{task}@{level}" for task, has in levels.items() if level in has] for level in PARTITIONS}
    return all_suites(list(registry.task_names()), found)


def methods_of(suites: Sequence[str]) -> tuple[str, ...]:
    """Whom suites compare where no method is named."""
    known = known_suites()
    named = dict.fromkeys(method for name in suites if name in known for method in known[name].methods)
    return tuple(named) or ("team",)
