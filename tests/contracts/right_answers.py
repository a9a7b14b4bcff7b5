"""A right answer to every question of `question_samples`, as a model writes it, and how a test gives a changed one."""

from __future__ import annotations

import copy
from typing import Any

from tests.agents.question_samples import SAMPLES
from wonderful_team.contracts import EDGES, AnswerModel, Question

QUESTION: dict[str, Any] = {question.contract: question for question in SAMPLES}
"""The sample of every contract."""


def target(name: str, *, like: tuple[str, ...] = (), use: tuple[str, ...] = ("pick",)) -> dict[str, Any]:
    return {
        "id": name, "kind": "object", "words": "striped mug", "part": None, "where": "", "like": [*like], "use": [*use]
    }  # fmt: skip


def subgoal(name: str, *, after: tuple[str, ...] = (), targets: tuple[str, ...] = ("T1",)) -> dict[str, Any]:
    return {"id": name, "text": "the mug is back", "after": [*after], "targets": [*targets], "function": None}


PLAN: dict[str, Any] = {
    "reasoning": "",
    "subgoals": [subgoal("G1"), subgoal("G2", after=("G1",), targets=("T1", "T2"))],
    "targets": [target("T1", like=("base_obj",)), target("T2")],
    "mode": "one_step",
    "clarification": None,
}
WALKED = {"before": "the picture", "doable": "yes", "after": "nothing", "asked": "yes"}
HOLE = {"use": "grasp", "why": "it lies in the hole"}
BOX = {"x0": 10, "y0": 5, "x1": 30.5, "y1": 20}
RIGHT: dict[str, dict[str, Any]] = {
    "DraftPlan": PLAN,
    "ReviewPlan": {
        "walk": [{**WALKED, "subgoal": "G2", "after": "it hits the lamp", "verdict": "wrong"}],
        "approved": False,
        "doubt": {"about": "G2", "kind": "collision", "question": "Is the way free?"},
    },
    "RevisePlan": {"reasoning": "", "decision": "revise", "answer": "It goes round the lamp.", "plan": PLAN},
    "ExtractTargets": {
        "reasoning": "",
        "targets": PLAN["targets"],
        "needs": [{"subgoal": "G1", "targets": ["T1"]}, {"subgoal": "G2", "targets": ["T1", "T2"]}],
    },
    "LocatePoints": {"reasoning": "", "found": True, "points": [{"x": 3, "y": 4}, {"x": 63.9, "y": 31}]},
    "ChooseMark": {"reasoning": "", "number": 3},
    "GiveBox": {"reasoning": "", "box": BOX},
    "ReadScene": {
        "reasoning": "",
        "targets": [
            {
                "id": "T7",
                "found": True,
                "box": BOX,
                "points": [{"role": "grasp", "point": {"x": 12, "y": 6}}, {"role": "pick", "point": {"x": 20, "y": 9}}],
            },
            {"id": "T8", "found": False, "box": None, "points": []},
        ],
    },
    "Presence": {"reasoning": "", "edges": [{"edge": edge, "inside": True, "outside": False} for edge in EDGES]},
    "JudgeBox": {"reasoning": "", "decision": "revise", "problem": "The handle is cut.", "wrong_points": [HOLE]},
    "JudgeBoxes": {
        "boxes": [
            {"target": "T8", "verdict": {"reasoning": "", "decision": "accept", "problem": "", "wrong_points": []}},
            {
                "target": "T7",
                "verdict": {"reasoning": "", "decision": "reject", "problem": "a cup", "wrong_points": []},
            },
        ]
    },
    "ReadTurn": {"reasoning": "", "number": 2},
    "JudgeRevision": {"reasoning": "", "decision": "take_after_go_on"},
    "MoveBox": {
        "reasoning": "",
        "action": "move",
        "right_px": 4,
        "down_px": 0,
        "grow_left_px": 0,
        "grow_top_px": 0,
        "grow_right_px": 0,
        "grow_bottom_px": 0,
        "cut_edges": ["right"],
    },
    "ChoosePoint": {"reasoning": "", "number": 2},
    "WriteSteps": {
        "reasoning": "",
        "steps": [
            {
                "subgoal": "G1",
                "kind": "pick_place",
                "pick": "T7",
                "place": {"target": "T8", "how": "beside", "side": "left"},
                "rotate_deg": -90,
            },
            {"subgoal": "G1", "kind": "follow", "function": "G1"},
            {
                "subgoal": "G2",
                "kind": "move",
                "to": {"target": "T7", "how": "origin", "side": None},
                "height": "clear",
            },
        ],
    },
    "ReviewSteps": {
        "walk": [{**WALKED, "subgoal": name, "verdict": "fine"} for name in ("G1", "G2")],
        "approved": False,
        "doubt": {"about": "2", "kind": "needless_step", "question": "Why move?"},
    },
    "WriteFunction": {"reasoning": "", "code": "def path(boxes):\n    return path_4({'T3': boxes['T7']})"},
    "ReviewPath": {"reasoning": "", "accepted": False, "problem": "It crosses the lamp."},
    "Remember": {"keep": True, "key": "lamp", "summary": "The mug stands on the lamp."},
    "JudgeSubgoal": {
        "reasoning": "",
        "status": "not_done",
        "evidence": "it lies beside it",
        "cause": "it slipped",
        "rest_holds": False,
        "what_changed": "the lamp was moved",
    },
    "JudgeOutcome": {
        "reasoning": "",
        "verdicts": [
            {"subgoal": "G1", "status": "done", "cause": None, "evidence": "it stands there"},
            {"subgoal": "G2", "status": "undone", "cause": "it slipped", "evidence": "it lies on the floor"},
        ],
    },
    "Replan": {"reasoning": "", "decision": "replan", "cause": "it slipped", "advice": "Pick it at the rim."},
}
RIGHT["PlanDirectly"] = {
    "reasoning": "",
    "subgoals": [{"id": "G1", "text": "the mug is on the tray", "after": [], "targets": ["T1", "T2"]}],
    "targets": [
        {
            **target("T1", like=("base_obj",), use=("pick",)),
            "box": BOX,
            "points": [{"role": "pick", "point": {"x": 12, "y": 6}}],
        },
        {
            **target("T2", use=("place",)),
            "box": None,
            "points": [{"role": "place", "point": {"x": 50, "y": 20}}],
        },
        {**target("T3"), "box": None, "points": []},
    ],
    "absent": ["T3"],
    "steps": [
        {
            "subgoal": "G1",
            "kind": "pick_place",
            "pick": "T1",
            "place": {"target": "T2", "how": "at", "side": None},
            "rotate_deg": 0,
        }
    ],
}
RIGHT["SelectMarks"] = {"reasoning": "", "numbers": [3, 1]}
RIGHT["ListObjects"] = {
    "reasoning": "",
    "objects": [{"name": "striped mug", "point": {"x": 12, "y": 6}}],
    "pictures": [{"picture": "base_obj", "words": "a tray"}],
}
RIGHT["PlanFromList"] = {
    "thoughts": "The mug goes onto the tray.",
    "subgoals": [{"id": "G1", "text": "the mug is on the tray", "after": [], "targets": ["T1", "T2"]}],
    "targets": [
        {"id": "T1", "kind": "object", "words": "striped mug", "points": [{"use": "pick", "x": 12, "y": 31}]},
        {"id": "T2", "kind": "object", "words": "tray", "points": [{"use": "place", "x": 50, "y": 20}]},
    ],
    "steps": [step | {"place": {"target": "T2", "how": "at"}} for step in RIGHT["PlanDirectly"]["steps"]],
}
RIGHT["DescribePictures"] = {"pictures": [{"picture": "base_obj", "words": "a tray"}]}
RIGHT["WriteProgram"] = {"reasoning": "", "code": "open_gripper()"}
RIGHT["JudgeFromBoxes"] = {"reasoning": "", "completed": False, "summary": "The mug lies on the floor."}
RIGHT["ListSubtasks"] = {
    "reasoning": "",
    "subtasks": [
        {
            "instruction": "put the mug onto the tray",
            "object_grasped": "striped mug",
            "object_unattached": "tray",
            "motion_direction": "",
        }
    ],
}
RIGHT["ChooseMotion"] = {
    "reasoning": "",
    "grasp_keypoint": "P2",
    "function_keypoint": "",
    "target_keypoint": "Q1",
    "pre_contact_tile": "",
    "post_contact_tile": "b3",
    "pre_contact_height": "",
    "post_contact_height": "same",
    "target_angle": 30,
}

LEAVE_OUT = object()
"""Given as a new value: the field is left out."""


def changed(contract: str, changes: dict[str, Any]) -> dict[str, Any]:
    """The right answer with other values at dotted places, as "plan.targets.0.words"."""
    answer = copy.deepcopy(RIGHT[contract])
    for place, value in changes.items():
        home: Any = answer
        *way, last = (int(part) if part.isdigit() else part for part in place.split("."))
        for part in way:
            home = home[part]
        if value is LEAVE_OUT:
            del home[last]
        else:
            home[last] = value
    return answer


def judged(question: Question, said: Any) -> tuple[AnswerModel, tuple[str, ...]]:
    """What the contract makes of an answer, given as JSON text or as values: the answer and what was repaired in it."""
    output = question.output()
    parsed = output.model_validate_json(said) if isinstance(said, str) else output.model_validate(said)
    return question.validate(parsed)
