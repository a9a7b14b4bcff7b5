"""A record grows line by line: a line costs the same however long the run is, and every moment can be read."""

from __future__ import annotations

import json
import shutil

import pytest

from tests.runtime.runtime_fake_run import TalkingPolicy, world_with_pictures
from wonderful_team.core.protocols import Event
from wonderful_team.errors import FileNotWrittenError
from wonderful_team.record import Recorder
from wonderful_team.record.growing import LINES_NAME
from wonderful_team.record.record_schema import read_record
from wonderful_team.redaction import keep_secret
from wonderful_team.runtime import rollout


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """The folder of a run that was never closed."""
    folder = tmp_path_factory.mktemp("killed")
    recorder = Recorder(folder)
    rollout(TalkingPolicy([recorder]), world_with_pictures(), replans=3, subscribers=[recorder], seed=3)
    return folder, recorder


def test_killed_after_any_byte_the_record_reads(killed, tmp_path):
    folder, _ = killed
    lines = (folder / LINES_NAME).read_bytes()
    shutil.copy(folder / "record.json", tmp_path)
    seen = []
    for end in [*range(0, len(lines), len(lines) // 60), len(lines)]:
        (tmp_path / LINES_NAME).write_bytes(lines[:end])
        record = read_record(tmp_path)
        seen.append(len(record["planner"]["requests"]) + len(record["planner"]["stages"]))
    assert seen == sorted(seen)
    assert seen[0] == 0 < seen[-1]
    assert record["state"] == "finished"


def test_the_lines_say_what_the_whole_file_says(killed):
    folder, recorder = killed
    grown = read_record(folder)
    recorder.close()
    assert not (folder / LINES_NAME).exists()
    assert read_record(folder) == grown


def test_an_event_costs_the_same_late_as_early(tmp_path):
    """Counted in bytes written, which no machine makes slower."""
    with Recorder(tmp_path) as recorder:
        sizes = [0]
        for number in range(400):
            recorder.on_event(Event("stage", "plan", f"line {number:03d}"))
            sizes.append((tmp_path / LINES_NAME).stat().st_size)
        start = (tmp_path / "record.json").stat().st_size
        grown = [after - before for before, after in zip(sizes, sizes[1:], strict=False)]
        assert max(grown[-50:]) <= max(grown[:50]) + 20
        assert (tmp_path / "record.json").stat().st_size == start
    assert len(read_record(tmp_path)["planner"]["stages"]) == 400


def test_half_a_line_that_was_written_again_is_read_once(killed, tmp_path):
    """A full disk cuts a line; when there is room again it is written whole, after its own half."""
    folder, _ = killed
    with Recorder(tmp_path) as recorder:
        recorder.on_event(Event("stage", "plan", "one"))
        with (tmp_path / LINES_NAME).open("a") as file:
            file.write('\n[3, ["planner", "sta')
        for text in ("two", "three"):
            recorder.on_event(Event("stage", "plan", text))
        with (tmp_path / LINES_NAME).open("a") as file:
            file.write((tmp_path / LINES_NAME).read_text().rpartition("\n")[2].join(["\n", ""]))
        assert [stage["text"] for stage in read_record(tmp_path)["planner"]["stages"]] == ["one", "two", "three"]


def test_lines_that_could_not_be_written_are_in_the_whole_record(tmp_path, monkeypatch):
    def full(path, text):
        raise FileNotWrittenError(path, OSError(28, "No space left on device"))

    recorder = Recorder(tmp_path)
    with monkeypatch.context() as patched:
        patched.setattr("wonderful_team.record.run_files.append_private", full)
        recorder.on_event(Event("stage", "plan", "not on disk yet"))
    recorder.close()
    assert recorder.unwritten == ()
    assert [stage["text"] for stage in read_record(tmp_path)["planner"]["stages"]] == ["not on disk yet"]


def test_a_key_that_is_used_first_after_it_was_told_is_not_in_the_record(tmp_path):
    with Recorder(tmp_path) as recorder:
        recorder.on_event(Event("stage", "plan", "words with plain-looking-words-of-late in them"))
        keep_secret("plain-looking-words-of-late")
    text = (tmp_path / "record.json").read_text(encoding="utf-8")
    assert "plain-looking-words-of-late" not in text
    assert "[redacted]" in text


def test_a_record_of_an_earlier_release_that_was_killed_reads_as_it_stands(killed, tmp_path):
    folder, _ = killed
    record = {**read_record(folder), "state": "running"}
    (tmp_path / "record.json").write_text(json.dumps(record), encoding="utf-8")
    assert read_record(tmp_path) == record


def test_the_whole_record_has_an_entry_a_line(killed):
    folder, recorder = killed
    recorder.close()
    text = (folder / "record.json").read_text(encoding="utf-8")
    assert json.loads(text) == read_record(folder)
    stages = [line for line in text.split("\n") if line.startswith('   {"name": ')]
    assert len(stages) == len(read_record(folder)["planner"]["stages"])
