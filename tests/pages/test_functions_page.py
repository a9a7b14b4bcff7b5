"""The helper functions of a trial stand in its record and on its page: what each plan brought, and what it could call."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

from tests.pages.test_page import read
from tests.planning.rounds import photo
from tests.planning.test_functions_kept import FRAME, drawing, goal
from wonderful_team.core.actions import ARM
from wonderful_team.core.values import Instruction
from wonderful_team.pages import write_page
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.record import Recorder
from wonderful_team.record.record_schema import read_record


def test_record_and_page_tell_of_functions(tmp_path: Path) -> None:
    model = drawing(goal("G1", "T1", "a <b>frame</b> round T1"))
    with Recorder(tmp_path, command="wonderful-team plan") as recorder:
        team = TeamPolicy(model, TeamConfig(), subscribers=[recorder])
        plan = asyncio.run(team.make_plan(photo(), Instruction("draw round the block"), ARM))
        asyncio.run(team.make_plan(photo(), Instruction("draw round the block"), ARM, parent=plan.id))
    record = read_record(tmp_path)
    first, second = (one["plan"]["functions"] for one in record["planner"]["plans"])
    assert first == second
    assert [(one["name"], one["code"]) for one in first] == [("path_1", FRAME)]
    told = [one["text"] for one in record["planner"]["stages"] if one["name"] == "function"]
    assert told == [
        "G1: accepted, kept as path_1 (a <b>frame</b> round T1)",
        "G1: accepted, the path of path_1 again (a <b>frame</b> round T1)",
    ]
    write_page(tmp_path)
    _, text = read(tmp_path / "page.html")
    assert "path_1: a <b>frame</b> round T1 · T1 is the red block def path(boxes): x0, y0, x1, y1 = boxes['T1']" in text
    assert text.count("Helper functions kept from before: path_1.") == 1


def test_the_page_of_an_earlier_release_tells_of_none(tmp_path: Path) -> None:
    with Recorder(tmp_path, command="wonderful-team plan") as recorder:
        team = TeamPolicy(drawing(goal("G1", "T1")), TeamConfig(), subscribers=[recorder])
        asyncio.run(team.make_plan(photo(), Instruction("draw round the block"), ARM))
    file = tmp_path / "record.json"
    text = file.read_text(encoding="utf-8")
    assert '"functions"' in text
    record = json.loads(text)
    for one in record["planner"]["plans"]:
        del one["plan"]["functions"]
    file.write_text(json.dumps(record), encoding="utf-8")
    write_page(tmp_path)
    _, page = read(tmp_path / "page.html")
    assert "Helper functions" not in page
