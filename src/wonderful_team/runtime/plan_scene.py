"""The picture that a recorded plan was made from, for the freshness check when the plan runs later."""

from __future__ import annotations

import json
from pathlib import Path

from wonderful_team.errors import BadPictureError, ConfigError
from wonderful_team.images import load_picture
from wonderful_team.types import Observation, Plan, View


def read_plan_scene(folder: Path, plan: Plan) -> Observation | None:
    """The observation that `plan` was made from, as its run folder keeps it: pixels without depth and camera.

    With it, `rollout(..., plan=plan, plan_observation=...)` compares the regions that the plan relies on; without it
    the scene must be the same pixel for pixel.

    Returns:
        None when the folder does not hold that picture, unchanged.

    Raises:
        ConfigError: The folder's record cannot be read.
    """
    file = Path(folder) / "record.json"
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ConfigError(f"{file}: cannot be read: {error}") from error
    for seen in record["planner"]["observations"]:
        if seen["hash"] != plan.scene_hash:
            continue
        try:
            views = {
                name: View(
                    name, seen["cameras"][name], seen["time_s"], load_picture(Path(folder) / record["files"][key])
                )
                for name, key in seen["views"].items()
            }
        except BadPictureError:
            return None
        observation = Observation(views)
        return observation if observation.hash == plan.scene_hash else None
    return None
