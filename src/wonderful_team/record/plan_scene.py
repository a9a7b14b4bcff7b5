"""A recorded plan read back, with the picture that it was made from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from wonderful_team.core.values import Observation, Plan, ReadPlan, View
from wonderful_team.errors import ConfigError
from wonderful_team.images import load_picture
from wonderful_team.record.plan_file import read_plan
from wonderful_team.record.record_schema import grown_record
from wonderful_team.record.stored import file_of_run, observation_of


def read_run_plan(folder: Path) -> ReadPlan:
    """The plan of a recorded run, with the picture it was made from where the folder holds it unchanged.

    Raises:
        ConfigError: The folder holds no plan of ours, or its record cannot be read.
    """
    folder = Path(folder)
    plan = read_plan(folder)
    page = folder / "page.html"
    return ReadPlan(plan, read_plan_scene(folder, plan), page if page.is_file() else None, same_clock=False)


def read_plan_scene(folder: Path, plan: Plan) -> Observation | None:
    """The observation that `plan` was made from, as its run folder keeps it.

    Returns:
        None when the folder does not hold that picture, unchanged.

    Raises:
        ConfigError: The folder's record cannot be read.
    """
    file = Path(folder) / "record.json"
    try:
        record: Any = grown_record(Path(folder))
        # A run that was handed its plan keeps what that was made from apart from what it saw itself.
        seen = [*record["planner"]["observations"], *filter(None, [record["planner"].get("plan_scene")])]
        named = [entry["hash"] for entry in seen]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ConfigError(f"{file}: cannot be read: {error}") from error
    for name, entry in zip(named, seen, strict=True):
        if name == plan.scene_hash:
            observation = _stored(Path(folder), record, entry)
            return observation if observation is not None and observation.is_called(plan.scene_hash) else None
    return None


def _stored(folder: Path, record: Any, entry: Any) -> Observation | None:
    """With camera and depth where the record keeps them, else the pixels alone."""
    try:
        return observation_of(folder, record, entry)
    except (ConfigError, KeyError, TypeError, ValueError):
        pass
    try:
        pictures = {
            name: load_picture(file_of_run(folder, record["files"][key], name)) for name, key in entry["views"].items()
        }
        return Observation({name: View(name, name, 0.0, rgb) for name, rgb in pictures.items()})
    except (ConfigError, KeyError, TypeError, ValueError):
        return None
