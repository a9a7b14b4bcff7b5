"""Answers for measuring the loops: every question gets the first plausible answer, whatever the pictures show.

It sees nothing and is no planner; it exists so that waiting rounds, calls and bytes can be counted without a model.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, get_args, get_origin

from wonderful_team import contracts as c
from wonderful_team.core.values import Request
from wonderful_team.models.scripted import ScriptedModel

_TARGETS = [
    {
        "id": "T1",
        "kind": "object",
        "words": "the first thing",
        "part": None,
        "where": "",
        "like": [],
        "alike": "both",
        "use": ["pick"],
    },
    {
        "id": "T2",
        "kind": "object",
        "words": "the second thing",
        "part": None,
        "where": "",
        "like": [],
        "alike": "both",
        "use": ["place"],
    },
]


def stub_script() -> dict[str, Any]:
    """A script for ScriptedModel: one subgoal, two targets, no doubt, every first box accepted."""
    answers: dict[str, Callable[[Request], Any]] = {
        **{question.__name__: _plausible for question in c.QUESTIONS},
        "DraftPlan": lambda request: _draft(request.question.with_targets),
        "RevisePlan": lambda _: {"reasoning": "", "decision": "keep", "answer": "It stands.", "plan": None},
        "ExtractTargets": lambda _: {
            "reasoning": "",
            "targets": _TARGETS,
            "needs": [{"subgoal": "G1", "targets": ["T1", "T2"]}],
        },
        "ReviewPlan": lambda request: request.question.walked(
            c.PlanReview(reasoning="", approved=True, doubt=None)
        ).model_dump(exclude_unset=True),
        "ReviewSteps": lambda request: request.question.in_form(
            c.PlanReview(reasoning="", approved=True, doubt=None)
        ).model_dump(exclude_unset=True),
        "LocatePoints": lambda request: {"reasoning": "", "found": True, "points": [_centre(request)]},
        "ChooseMark": lambda _: {"reasoning": "", "number": 1},
        "GiveBox": lambda request: {"reasoning": "", "box": _box(request)},
        "ReadScene": _reading,
        "JudgeBoxes": lambda request: {
            "boxes": [
                {
                    "target": item.target.id,
                    "verdict": {"reasoning": "", "decision": "accept", "problem": "", "wrong_points": []},
                }
                for item in request.question.boxes
            ]
        },
        "Presence": lambda _: {
            "reasoning": "",
            "edges": [{"edge": edge, "inside": True, "outside": False} for edge in c.EDGES],
        },
        "JudgeRevision": lambda _: {"reasoning": "", "decision": "take_after_stop", "problem": ""},
        "MoveBox": lambda _: {
            "reasoning": "",
            "action": "move",
            "right_px": 1,
            "down_px": 0,
            "grow_left_px": 0,
            "grow_top_px": 0,
            "grow_right_px": 0,
            "grow_bottom_px": 0,
            "cut_edges": [],
        },
        "WriteSteps": _steps,
        "WriteFunction": lambda _: {
            "reasoning": "",
            "code": "def path(boxes):\n    x0, y0, x1, y1 = next(iter(boxes.values()))\n    return [(x0, y0), (x1, y1)]",
        },
        "Remember": lambda request: {
            "keep": True,
            "key": request.question.role,
            "summary": request.question.answered[:600],
        },
        "JudgeSubgoal": lambda _: {
            "reasoning": "",
            "status": "done",
            "evidence": "",
            "cause": None,
            "rest_holds": True,
            "what_changed": "",
        },
        "JudgeOutcome": lambda request: {
            "reasoning": "",
            "verdicts": [
                {"subgoal": s.id, "status": "done", "cause": None, "evidence": "taken for granted"}
                for s in request.question.subgoals
            ],
        },
        "PlanDirectly": _whole_plan,
        "ListObjects": lambda request: {
            "reasoning": "",
            "objects": [],
            "pictures": [{"picture": slot.name, "words": "a thing"} for slot in request.question.slots],
        },
        "PlanFromList": _listed_plan,
        "SelectMarks": lambda _: {"reasoning": "", "numbers": [1]},
        "DescribePictures": lambda request: {
            "pictures": [{"picture": slot.name, "words": "a thing"} for slot in request.question.slots],
        },
        "ListSubtasks": lambda _: {
            "reasoning": "",
            "subtasks": [
                {
                    "instruction": "put the first thing onto the second",
                    "object_grasped": "the first thing",
                    "object_unattached": "the second thing",
                    "motion_direction": "",
                }
            ],
        },
        "WriteProgram": lambda _: {"reasoning": "", "code": "task_completed()"},
    }
    return dict(answers)


def stub_model(delay_s: float = 0.0) -> ScriptedModel:
    """A model that agrees with everything and takes a fixed time per answer."""
    return ScriptedModel(stub_script(), delay_s=delay_s, name="stub")


def _plausible(request: Request) -> dict[str, Any]:
    """Yes, the first of several words, nothing to add: an answer to any question of which no more is expected."""
    return {name: _first(field.annotation) for name, field in request.output.model_fields.items()}


def _first(kind: Any) -> Any:
    if get_origin(kind) is Literal:
        return get_args(kind)[0]
    if type(None) in get_args(kind):
        return None
    return {str: "", bool: True, int: 1, float: 0.0}.get(kind, [])


def _draft(with_targets: bool) -> dict[str, Any]:
    targets = _TARGETS if with_targets else []
    move = {"pick": "T1", "place": {"target": "T2", "how": "at", "side": None}, "rotate_deg": 0}
    subgoal = {
        "id": "G1",
        "text": "put the first thing into the second thing",
        "after": [],
        "targets": [target["id"] for target in targets],
        "function": None,
        "move": move if with_targets else None,
    }
    return {"reasoning": "", "subgoals": [subgoal], "targets": targets, "mode": "one_step", "clarification": None}


def _whole_plan(request: Request) -> dict[str, Any]:
    draft, targets = _draft(True), []
    for number, target in enumerate(_TARGETS):
        x, y = _place(number, request)
        points = [{"role": role, "point": {"x": x, "y": y}} for role in ("pick", "place")[number : number + 1]]
        targets.append({**target, "box": _around(x, y, request), "points": points})
    goals = [{key: goal[key] for key in ("id", "text", "after", "targets")} for goal in draft["subgoals"]]
    steps = [{"subgoal": goal["id"], "kind": "pick_place", **goal["move"]} for goal in draft["subgoals"]]
    return {"reasoning": "", "subgoals": goals, "targets": targets, "absent": [], "steps": steps}


def _listed_plan(request: Request) -> dict[str, Any]:
    draft, (width, height) = _draft(True), request.question.size_px
    targets = [
        {
            "id": name,
            "kind": "object",
            "words": "a thing",
            "points": [{"use": use, "x": width * share, "y": height / 2}],
        }
        for name, use, share in (("T1", "pick", 0.3), ("T2", "place", 0.7))
    ]
    goals = [{key: goal[key] for key in ("id", "text", "after", "targets")} for goal in draft["subgoals"]]
    steps = [{"subgoal": goal["id"], "kind": "pick_place", **goal["move"]} for goal in draft["subgoals"]]
    thoughts = {"thoughts": "The first thing goes to the second."} if request.question.thoughts else {}
    return {**thoughts, "subgoals": goals, "targets": targets, "steps": steps}


def _place(number: int, request: Request) -> tuple[float, float]:
    width, height = request.question.view.size_px
    return width * (0.3 if number == 0 else 0.7), height * 0.5


def _number(request: Request) -> int:
    return 0 if request.question.target.id == "T1" else 1


def _centre(request: Request) -> dict[str, float]:
    x, y = _place(_number(request), request)
    return {"x": x, "y": y}


def _around(x: float, y: float, request: Request) -> dict[str, float]:
    half = 0.06 * request.question.view.size_px[0]
    return {"x0": x - half, "y0": y - half, "x1": x + half, "y1": y + half}


def _box(request: Request) -> dict[str, float]:
    return _around(*_place(_number(request), request), request)


def _reading(request: Request) -> dict[str, Any]:
    items = []
    for number, target in enumerate(request.question.targets):
        x, y = _place(number, request)
        points = [{"role": role, "point": {"x": x, "y": y}} for role in target.roles]
        items.append({"id": target.id, "found": True, "box": _around(x, y, request), "points": points})
    return {"reasoning": "", "targets": items}


def _steps(request: Request) -> dict[str, Any]:
    target = request.question.targets[-1].id
    step = {
        "subgoal": "G1",
        "kind": "pick_place",
        "pick": request.question.targets[0].id,
        "place": {"target": target, "how": "at", "side": None},
        "rotate_deg": 0,
    }
    return {"reasoning": "", "steps": [step]}
