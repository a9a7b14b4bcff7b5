"""Verdicts on what was drawn, wiped and shaken: by what changed in the picture, and else by what the robot measured."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.offline.answers.tables import ask, picture, table, task
from wonderful_team.contracts import DraftPlan, JudgeOutcome, Outcome, PlanDraft
from wonderful_team.core.actions import ARM
from wonderful_team.core.values import View

CLEAN = table(("square", "green", 200, 160, 80), ("disc", "red", 480, 160, 80))
FOLLOWED = ("G1: trajectory executed: force n = 2.000", "G1: home executed")
STOPPED = ("G1: trajectory not executed, fault: stopped by contact",)


def marked(view: View, x: int) -> View:
    """The same table with a dark line round a point."""
    rgb = np.array(view.rgb)
    cv2.circle(rgb, (x, 160), 40, (20, 25, 115), 3)
    return View("top", "top", 0.0, rgb)


def soiled(view: View) -> View:
    """The same table with dark specks on the bowl."""
    rgb = np.array(view.rgb)
    for k in range(9):
        cv2.circle(rgb, (450 + 30 * (k % 3), 130 + 30 * (k // 3)), 8, (60, 45, 20), -1)
    return View("top", "top", 0.0, rgb)


def verdict(text: str, after: View, measured: tuple[str, ...], before: View = CLEAN) -> str:
    tool = "sponge" if text.startswith("wipe") else "pen"
    shown = replace(task(text, before), facts=(f"Tool: a {tool} that the gripper holds from the start.",))
    plan = ask(DraftPlan(shown, ARM.step_kinds, True))
    assert isinstance(plan, PlanDraft)
    answer = ask(JudgeOutcome(shown, plan.to_subgoals(), plan.to_targets(), (), (picture(after),), measured))
    assert isinstance(answer, Outcome)
    return answer.verdicts[0].status


@pytest.mark.parametrize(
    ("x", "measured", "status"),
    [(200, FOLLOWED, "done"), (480, FOLLOWED, "not_done"), (-100, FOLLOWED, "not_done"), (-100, STOPPED, "not_done")],
)
def test_a_figure_is_drawn_where_a_line_shows(x: int, measured: tuple[str, ...], status: str) -> None:
    assert verdict("draw a circle on the green square", marked(CLEAN, x), measured) == status


def test_a_surface_that_looks_as_before_was_perhaps_clean_and_one_that_changed_was_wiped() -> None:
    assert verdict("wipe the red bowl", CLEAN, FOLLOWED) == "unclear"
    assert verdict("wipe the red bowl", CLEAN, STOPPED) == "not_done"
    assert verdict("wipe the red bowl", CLEAN, FOLLOWED, before=soiled(CLEAN)) == "done"


def test_shaking_shows_in_no_picture_so_the_robot_says_whether_it_was_done() -> None:
    gone = table(("square", "green", 200, 160, 80), ("disc", "red", 100, 60, 40))
    assert verdict("shake the red bowl", CLEAN, FOLLOWED) == "done"
    assert verdict("shake the red bowl", CLEAN, STOPPED) == "not_done"
    assert verdict("shake the red bowl", gone, FOLLOWED) != "done"
