"""The values that flow through the system: frozen, checked once when built, arrays read-only."""

from wonderful_team.types.asked import Answer, Note, Part, Request, Usage, Words
from wonderful_team.types.content import content_hash, file_hash
from wonderful_team.types.happened import GateCheck, GateReport, StepReport, SubgoalRun, Trial, Verdict
from wonderful_team.types.planned import (
    NO_WORKSPACE,
    Doubt,
    GroundedTarget,
    GroundingEvent,
    KeepOut,
    Limits,
    NumberSource,
    Plan,
    PlannedAction,
    PointRole,
    Provenance,
    Subgoal,
    Target,
)
from wonderful_team.types.read import ReadPlan
from wonderful_team.types.seen import Instruction, Observation, RobotState, Slot, SlotKind, View
from wonderful_team.types.true import TrueSight, TrueThing

__all__ = [
    "Answer",
    "Doubt",
    "GateCheck",
    "GateReport",
    "GroundedTarget",
    "GroundingEvent",
    "Instruction",
    "KeepOut",
    "Limits",
    "NO_WORKSPACE",
    "Note",
    "NumberSource",
    "Observation",
    "Part",
    "Plan",
    "PlannedAction",
    "PointRole",
    "Provenance",
    "ReadPlan",
    "Request",
    "RobotState",
    "Slot",
    "SlotKind",
    "StepReport",
    "Subgoal",
    "SubgoalRun",
    "Target",
    "Trial",
    "TrueSight",
    "TrueThing",
    "Usage",
    "Verdict",
    "View",
    "Words",
    "content_hash",
    "file_hash",
]
