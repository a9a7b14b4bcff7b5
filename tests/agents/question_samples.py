"""One full example of every question: no field is left at its default, so that nothing can hide."""

from __future__ import annotations

import zlib

import numpy as np

from wonderful_team.agents import ROLES
from wonderful_team.contracts import (
    ChooseMark,
    ChooseMotion,
    ChoosePoint,
    DescribePictures,
    DraftPlan,
    EarlierFunction,
    ExtractTargets,
    FoundBox,
    GiveBox,
    JudgeBox,
    JudgeBoxes,
    JudgeFromBoxes,
    JudgeOutcome,
    JudgeRevision,
    JudgeSubgoal,
    ListedObject,
    ListObjects,
    ListSubtasks,
    LocatePoints,
    MoveBox,
    PlanDirectly,
    PlanFromList,
    Presence,
    ProgramFunction,
    ProgramRound,
    Question,
    ReadScene,
    ReadTurn,
    Remember,
    Replan,
    ReviewPath,
    ReviewPlan,
    ReviewSteps,
    RevisePlan,
    SelectMarks,
    ShownSlot,
    ShownTask,
    SlotWords,
    Strip,
    WriteFunction,
    WriteProgram,
    WriteSteps,
)
from wonderful_team.core.actions import Beside, MoveStep, OriginOf, PickPlaceStep
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import Axes, BoxMark, Candidates, Grid, Mark, PathMark, Picture, PointMark, Tiles
from wonderful_team.core.values import Critique, Subgoal, Target, Verdict, View
from wonderful_team.images import edge_strips
from wonderful_team.registry.methods import METHODS

WANTED = "Put the {base_obj} onto the tray."
KINDS = ("pick_place", "push", "move", "open", "close", "rotate_gripper", "follow", "home", "navigate")


def picture(name: str, *marks: Mark, width: int = 64, height: int = 32) -> Picture:
    rgb = np.full((height, width, 3), list(zlib.crc32(name.encode()).to_bytes(4, "big")[:3]), dtype=np.uint8)
    return Picture(name, rgb, Frame.whole("top", (width, height)), marks=marks)


TASK = ShownTask(
    "Put the {dragged_obj} into the {base_obj}, then the {dragged_obj} back like in {scene_1}.",
    (picture("top view", Axes()), picture("front view")),
    (
        ShownSlot("dragged_obj", "object", (picture("dragged_obj top"), picture("dragged_obj front"))),
        ShownSlot("base_obj", "object", (picture("base_obj top"),)),
        ShownSlot("scene_1", "frame", (picture("scene_1 top"),), 3),
    ),
    ("the blade is as wide as a hand", "north is up"),
    ("the user wants the blue one",),
    ("[G1] push T1",),
)
EXAMPLES = (ShownSlot("base_obj", "object", (picture("example of base_obj"),)),)
TARGET = Target("T7", "object", "striped mug", "handle", "left of the plate", "slot", ("base_obj",), ("grasp", "pick"))
AREA = Target("T8", "area", "free space", None, "beside the lamp")
SUBGOALS = (
    Subgoal("G1", "the mug stands on the tray", (), ("T7", "T8"), "a circle round the tray"),
    Subgoal("G2", "the mug is back", ("G1",), ("T7",)),
)
DOUBT = Critique("G1", "collision", "will the mug hit the lamp?", "it passes behind it", True)
FUNCTIONS = ("path_4: a star on the cup (T3 was yellow cup)",)
PLAN = ("G1: the mug stands on the tray", "G2: the mug is back")
STEPS = (PickPlaceStep("G1", "T7", Beside("T8", "left"), -90.0), MoveStep("G2", OriginOf("T7"), "clear"))
BOX = BoxMark(Box(10, 5, 30, 20), label="T7")
MARKS = Candidates(((5.0, 5.0), (20.0, 10.0), (40.0, 20.0)))
_GRAIN = View("top", "camera", 0.0, np.random.default_rng(5).integers(0, 255, (32, 64, 3), dtype=np.uint8))
STRIPS = tuple(Strip(*where, strip) for where, strip in edge_strips(_GRAIN, Box(20, 10, 44, 22)).items())

SAMPLES: tuple[Question, ...] = (
    DraftPlan(TASK, KINDS, True, ("the lid was closed",), FUNCTIONS),
    ReviewPlan(TASK, KINDS, SUBGOALS, (TARGET, AREA), "G2", ("G1 was asked about the lid",)),
    RevisePlan(TASK, KINDS, SUBGOALS, (TARGET, AREA), DOUBT, True, FUNCTIONS),
    ExtractTargets(TASK, SUBGOALS),
    LocatePoints(
        TARGET,
        "centre",
        PLAN,
        picture("main view", Axes(), PointMark((3, 4), "tried 1")),
        (picture("side"),),
        EXAMPLES,
        3,
        ("rejected: the Checker saw a cup there",),
        WANTED,
    ),
    ChooseMark(TARGET, "place", PLAN, picture("guesses", Axes(), MARKS), EXAMPLES, WANTED),
    GiveBox(
        TARGET, PLAN, picture("centred", Axes(), PointMark((20, 10))), EXAMPLES, ("rejected: on the lamp",), WANTED
    ),
    ReadScene((TARGET, AREA), PLAN, picture("whole", Axes()), (picture("other side"),), EXAMPLES, WANTED),
    Presence(TARGET, STRIPS, EXAMPLES),
    JudgeBox(
        TARGET,
        picture("crop", BOX, Axes(), PointMark((20, 10), "grasp")),
        EXAMPLES,
        ("grasp",),
        picture("thumbnail", BOX),
        picture("accepted twin"),
        picture("crop of scene_1", BOX),
    ),
    JudgeBoxes(
        (
            JudgeBox(TARGET, picture("crop of T7", BOX, Axes()), EXAMPLES),
            JudgeBox(AREA, picture("crop of T8", BOX), ()),
        )
    ),
    JudgeRevision(TARGET, picture("crop before", BOX), picture("crop after", BOX), EXAMPLES),
    MoveBox(
        TARGET,
        picture("crop now", BOX, Axes()),
        STRIPS,
        "the right edge cuts it",
        ("moved 4 right: kept",),
        True,
        EXAMPLES,
    ),
    ChoosePoint(
        TARGET,
        "grasp",
        PLAN,
        picture("crop points", BOX, MARKS),
        True,
        EXAMPLES,
        ("rejected: in the hole",),
        picture("all of it", BOX),
        WANTED,
    ),
    ReadTurn(
        TARGET,
        picture("turns", BoxMark(Box(0, 4, 20, 24), label="goal"), Tiles((Box(24, 4, 40, 20), Box(44, 4, 60, 20)))),
        (150.0, 155.0),
        "the pictures {before_1} and {after_1}",
        True,
    ),
    WriteSteps(TASK, KINDS, SUBGOALS, (TARGET, AREA), ("G1",), "step 2 turns the wrong way"),
    ReviewSteps(
        TASK,
        SUBGOALS,
        (TARGET, AREA),
        STEPS,
        picture("overview", BOX),
        ("step 1 was asked about",),
        ("step 1: carried high",),
        False,
        KINDS,
    ),
    WriteFunction(
        SUBGOALS[0],
        picture("view for path"),
        {"T7": Box(1.5, 2, 3, 4)},
        "NameError: x",
        "def path(boxes): ...",
        17,
        0.35,
        (
            EarlierFunction(
                "path_4",
                "a star on the cup",
                {"T3": "yellow cup", "T5": "lid of the cup"},
                "def path(boxes):\n    return star((1, 2), 3)",
                picture("path_4", BoxMark(Box(1, 2, 9, 9), label="T3"), PathMark(((1, 2), (3, 4)), "path_4")),
                (0.0, 0.25),
            ),
        ),
        ("the star was too small",),
        ("Tool: a pen, 3 mm wide.",),
    ),
    ReviewPath(
        SUBGOALS[0],
        picture("view with path", PathMark(((1, 2), (3, 4)), "G1")),
        (0.0, 0.1),
        (picture("side view with path"),),
    ),
    Remember("put it there", "checker", "is the box right?", "it is on the lamp", ("which mug",)),
    JudgeSubgoal(
        TASK,
        SUBGOALS[0],
        SUBGOALS,
        (TARGET, AREA),
        ("[G1] pick T7",),
        (picture("top now"), picture("front now")),
        ("ok",),
        ("T8 (lamp): the picture there has changed",),
    ),
    JudgeOutcome(
        TASK, SUBGOALS, (TARGET, AREA), ("[G1] pick T7",), (picture("top now"), picture("front now")), ("ok",)
    ),
    Replan(
        TASK,
        SUBGOALS,
        (Verdict("G2", "not_done", "it slipped", "mug on the floor"),),
        ("suction failed",),
        2,
        FUNCTIONS,
    ),
    PlanDirectly(
        TASK,
        ("pick_place", "push", "move", "open", "close", "rotate_gripper", "home", "navigate"),
        ("step 1: too far left",),
    ),
    SelectMarks(TARGET, "grasp", picture("marks", MARKS), 2, EXAMPLES),
    ListObjects(picture("table", Axes()), EXAMPLES),
    PlanFromList(
        WANTED,
        (ListedObject("striped mug", 12, 31),),
        (SlotWords("base_obj", "a tray of wood"),),
        "wide view",
        (64, 32),
        ("pick_place", "push"),
        True,
        "the example of a cone",
        ("the blade is as wide as a hand",),
        ("step 1: too far left",),
        (picture("the table now"),),
        EXAMPLES,
        picture("the cone"),
    ),
    DescribePictures(EXAMPLES),
    WriteProgram(
        WANTED,
        (ProgramFunction("detect_object(name)", "looks for a thing"), ProgramFunction("open_gripper()", "lets go")),
        ("pick_place", "push"),
        "wide view",
        (64, 32),
        (SlotWords("base_obj", "a tray of wood"),),
        (ProgramRound("print(detect_object('mug'))", "1 found: mug"),),
        "the example of a cone",
        ("the blade is as wide as a hand",),
        ("step 1: too far left",),
    ),
    JudgeFromBoxes(
        WANTED,
        (SlotWords("base_obj", "a tray of wood"),),
        "wide view",
        (64, 32),
        (FoundBox("striped mug", 12, 31, 9, 7, 45),),
        (FoundBox("striped mug", 50, 20, 10, 8, 135),),
    ),
    ListSubtasks(TASK, ("pick_place", "push"), ("step 1: too far left",)),
    ChooseMotion(
        "put the mug onto the tray",
        "striped mug",
        "wooden tray",
        "from left to right",
        picture(
            "marked view", Candidates(((5.0, 5.0), (20.0, 10.0)), "P"), Candidates(((40.0, 20.0),), "Q"), Grid(5, 5)
        ),
        ("pick_place", "push"),
        ("put the spoon into the mug (ends at Q1 of mug)",),
    ),
)

RIVALS = {
    contract: asker
    for row in METHODS.values()
    for asker in row.roles
    for contract in asker.asks
    if all(contract not in member.asks for member in ROLES.values())
}
"""Who asks what no member of the team asks, by contract."""
