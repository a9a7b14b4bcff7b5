"""The closed set of questions that a model can be asked: one file each, input and answer types together."""

from wonderful_team.contracts.arm_steps import arm_steps, can_carry, steps_of_moves
from wonderful_team.contracts.choose_mark import ChooseMark, MarkChoice
from wonderful_team.contracts.choose_motion import ChooseMotion, MotionMarks
from wonderful_team.contracts.choose_point import ChoosePoint, PointChoice
from wonderful_team.contracts.describe_pictures import DescribePictures, PictureWords
from wonderful_team.contracts.draft_plan import DraftPlan
from wonderful_team.contracts.extract_targets import ExtractTargets, SubgoalTargets, TargetList
from wonderful_team.contracts.give_box import BoxAnswer, GiveBox
from wonderful_team.contracts.judge_box import BoxVerdict, JudgeBox, WrongPoint
from wonderful_team.contracts.judge_boxes import BoxVerdicts, JudgeBoxes, TargetVerdict
from wonderful_team.contracts.judge_from_boxes import FoundBox, JudgeFromBoxes, TaskVerdict
from wonderful_team.contracts.judge_outcome import JudgeOutcome, Outcome, VerdictDraft
from wonderful_team.contracts.judge_revision import JudgeRevision, RevisionVerdict
from wonderful_team.contracts.judge_subgoal import JudgeSubgoal, SubgoalOutcome
from wonderful_team.contracts.list_objects import ListObjects, NamedPoint, ObjectList, SlotDescription
from wonderful_team.contracts.list_subtasks import ListSubtasks, SubtaskDraft, SubtaskList
from wonderful_team.contracts.locate_points import LocatePoints, Points
from wonderful_team.contracts.move_box import BoxMove, MoveBox
from wonderful_team.contracts.plan_directly import DirectPlan, PlanDirectly, PointedTarget, direct_plan_type, in_parts
from wonderful_team.contracts.plan_from_list import ListedObject, ListedPlan, PlanFromList, SlotWords, listed_plan
from wonderful_team.contracts.plans import (
    ClarificationDraft,
    MoveDraft,
    PlainPlan,
    PlanDraft,
    SubgoalDraft,
    TargetDraft,
)
from wonderful_team.contracts.presence import EdgePresence, Presence, PresenceAnswer, Strip
from wonderful_team.contracts.read_scene import ReadScene, RolePoint, SceneReading, SceneTarget
from wonderful_team.contracts.read_turn import ReadTurn, TurnChoice
from wonderful_team.contracts.remember import MemoryEntry, Remember
from wonderful_team.contracts.replan import Advice, Replan
from wonderful_team.contracts.review_path import PathReview, ReviewPath
from wonderful_team.contracts.review_plan import (
    GROUNDING_KINDS,
    CritiqueDraft,
    PlanReview,
    ReviewPlan,
    SubgoalCheck,
    WalkedReview,
)
from wonderful_team.contracts.review_steps import ReviewSteps
from wonderful_team.contracts.revise_plan import PlanRevision, RevisePlan
from wonderful_team.contracts.select_marks import MarkSelection, SelectMarks
from wonderful_team.contracts.shown import (
    EDGES,
    AnswerModel,
    BoxPx,
    Edge,
    PointPx,
    Question,
    ShownSlot,
    ShownTask,
    Tolerance,
)
from wonderful_team.contracts.steps import PlaceDraft, StepList, step_list_type
from wonderful_team.contracts.write_function import EarlierFunction, FunctionCode, WriteFunction
from wonderful_team.contracts.write_program import (
    Program,
    ProgramFunction,
    ProgramMove,
    ProgramRound,
    Reference,
    WriteProgram,
    program_for,
)
from wonderful_team.contracts.write_steps import WriteSteps

QUESTIONS: tuple[type[Question], ...] = (
    DraftPlan,
    ReviewPlan,
    RevisePlan,
    ExtractTargets,
    LocatePoints,
    ChooseMark,
    GiveBox,
    ReadScene,
    Presence,
    JudgeBox,
    JudgeBoxes,
    JudgeRevision,
    MoveBox,
    ChoosePoint,
    ReadTurn,
    WriteSteps,
    ReviewSteps,
    WriteFunction,
    ReviewPath,
    Remember,
    JudgeSubgoal,
    JudgeOutcome,
    Replan,
    PlanDirectly,
    SelectMarks,
    ListObjects,
    PlanFromList,
    DescribePictures,
    WriteProgram,
    JudgeFromBoxes,
    ListSubtasks,
    ChooseMotion,
)

__all__ = [
    "Advice",
    "AnswerModel",
    "BoxAnswer",
    "BoxMove",
    "BoxPx",
    "BoxVerdict",
    "BoxVerdicts",
    "ChooseMark",
    "ChooseMotion",
    "ChoosePoint",
    "ClarificationDraft",
    "CritiqueDraft",
    "DescribePictures",
    "DirectPlan",
    "DraftPlan",
    "EDGES",
    "Edge",
    "EdgePresence",
    "ExtractTargets",
    "FoundBox",
    "EarlierFunction",
    "FunctionCode",
    "GROUNDING_KINDS",
    "GiveBox",
    "JudgeBox",
    "JudgeBoxes",
    "JudgeFromBoxes",
    "JudgeOutcome",
    "JudgeRevision",
    "JudgeSubgoal",
    "ListObjects",
    "ListSubtasks",
    "ListedObject",
    "ListedPlan",
    "LocatePoints",
    "MarkChoice",
    "MarkSelection",
    "MemoryEntry",
    "MotionMarks",
    "MoveBox",
    "MoveDraft",
    "NamedPoint",
    "ObjectList",
    "Outcome",
    "PathReview",
    "PictureWords",
    "PlaceDraft",
    "PlanDirectly",
    "PlainPlan",
    "PlanDraft",
    "PlanFromList",
    "PlanReview",
    "PlanRevision",
    "PointChoice",
    "PointPx",
    "PointedTarget",
    "Points",
    "Presence",
    "PresenceAnswer",
    "Program",
    "ProgramFunction",
    "ProgramMove",
    "ProgramRound",
    "QUESTIONS",
    "Question",
    "ReadScene",
    "ReadTurn",
    "Reference",
    "Remember",
    "Replan",
    "ReviewPath",
    "ReviewPlan",
    "ReviewSteps",
    "RevisePlan",
    "RevisionVerdict",
    "RolePoint",
    "SceneReading",
    "SceneTarget",
    "SelectMarks",
    "ShownSlot",
    "ShownTask",
    "SlotDescription",
    "SlotWords",
    "StepList",
    "Strip",
    "SubgoalCheck",
    "SubgoalDraft",
    "SubgoalOutcome",
    "SubgoalTargets",
    "SubtaskDraft",
    "SubtaskList",
    "TargetDraft",
    "TargetList",
    "TargetVerdict",
    "TaskVerdict",
    "Tolerance",
    "TurnChoice",
    "VerdictDraft",
    "WalkedReview",
    "WriteFunction",
    "WriteProgram",
    "WriteSteps",
    "WrongPoint",
    "direct_plan_type",
    "in_parts",
    "listed_plan",
    "program_for",
    "arm_steps",
    "can_carry",
    "steps_of_moves",
    "step_list_type",
]
