"""Whoever reads a plan is told that a place is where the middle of the thing lands, and where the tool ends."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import wonderful_team as wt
from tests.planning.stub_model import stub_script
from wonderful_team.cli.wording import plan_lines
from wonderful_team.models.scripted import ScriptedModel

PHOTO = np.full((120, 160, 3), 128, np.uint8)


def reading(request: Any) -> dict[str, Any]:
    """The stub's boxes; the first thing is picked off the middle of its box."""
    found = stub_script()["ReadScene"](request)
    first = found["targets"][0]
    first["points"] = [
        {**point, "point": {"x": point["point"]["x"] + 5, "y": point["point"]["y"]}} for point in first["points"]
    ]
    return dict(found)


def made(out: Path, **changes: Any) -> wt.PlanResult:
    team = wt.Team(model=ScriptedModel({**stub_script(), **changes}), out=out)
    return team.plan(PHOTO, "put the first thing into the second thing")


def test_terminal_and_page_state_the_rule_where_it_matters(tmp_path: Path) -> None:
    plan = made(tmp_path, ReadScene=reading)
    lines = "\n".join(plan_lines(plan))
    assert "tool at (" in lines
    assert "note: a place is where the middle of the thing lands" in lines
    assert plan.page is not None
    assert "A place is where the middle of the thing lands." in plan.page.read_text(encoding="utf-8")


def test_nothing_is_said_where_both_are_one(tmp_path: Path) -> None:
    plan = made(tmp_path)
    assert "tool at" not in "\n".join(plan_lines(plan))
    assert plan.page is not None
    assert "lets go at" not in plan.page.read_text(encoding="utf-8")
