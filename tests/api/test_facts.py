"""What is said of the robot with `plan` reaches the planner and the record."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from tests.agents.test_agent_requests import shown
from tests.planning.stub_model import stub_script
from wonderful_team.cli.app import run
from wonderful_team.images import to_png
from wonderful_team.models.scripted import ScriptedModel

PHOTO = np.full((120, 160, 3), 128, np.uint8)


@pytest.mark.parametrize(
    ("facts", "said"), [(None, "Nothing is known of the robot's tool"), ("Tool: a hook.", "- Tool: a hook.")]
)
def test_a_photo_is_planned_with_what_is_known_of_the_robot(facts: str | None, said: str, tmp_path: Path) -> None:
    model = ScriptedModel(stub_script())
    made = wt.Team(model=model, out=tmp_path).plan(PHOTO, "put the first thing into the second thing", facts=facts)
    assert made.status == "planned"
    asked = [request for request in model.requests if request.contract == "ReviewSteps"]
    assert asked
    assert all(said in shown(request) for request in asked)


def test_the_command_takes_facts_and_the_record_keeps_them(tmp_path: Path) -> None:
    image = tmp_path / "desk.png"
    image.write_bytes(to_png(PHOTO))
    run(
        [
            "plan",
            str(image),
            "put the red block left of it",
            "--facts",
            "Tool: a hook.",
            "--out",
            str(tmp_path / "runs"),
        ]
    )
    record = json.loads((tmp_path / "runs" / "latest" / "record.json").read_text(encoding="utf-8"))
    assert record["setup"]["facts"] == "Tool: a hook."
    first = record["planner"]["requests"][0]
    assert any("- Tool: a hook." in part.get("words", "") for part in first["parts"])
