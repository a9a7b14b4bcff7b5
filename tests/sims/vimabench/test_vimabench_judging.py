"""The stage and the reason of a failure, from what the simulator tells a scorer."""

from __future__ import annotations

from typing import Any

import pytest

from wonderful_team.sims.vimabench.judging import score_of

STEP = {"under_pick": None, "under_place": None, "moved": []}
UNMET = {"thing": "block 1", "off_m": 0.2, "off_rad": 0.0, "within_m": 0.1, "zone": False, "target_m": [0.5, 0.0]}


def said(state: str = "open", *steps: dict[str, Any], **more: Any) -> dict[str, Any]:
    told = {"state": state, "ended_at": len(steps) if state != "open" else None, "steps": len(steps), "horizon": 5}
    history = [{**STEP, **step} for step in steps]
    return {**told, "pushed": False, "wanted": ["block 1"], "unmet": [UNMET], "late": False, "history": history, **more}


def test_success_has_no_stage_and_a_late_arm_no_score() -> None:
    assert score_of(said("success", {"under_pick": "block 1"})).success is True
    assert score_of(said("open", {"under_pick": "block 1"}, late=True)).success is None
    # What was reached before the simulator broke stays reached.
    assert score_of(said("failure", {"under_pick": "block 1"}, late=True)).success is False


@pytest.mark.parametrize(
    ("state", "moved", "stage"),
    [
        ("open", [], "grounding"),
        ("open", ["block 2"], "wrong object"),
        ("open", ["block 1", "block 2"], "execution"),
        ("failure", ["block 1", "block 2"], "plan"),
    ],
)
def test_stages_of_pushes(state: str, moved: list[str], stage: str) -> None:
    # Nothing is left to do where too many blocks were pushed in: the stage must not depend on it.
    told = said(state, {"moved": moved}, pushed=True, unmet=[{**UNMET, "zone": True}] if state == "open" else [])
    assert score_of(told).stage == stage


def test_a_thing_that_was_never_touched_is_a_failure_of_the_plan() -> None:
    told = said("open", {"under_pick": "block 1"}, wanted=["block 1", "block 2"], unmet=[{**UNMET, "thing": "block 2"}])
    score = score_of(told)
    assert score.stage == "plan"
    assert "block 2 is 0.200 m from its place, allowed are 0.1 m" in score.reason


def test_the_horizon_is_named_when_it_was_reached() -> None:
    assert "horizon of 5 actions" in score_of(said("open", *[{"under_pick": "block 1"}] * 5)).reason
    assert "horizon" not in score_of(said("open", {"under_pick": "block 1"})).reason


def test_a_turn_that_is_off_is_told_in_degrees() -> None:
    assert "turned 60 degrees off" in score_of(said("open", unmet=[{**UNMET, "off_rad": 1.0472}])).reason
