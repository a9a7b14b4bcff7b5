"""A path is computed from a box: an area that one is led over gets a box in the paper's way too, where other areas get points."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from tests.planning.helpers import asked, draft, plan_with, scripted, subgoal
from wonderful_team.core.actions import ARM
from wonderful_team.core.values import Plan


def test_an_area_gets_a_box_only_where_a_function_needs_it() -> None:
    for function, boxes in (("a star on T2", 2), (None, 1)):
        goal = subgoal("G1", function=function)
        listed = draft(goal)["targets"]
        listed[1] |= {"kind": "area", "alike": "both"}
        model = scripted(
            DraftPlan=draft({**goal, "targets": []}) | {"targets": []},
            ExtractTargets={"reasoning": "", "targets": listed, "needs": [{"subgoal": "G1", "targets": ["T1", "T2"]}]},
        )
        plan = plan_with(model, vocabulary=ARM)
        assert len(asked(model, "GiveBox")) == boxes
        assert (plan.grounded["T2"].box is not None) == (function is not None)


@pytest.mark.parametrize("method", ["team", "team:paper"])
def test_a_star_is_drawn_on_paper_by_either_way(method: str, tmp_path: Path) -> None:
    rgb = np.full((400, 640, 3), (222, 218, 208), np.uint8)
    cv2.rectangle(rgb, (250, 120), (390, 260), (230, 200, 40), -1)
    made = wt.Team(model="offline", method=method, out=tmp_path).plan(
        rgb,
        "draw a five-pointed star on the yellow paper",
        vocabulary="arm",
        facts="Tool: a pen that the gripper holds from the start, its tip down.",
    )
    plan: Plan = made.plan
    assert plan.status == "planned", plan.message
    assert Counter(step.kind for step in plan.steps)["follow"] == 1
    points = [source.point_px for action in plan.actions for source in action.sources if source.role == "waypoint"]
    assert len(points) == 11, "a star's ten corners, closed"
    assert all(250 <= x <= 390 and 120 <= y <= 260 for x, y in points)
