"""Old records open for ever: one that each schema version's first release wrote, and that is never written again."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.desk import read_record
from wonderful_team.api.replay import replay
from wonderful_team.cli.app import run
from wonderful_team.core.text import picture_names, spoken
from wonderful_team.pages import write_page
from wonderful_team.record import read_plan

GOLDEN = Path(__file__).parent / "golden" / "records"


def _golden():
    return sorted(path.parent for path in GOLDEN.rglob("record.json"))


def test_there_is_a_golden_record_of_every_schema_version():
    from wonderful_team.record.record_schema import RECORD_SCHEMA_VERSION

    kept = {read_record(folder)["schema_version"] for folder in _golden()}
    assert kept == set(range(1, RECORD_SCHEMA_VERSION + 1))


@pytest.mark.parametrize("folder", _golden(), ids=lambda path: f"{path.parent.name}-{path.name}")
def test_a_golden_record_opens_shows_and_replays(folder, tmp_path, capsys):
    """Written once by the release that introduced the version, and never written again."""
    copy = tmp_path / folder.name
    shutil.copytree(folder, copy)
    page = write_page(copy).read_text(encoding="utf-8")
    record = read_record(copy)
    assert record["planner"]["plans"][-1]["id"] in page
    assert run(["show", str(copy)]) == 0
    said = record["planner"]["instruction"]
    assert spoken(said["text"], picture_names(said["text"], said["slots"])) in capsys.readouterr().out
    last = record["planner"]["plans"][-1]
    plan = read_plan(copy)
    assert (plan.short_id() if last["schema_version"] == 1 else plan.id) == last["id"]
    # A later release may ask in other words: what was answered still makes the same plan.
    found = replay(copy, tolerant=True)
    assert found.now == found.then
