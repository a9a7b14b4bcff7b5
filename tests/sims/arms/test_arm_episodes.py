"""Whole episodes, planner and gate included."""

from __future__ import annotations

import pytest

import wonderful_team as wt
from tests.sims.arms.needed import needs_arms
from tests.sims.arms.playing import by_team


@needs_arms
@pytest.mark.parametrize("model", ["offline", pytest.param("simulated:perfect", marks=pytest.mark.slow)])
def test_a_block_goes_into_the_bowl(model: str) -> None:
    trial = by_team("arms/block_in_bowl", 2, model)
    assert trial.outcome == "success", trial.reason
    assert all(report.executed for report in trial.reports)
    assert [report.action.kind for report in trial.reports][-1] == "home"


@needs_arms
@pytest.mark.slow
@pytest.mark.parametrize("variation", ["all_match", "no_area", "misplaced", "both"])
def test_fruits_go_onto_papers_of_their_colour(variation: str) -> None:
    trial = by_team(f"arms/fruit_placement/{variation}", 2)
    assert trial.outcome == "success", trial.reason


@needs_arms
@pytest.mark.parametrize("task", ["star", pytest.param("wipe", marks=pytest.mark.slow)])
def test_a_written_path_is_run_in_the_sandbox_reviewed_and_followed_by_touch(task: str) -> None:
    trial = by_team(f"arms/{task}", 2)
    assert trial.outcome == "success", trial.reason
    (path,) = (report.action for report in trial.reports if report.action.kind == "trajectory")
    assert path.waypoints_m[0][2] > 0.15  # type: ignore[union-attr]
    assert trial.plans[-1].subgoals[0].function


@needs_arms
@pytest.mark.parametrize("task", ["cap", pytest.param("shake", marks=pytest.mark.slow)])
def test_bottles_are_opened_and_shaken_by_a_plan_that_was_checked(task: str) -> None:
    trial = by_team(f"arms/{task}", 2)
    assert trial.outcome == "success", trial.reason
    assert "close" in {step.kind for step in trial.plans[-1].steps if getattr(step, "tight", False)}
    wanted = "rotate_gripper" if task == "cap" else "trajectory"
    assert wanted in [report.action.kind for report in trial.reports]


@needs_arms
@pytest.mark.parametrize(
    "task",
    [
        "star",
        "cap",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("wipe", "shake", "lid_box/one", "lid_box/two")),
    ],
)
def test_offline_solves_it_from_pictures_and_words(task: str) -> None:
    trial = by_team(f"arms/{task}", 2, "offline")
    assert trial.outcome == "success", trial.reason
    assert all(report.executed for report in trial.reports)


@needs_arms
@pytest.mark.parametrize(("words", "said"), [
    ("draw a pentagon with the sponge on the green paper", "a sponge draws nothing"),
    ("wipe the green paper", "the gripper holds a pen, and nothing that wipes"),
])  # fmt: skip
def test_a_tool_that_does_something_else_is_asked_about(words: str, said: str) -> None:
    world = wt.make_world("arms/star", seed=2)
    colour = world.instruction.text.split()[-2]
    try:
        text = words.replace("green", colour)
        plan = wt.Team(model="offline").plan(world.observe(), text, limits=world.limits, facts=world.facts)
    finally:
        world.close()
    assert plan.status == "needs_clarification"
    assert said[1:] in plan.message
