"""A doubt about a target's point stands on the page with who answered it, and in the record's story of the target."""

from __future__ import annotations

import asyncio
from pathlib import Path

from tests.pages.test_page import read
from tests.planning.helpers import APPROVED, scripted
from tests.planning.rounds import photo
from tests.planning.test_doubted_targets import HOLE, chosen, wrong
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import Instruction
from wonderful_team.pages import write_page
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.record import Recorder


def test_the_page_tells_that_a_point_was_chosen_anew(tmp_path: Path) -> None:
    model = scripted(ReviewSteps=[wrong(), APPROVED], ChoosePoint=chosen(4))
    with Recorder(tmp_path, command="wonderful-team plan") as recorder:
        team = TeamPolicy(model, TeamConfig(mode="lean"), subscribers=[recorder])
        asyncio.run(team.make_plan(photo(), Instruction("put it there"), PICK_PLACE))
    write_page(tmp_path)
    _, text = read(tmp_path / "page.html")
    assert f"Verification about T1 wrong point {HOLE} Manager the point was chosen anew" in text
    assert "found anew" in text
    assert f"Verification: reject the point - {HOLE}" in (tmp_path / "record.json").read_text(encoding="utf-8")
