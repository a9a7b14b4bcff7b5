"""At least one valid subgoal: told by the simulator after the trial, and set beside whole success over models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from wonderful_team import registry
from wonderful_team.api.trial import run_trial
from wonderful_team.cli.app import run
from wonderful_team.evals.paper_filled import filled
from wonderful_team.evals.paper_tables import PAPER_TABLES
from wonderful_team.evals.trials import VALID_SUBGOAL, Condition, RunSettings, TrialSpec

SEED = 1000


def test_a_goal_that_an_action_reached_counts_whether_or_not_the_task_is_whole() -> None:
    world: Any = registry.make_world("tabletop/pick_in_order_then_restore", SEED)
    try:
        truth = world.privileged
        assert truth.subgoals_reached() == 0
        first = truth.oracle()[0]
        world.execute(first)
        assert truth.subgoals_reached() >= 1
        assert truth.score().success is False, "more is to be done"
    finally:
        world.close()


def test_things_gathered_count_one_by_one() -> None:
    world: Any = registry.make_world("tabletop/sweep_without_exceeding", SEED)
    try:
        truth = world.privileged
        assert truth.subgoals_reached() == 0
        for _ in range(8):
            if truth.score().success is not False or not (left := truth.oracle()):
                break
            world.execute(left[0])
        assert truth.subgoals_reached() >= 1
    finally:
        world.close()


def test_a_wrong_plan_may_hold_a_valid_subgoal() -> None:
    def facts(task: str, model: str) -> tuple[str, float]:
        row = run_trial(TrialSpec(f"tabletop/{task}", SEED, Condition("team:s1", model)), RunSettings())
        return row.outcome, row.facts[VALID_SUBGOAL]

    wrong = "simulated:perfect:wrong_plan=1"
    assert facts("rotate", "simulated:perfect") == ("success", 1.0)
    assert facts("rotate", wrong) == ("failure", 0.0), "its only move is left out"
    last_left_out = facts("pick_in_order_then_restore", f"{wrong}:seed=1")
    assert last_left_out == ("failure", 1.0), "what comes before the move that is left out is done"


def test_the_table_sets_both_side_by_side_over_models(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    table = PAPER_TABLES["subgoals"]
    head, lines = filled(table, None)
    assert not any(name.startswith("paper") for name in head), "the paper prints no number"
    assert lines[0][0] == "all tasks together"
    words = [
        "bench",
        "rotate",
        "--method",
        "team,team:s7",
        "--model",
        "simulated:perfect,simulated:perfect:wrong_plan=1",
    ]
    options = [
        "--seeds",
        "1000",
        "--no-control",
        "all",
        "--record",
        "none",
        "--jobs",
        "1",
        "--store",
        str(tmp_path / "s.db"),
    ]
    assert run([*words, *options, "--json"]) == 0
    json.loads(capsys.readouterr().out)
    from wonderful_team.evals.report.page import read_stores
    from wonderful_team.evals.summary import summarise

    rows, requests, _ = read_stores([tmp_path / "s.db"])
    head, lines = filled(table, summarise(rows, requests))
    overall = dict(zip(head, lines[0], strict=True))
    said = overall[f"ours: team:s7 | {VALID_SUBGOAL}"]
    assert "simulated:perfect: 100 %" in said
    assert "simulated:perfect:wrong_plan=1: 0 %" in said
    assert "[SIMULATED]" in said
