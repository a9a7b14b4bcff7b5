"""The values that flow through the system: frozen, checked once when built, arrays read-only."""

from wonderful_team.core.values.clarification import AskUser, Clarification
from wonderful_team.core.values.content import content_hash, file_hash
from wonderful_team.core.values.detection import Detection, DetectorRun, mask_from_runs, mask_to_runs
from wonderful_team.core.values.function import FunctionBox, HelperFunction
from wonderful_team.core.values.ground_truth import GroundTruthView, TrueThing
from wonderful_team.core.values.later_picture import LaterPicture, Pixels
from wonderful_team.core.values.limits import NO_WORKSPACE, Fingers, KeepOut, Limits
from wonderful_team.core.values.observation import Instruction, LaterView, Observation, RobotState, Slot, SlotKind, View
from wonderful_team.core.values.plan import (
    Alike,
    Critique,
    GroundedTarget,
    GroundingEvent,
    NumberSource,
    Plan,
    PlannedAction,
    PointRole,
    Provenance,
    Subgoal,
    Target,
)
from wonderful_team.core.values.plan_size import MAX_ACTIONS, MAX_FUNCTIONS, MAX_SUBGOALS, MAX_TARGETS, size_problem
from wonderful_team.core.values.read import ReadPlan
from wonderful_team.core.values.request import NOTEBOOK, Answer, Note, Part, Request, SentPicture, Usage, Words
from wonderful_team.core.values.result import (
    GOING_HOME,
    GateCheck,
    GateReport,
    HeightProfile,
    StepReport,
    SubgoalRun,
    Trial,
    Verdict,
    refusal_words,
)

__all__ = [
    "GOING_HOME",
    "NOTEBOOK",
    "Alike",
    "Answer",
    "AskUser",
    "Clarification",
    "Critique",
    "Detection",
    "DetectorRun",
    "FunctionBox",
    "GateCheck",
    "GateReport",
    "HeightProfile",
    "GroundTruthView",
    "GroundedTarget",
    "GroundingEvent",
    "HelperFunction",
    "Instruction",
    "Fingers",
    "KeepOut",
    "LaterPicture",
    "LaterView",
    "Limits",
    "MAX_ACTIONS",
    "MAX_FUNCTIONS",
    "MAX_SUBGOALS",
    "MAX_TARGETS",
    "NO_WORKSPACE",
    "Note",
    "NumberSource",
    "Observation",
    "Part",
    "Pixels",
    "Plan",
    "PlannedAction",
    "PointRole",
    "Provenance",
    "ReadPlan",
    "Request",
    "RobotState",
    "SentPicture",
    "Slot",
    "SlotKind",
    "StepReport",
    "Subgoal",
    "SubgoalRun",
    "Target",
    "Trial",
    "TrueThing",
    "Usage",
    "Verdict",
    "View",
    "Words",
    "content_hash",
    "file_hash",
    "mask_from_runs",
    "mask_to_runs",
    "refusal_words",
    "size_problem",
]
