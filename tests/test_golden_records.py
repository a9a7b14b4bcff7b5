"""Records and stores of earlier releases open for ever: those releases wrote them, and they are never written again."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

import wonderful_team as wt
from tests.desk import read_record
from wonderful_team.api.replay import replay
from wonderful_team.cli.app import run
from wonderful_team.core.text import picture_names, spoken
from wonderful_team.pages import write_page
from wonderful_team.record import read_plan

GOLDEN = Path(__file__).parent / "golden" / "records"
STORES = sorted((Path(__file__).parent / "golden" / "stores").glob("*.sql"))


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
    assert run(["show", str(copy), "--replay", "--tolerant"]) == 0

    stored = wt.load_run(copy)
    assert (stored.outcome, stored.plans[-1].id) == (record["outcome"]["outcome"], plan.id)
    assert len(stored.observations) == len(record["planner"]["observations"])
    assert stored.instruction.text == said["text"]


def test_golden_records_stand_in_the_table_of_runs(tmp_path, capsys):
    for folder in _golden():
        shutil.copytree(folder, tmp_path / folder.name)
    assert run(["list", "runs", "--out", str(tmp_path), "--html", str(tmp_path / "table.html")]) == 0
    table = (tmp_path / "table.html").read_text(encoding="utf-8")
    assert table.count('<img src="data:image/') == len(_golden())
    told = capsys.readouterr().out
    for folder in _golden():
        outcome = read_record(folder)["outcome"]["outcome"]
        assert any(line.split()[:2] == [folder.name, outcome] for line in told.splitlines()), told


@pytest.mark.parametrize("dump", STORES, ids=lambda path: path.stem)
def test_a_store_of_an_earlier_release_is_reported_and_goes_on(dump, tmp_path, capsys):
    file = tmp_path / "study.db"
    with closing(sqlite3.connect(file)) as base:
        base.executescript(dump.read_text(encoding="utf-8"))
        base.commit()
        before = dict(base.execute("SELECT key, reason || seconds FROM trials WHERE state = 'done'").fetchall())
    assert run(["report", str(file)]) == 0
    assert "| tabletop/rotate | 100 % (n = 2; 34 to 100)" in capsys.readouterr().out
    assert run(["bench", "tabletop/rotate", "--seeds", "0:3", "--store", str(file), "--jobs", "1"]) == 0
    assert "12/12" in capsys.readouterr().err
    with closing(sqlite3.connect(file)) as base:
        after = dict(base.execute("SELECT key, reason || seconds FROM trials WHERE state = 'done'").fetchall())
    assert len(after) == 12
    assert before.items() <= after.items(), "what had ended was run again"


def test_there_is_a_store_of_the_schema_of_today():
    from wonderful_team.evals.schema import SCHEMA_VERSION

    assert f"v{SCHEMA_VERSION}" in {path.stem for path in STORES}
