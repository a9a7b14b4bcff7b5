"""wonderful-team: pictures and instructions to checked, grounded, executable robot plans.

Everything a user needs stands here; the parts behind it are imported when they are first asked for.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from wonderful_team._version import __version__
from wonderful_team.core.renamed import keep_module_names

if TYPE_CHECKING:
    from wonderful_team.api.method import Method
    from wonderful_team.api.observation import Observation
    from wonderful_team.api.photos import instruction_with_pictures
    from wonderful_team.api.probe import probe_model
    from wonderful_team.api.results import FoundTarget, PlanResult, TrialResult
    from wonderful_team.api.rollout import make_world, rollout, task
    from wonderful_team.api.study import Study
    from wonderful_team.api.team import Team, load_run
    from wonderful_team.core.actions import ARM, PICK_PLACE, At, Beside, PickPlace, PickPlaceStep, Vocabulary
    from wonderful_team.core.geometry import AffineCamera, Box, PinholeCamera, PlanarCamera, Pose
    from wonderful_team.core.protocols import (
        Act,
        Checked,
        Detector,
        Done,
        GaveUp,
        Model,
        Policy,
        Score,
        Situation,
        World,
    )
    from wonderful_team.core.values import (
        Answer,
        Detection,
        Fingers,
        Instruction,
        KeepOut,
        Limits,
        Plan,
        PlannedAction,
        Request,
        StepReport,
        Trial,
        Usage,
        View,
    )
    from wonderful_team.errors import WonderfulTeamError
    from wonderful_team.record.stored_run import StoredRun
    from wonderful_team.registry.detectors import make_detector
    from wonderful_team.registry.models import make_model
    from wonderful_team.runtime import Approval
    from wonderful_team.sims.tabletop import Scene

_HOMES: dict[str, str] = {
    "ARM": "core.actions",
    "Act": "core.protocols",
    "AffineCamera": "core.geometry",
    "Answer": "core.values",
    "Approval": "runtime",
    "At": "core.actions",
    "Beside": "core.actions",
    "Box": "core.geometry",
    "Checked": "core.protocols",
    "Detection": "core.values",
    "Detector": "core.protocols",
    "Done": "core.protocols",
    "Fingers": "core.values",
    "FoundTarget": "api.results",
    "GaveUp": "core.protocols",
    "Instruction": "core.values",
    "KeepOut": "core.values",
    "Limits": "core.values",
    "PlanResult": "api.results",
    "Method": "api.method",
    "Model": "core.protocols",
    "Observation": "api.observation",
    "PICK_PLACE": "core.actions",
    "PickPlace": "core.actions",
    "PickPlaceStep": "core.actions",
    "PinholeCamera": "core.geometry",
    "Plan": "core.values",
    "PlanarCamera": "core.geometry",
    "PlannedAction": "core.values",
    "Policy": "core.protocols",
    "Pose": "core.geometry",
    "TrialResult": "api.results",
    "Request": "core.values",
    "Scene": "sims.tabletop",
    "Score": "core.protocols",
    "Situation": "core.protocols",
    "StepReport": "core.values",
    "StoredRun": "record.stored_run",
    "Study": "api.study",
    "Team": "api.team",
    "Trial": "core.values",
    "Usage": "core.values",
    "View": "core.values",
    "Vocabulary": "core.actions",
    "WonderfulTeamError": "errors",
    "World": "core.protocols",
    "instruction_with_pictures": "api.photos",
    "make_detector": "registry.detectors",
    "make_model": "registry.models",
    "probe_model": "api.probe",
    "load_run": "api.team",
    "make_world": "api.rollout",
    "rollout": "api.rollout",
    "task": "api.rollout",
}
"""Public name to the module that defines it."""

_RENAMED = {"MadePlan": "PlanResult", "RecordedTrial": "TrialResult"}
"""Public names of the last release."""

__all__ = [
    "ARM",
    "Act",
    "AffineCamera",
    "Answer",
    "Approval",
    "At",
    "Beside",
    "Box",
    "Checked",
    "Detection",
    "Detector",
    "Done",
    "Fingers",
    "FoundTarget",
    "GaveUp",
    "Instruction",
    "KeepOut",
    "Limits",
    "PlanResult",
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
    "TrialResult",
    "Request",
    "Scene",
    "Score",
    "Situation",
    "StepReport",
    "StoredRun",
    "Study",
    "Team",
    "Trial",
    "Usage",
    "View",
    "Vocabulary",
    "WonderfulTeamError",
    "World",
    "__version__",
    "instruction_with_pictures",
    "load_run",
    "make_detector",
    "make_model",
    "make_world",
    "probe_model",
    "rollout",
    "task",
]


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        from wonderful_team.core.renamed import warn_renamed

        warn_renamed(f"wonderful_team.{name}", f"wonderful_team.{_RENAMED[name]}")
        name = _RENAMED[name]
    if name not in _HOMES:
        raise AttributeError(f"module 'wonderful_team' has no attribute {name!r}; it has: {', '.join(__all__)}")
    value = getattr(importlib.import_module(f"wonderful_team.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


keep_module_names(
    {
        "wonderful_team.replays": "wonderful_team.api.replay",
        "wonderful_team.interfaces": "wonderful_team.core.protocols",
        "wonderful_team.photos": "wonderful_team.api.photos",
    }
)
