"""A recorded plan read back, with the picture that it was made from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from wonderful_team.core.values import Observation, Plan, ReadPlan, View
from wonderful_team.errors import ConfigError
from wonderful_team.images import load_picture
from wonderful_team.record.plan_file import read_plan
from wonderful_team.record.stored import file_of_run, stored_observation


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
        record: Any = json.loads(file.read_text(encoding="utf-8"))
        named = [seen["hash"] for seen in record["planner"]["observations"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ConfigError(f"{file}: cannot be read: {error}") from error
    for number, name in enumerate(named):
        if name == plan.scene_hash:
            observation = _stored(Path(folder), record, number)
            return observation if observation is not None and observation.is_called(plan.scene_hash) else None
    return None


def _stored(folder: Path, record: Any, number: int) -> Observation | None:
    """With camera and depth where the record keeps them, else the pixels alone."""
    try:
        return stored_observation(folder, record, number)
    except (ConfigError, KeyError, TypeError, ValueError):
        pass
    try:
        seen = record["planner"]["observations"][number]
        pictures = {
            name: load_picture(file_of_run(folder, record["files"][key], name)) for name, key in seen["views"].items()
        }
        return Observation({name: View(name, name, 0.0, rgb) for name, rgb in pictures.items()})
    except (ConfigError, KeyError, TypeError, ValueError):
        return None
