"""What of a study travels to the workers of a cluster: the user's own files that it names, and the saved profiles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.api.known_suites import check_scenes
from wonderful_team.api.trial import check_names, code_of_names
from wonderful_team.api.trial_setup import package_versions
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError
from wonderful_team.evals.photos import SET, read_photos
from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.pointing_sets import scenes_of
from wonderful_team.evals.shipment import Shipment, all_below, code_beside, listed
from wonderful_team.evals.suites import Suite
from wonderful_team.models.profiles import config_folder, profile_names, profiles_folder
from wonderful_team.registry.files import split_arguments
from wonderful_team.registry.role_models import choice_of


@dataclass(frozen=True)
class Ready:
    """Whether a study can be run on the machine where this is called: every name means something, every key is there."""

    suites: tuple[Suite, ...]
    tiers: tuple[str, ...]
    methods: tuple[str, ...]
    models: tuple[str, ...]
    asked: Mapping[str, Any]
    max_tokens: int | None

    def __call__(self) -> None:
        check_names(self.methods, self.models, self.asked, self.max_tokens)
        check_scenes(self.suites, self.tiers)


def shipment_of(
    plan: StudyPlan, asked: Mapping[str, Any], max_tokens: int | None, prompts: Path | None, more: Sequence[str | Path]
) -> Shipment:
    """What a study needs on another machine.

    Args:
        plan: Whose tasks, methods and models may be files.
        asked: Options of the models and the team, as `Method` takes them.
        max_tokens: The cap that bounds what models of unknown price may cost.
        prompts: Folder with own words for the roles.
        more: Files and folders that own code reads.

    Raises:
        ConfigError: A task stands in the running script itself, or a file is missing.
    """
    tasks = [task for suite in plan.suites for task in suite.tasks]
    in_script = [task for task in tasks if registry.made_in_main(task)]
    if in_script:
        raise ConfigError(
            f"task {in_script[0]!r} stands in the script itself, which workers of a cluster do not run: put it into a file of its "
            "own and name that (FILE.py:NAME)"
        )
    files: list[Path] = []
    for name in sorted(code_of_names((*tasks, *plan.methods, str(asked.get("detector") or "")), plan.models)):
        files += code_beside(user_path(split_arguments(name)[0].rpartition(":")[0]).absolute())
    for task in dict.fromkeys(tasks):
        files += _pictures_of(task)
    for place in (*([] if prompts is None else [prompts]), *map(Path, more)):
        files += all_below(user_path(place).absolute())
    files += _profiles_of(plan.models)
    ready = Ready(plan.suites, plan.perturb, plan.methods, plan.models, dict(asked), max_tokens)
    return Shipment(listed(files), config_folder().absolute(), package_versions(), ready)


def _pictures_of(task: str) -> list[Path]:
    if task.startswith(SET):
        place = user_path(task.partition(":")[2])
        if place.is_dir():
            return all_below(place)
        scenes = scenes_of(task)
        return [place, *(path for scene in scenes for path in (scene.picture, scene.mask) if path is not None)]
    if task.endswith(".json"):
        return [user_path(task), *(scene.picture for scene in read_photos(task))]
    return []


def _profiles_of(models: Iterable[str]) -> list[Path]:
    """The saved profiles that models are named by, or that simulated models err by; a profile holds no key."""
    saved, named = profile_names(), set()
    for model in models:
        chosen = choice_of(model)
        for name in [chosen] if isinstance(chosen, str) else chosen.values():
            named |= {name, name.removeprefix("simulated:").partition(":")[0]} & set(saved)
    return [profiles_folder() / f"{name}.json" for name in sorted(named)]
