"""Names to things: models, methods, worlds and tasks. The only place where a string picks an implementation."""

from wonderful_team.registry.detectors import DEFAULT_DETECTOR, DETECTORS, detector_label, make_detector
from wonderful_team.registry.methods import (
    METHODS,
    MethodSetup,
    TeamMode,
    load_method,
    looks_with_detector,
    make_method,
    method_row,
    team_mode,
)
from wonderful_team.registry.models import (
    DEFAULT_ROLE,
    MODEL_FORMS,
    MODELS,
    make_model,
    make_models,
    model_label,
    named_by_profile,
)
from wonderful_team.registry.worlds import (
    WORLDS,
    check_ready,
    made_in_main,
    make_world,
    own_tiers,
    scene_name,
    task_made_of,
    task_names,
    task_partitions,
)

__all__ = [
    "DEFAULT_DETECTOR",
    "DEFAULT_ROLE",
    "DETECTORS",
    "METHODS",
    "MODELS",
    "MODEL_FORMS",
    "MethodSetup",
    "TeamMode",
    "WORLDS",
    "check_ready",
    "detector_label",
    "load_method",
    "looks_with_detector",
    "made_in_main",
    "make_detector",
    "make_method",
    "method_row",
    "make_model",
    "make_models",
    "make_world",
    "model_label",
    "named_by_profile",
    "own_tiers",
    "scene_name",
    "task_made_of",
    "task_names",
    "task_partitions",
    "team_mode",
]
