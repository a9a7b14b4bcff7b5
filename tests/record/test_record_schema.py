"""The published schema is the one that records are checked against, and damage is named by its place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from wonderful_team.errors import ConfigError
from wonderful_team.record.record_schema import SCHEMA_FILE, read_record, record_schema

GOLDEN = Path(__file__).parents[1] / "golden" / "records" / "v1" / "trial"


def test_the_schema_file_is_what_the_code_says():
    """Written with: python -m wonderful_team.record.record_schema."""
    assert json.loads(SCHEMA_FILE.read_text(encoding="utf-8")) == record_schema()


def broken(tmp_path, change):
    record = json.loads((GOLDEN / "record.json").read_text(encoding="utf-8"))
    change(record)
    (tmp_path / "record.json").write_text(json.dumps(record), encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda record: record.pop("planner"), "broken record: planner: Field required"),
        (lambda record: record["planner"]["stages"].append(3), r"planner\.stages\.\d+: "),
        (lambda record: record["planner"]["requests"][0].update(parts="x"), r"planner\.requests\.0\.parts: "),
        (lambda record: record["files"].update(x="../../etc/passwd"), "leads out of the run folder"),
        (lambda record: record["files"].update(x="/etc/passwd"), "leads out of the run folder"),
        (lambda record: record["planner"]["decisions"][0]["so_far"].update(observations=0), "so_far.observations"),
    ],
)
def test_a_broken_record_names_the_place(tmp_path, change, says):
    with pytest.raises(ConfigError, match=says):
        read_record(broken(tmp_path, change))


@pytest.mark.parametrize("text", ["[" * 100_000, "[1]", "null", "\x00", '{"schema_version": 1}'])
def test_what_is_no_record_is_refused(tmp_path, text):
    (tmp_path / "record.json").write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError):
        read_record(tmp_path)
