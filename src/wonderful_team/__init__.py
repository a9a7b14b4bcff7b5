"""wonderful-team: pictures and instructions to checked, grounded, executable robot plans.

Everything a user needs stands here; the parts behind it are imported when they are first asked for.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from wonderful_team._version import __version__

if TYPE_CHECKING:
    from wonderful_team.actions import ARM, PICK_PLACE, At, Beside, PickPlace, PickPlaceStep, Vocabulary
    from wonderful_team.api import Team, load_run, make_world, rollout, task
    from wonderful_team.errors import WonderfulTeamError
    from wonderful_team.geometry import AffineCamera, Box, PinholeCamera, PlanarCamera, Pose
    from wonderful_team.interfaces import Act, Done, GaveUp, Model, Policy, Score, Situation, World
    from wonderful_team.made import FoundTarget, MadePlan, RecordedTrial
    from wonderful_team.methods import Method
    from wonderful_team.observe import Observation
    from wonderful_team.photos import instruction_with_pictures
    from wonderful_team.probing import probe_model
    from wonderful_team.registry import make_model
    from wonderful_team.runtime import Approval
    from wonderful_team.runtime.stored_run import StoredRun
    from wonderful_team.sims.tabletop import Scene
    from wonderful_team.studies import Study
    from wonderful_team.types import (
        Answer,
        Instruction,
        KeepOut,
        Limits,
        Plan,
        PlannedAction,
        Request,
        StepReport,
        Trial,
        View,
    )

_HOMES: dict[str, str] = {
    "ARM": "actions",
    "Act": "interfaces",
    "AffineCamera": "geometry",
    "Answer": "types",
    "Approval": "runtime",
    "At": "actions",
    "Beside": "actions",
    "Box": "geometry",
    "Done": "interfaces",
    "FoundTarget": "made",
    "GaveUp": "interfaces",
    "Instruction": "types",
    "KeepOut": "types",
    "Limits": "types",
    "MadePlan": "made",
    "Method": "methods",
    "Model": "interfaces",
    "Observation": "observe",
    "PICK_PLACE": "actions",
    "PickPlace": "actions",
    "PickPlaceStep": "actions",
    "PinholeCamera": "geometry",
    "Plan": "types",
    "PlanarCamera": "geometry",
    "PlannedAction": "types",
    "Policy": "interfaces",
    "Pose": "geometry",
    "RecordedTrial": "made",
    "Request": "types",
    "Scene": "sims.tabletop",
    "Score": "interfaces",
    "Situation": "interfaces",
    "StepReport": "types",
    "StoredRun": "runtime.stored_run",
    "Study": "studies",
    "Team": "api",
    "Trial": "types",
    "View": "types",
    "Vocabulary": "actions",
    "WonderfulTeamError": "errors",
    "World": "interfaces",
    "instruction_with_pictures": "photos",
    "make_model": "registry",
    "probe_model": "probing",
    "load_run": "api",
    "make_world": "api",
    "rollout": "api",
    "task": "api",
}
"""Public name to the module that defines it."""

__all__ = [
    "ARM",
    "Act",
    "AffineCamera",
    "Answer",
    "Approval",
    "At",
    "Beside",
    "Box",
    "Done",
    "FoundTarget",
    "GaveUp",
    "Instruction",
    "KeepOut",
    "Limits",
    "MadePlan",
    "Method",
    "Model",
    "Observation",
    "PICK_PLACE",
    "PickPlace",
    "PickPlaceStep",
    "PinholeCamera",
    "Plan",
    "PlanarCamera",
    "PlannedAction",
    "Policy",
    "Pose",
    "RecordedTrial",
    "Request",
    "Scene",
    "Score",
    "Situation",
    "StepReport",
    "StoredRun",
    "Study",
    "Team",
    "Trial",
    "View",
    "Vocabulary",
    "WonderfulTeamError",
    "World",
    "__version__",
    "instruction_with_pictures",
    "load_run",
    "make_model",
    "make_world",
    "probe_model",
    "rollout",
    "task",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'wonderful_team' has no attribute {name!r}; it has: {', '.join(__all__)}")
    value = getattr(importlib.import_module(f"wonderful_team.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
