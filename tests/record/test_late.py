"""A record that is kept only where the run does not succeed: then it is the record that would have been written at once."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.runtime.runtime_fake_run import TalkingPolicy, world_with_pictures
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import LaterView, Observation, Trial
from wonderful_team.errors import FileNotWrittenError
from wonderful_team.record import Recorder, late
from wonderful_team.record.late import LateRecorder, Waiting
from wonderful_team.record.record_schema import read_record
from wonderful_team.runtime import rollout

ROOM = 10**9


class Events(list[Event]):
    """Everything that happened in a run."""

    def on_event(self, event: Event) -> None:
        self.append(event)


@pytest.fixture(scope="module")
def happened() -> Events:
    events = Events()
    rollout(TalkingPolicy([events]), world_with_pictures(), replans=3, subscribers=[events], seed=3)
    assert events[-1].kind == "done"
    return events


def ended(events: Events, outcome: Any) -> list[Event]:
    """The same run with another outcome."""
    assert isinstance(events[-1].content, Trial)
    return [*events[:-1], replace(events[-1], name=outcome, content=replace(events[-1].content, outcome=outcome))]


def kept_late(folder: Path, events: list[Event], waiting: Waiting) -> LateRecorder:
    recorder = LateRecorder(lambda clock: Recorder(folder, clock=clock), waiting)
    for event in events:
        recorder.on_event(event)
    return recorder


def without_times(folder: Path) -> dict[str, Any]:
    record = read_record(folder)
    del record["clock"]
    return record


def files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in ("record.json", "log.txt")
    }


@pytest.mark.parametrize("room", [0, 300_000, ROOM])
@pytest.mark.parametrize("outcome", ["failure", "error", "unscored"])
def test_a_run_that_did_not_succeed_is_written_as_if_at_once(
    happened: Events, outcome: str, room: int, tmp_path: Path
) -> None:
    events = ended(happened, outcome)
    with Recorder(tmp_path / "once") as once:
        for event in events:
            once.on_event(event)
    waiting = Waiting(room)
    recorder = kept_late(tmp_path / "late", events, waiting)
    assert (tmp_path / "late").exists() == (room < ROOM)
    recorder.close()
    assert recorder.folder == tmp_path / "late"
    assert recorder.ended
    assert recorder.warnings == once.warnings
    assert recorder.unwritten == ()
    assert without_times(tmp_path / "late") == without_times(tmp_path / "once")
    assert files(tmp_path / "late") == files(tmp_path / "once")
    assert waiting.bytes == 0


def test_of_a_run_that_succeeded_nothing_is_written_or_held(happened: Events, tmp_path: Path) -> None:
    waiting = Waiting(ROOM)
    recorder = kept_late(tmp_path / "late", ended(happened, "success"), waiting)
    assert waiting.bytes > 0
    recorder.close()
    assert waiting.bytes == 0
    assert recorder.folder is None
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_was_cut_short_is_kept(happened: Events, tmp_path: Path) -> None:
    recorder = kept_late(tmp_path / "late", happened[:-1], Waiting(ROOM))
    assert not recorder.ended
    recorder.close()
    assert read_record(tmp_path / "late")["state"] == "interrupted"


def test_times_are_those_of_what_happened_not_of_writing(
    happened: Events, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [1000.0]

    def at(step_s: float) -> Callable[[], float]:
        def clock() -> float:
            now[0] += step_s
            return now[0]

        return clock

    monkeypatch.setattr(late.time, "monotonic", at(1.0))
    recorder = kept_late(tmp_path / "late", ended(happened, "failure"), Waiting(ROOM))
    now[0] += 5000.0
    recorder.close()
    clock = json.loads((tmp_path / "late" / "record.json").read_text(encoding="utf-8"))["clock"]
    assert 10 < clock["seconds"] < 1000
    for request in clock["requests"].values():
        assert 0 < request["sent_s"] < request["answered_s"] < clock["seconds"]


def test_the_same_picture_waits_once_however_often_it_is_told(happened: Events, tmp_path: Path) -> None:
    once, often = Waiting(ROOM), Waiting(ROOM)
    kept_late(tmp_path / "a", list(happened), once)
    kept_late(tmp_path / "b", [*happened, *happened], often)
    assert once.bytes == often.bytes > 0


def test_runs_of_a_process_share_the_room_and_those_without_are_written_as_they_go(
    happened: Events, tmp_path: Path
) -> None:
    measured = Waiting(ROOM)
    kept_late(tmp_path / "measured", list(happened), measured)
    waiting = Waiting(round(1.5 * measured.bytes))
    first, second = (kept_late(tmp_path / name, ended(happened, "success"), waiting) for name in ("first", "second"))
    assert waiting.bytes <= 1.5 * measured.bytes
    assert not (tmp_path / "first").exists()
    assert (tmp_path / "second" / "record.jsonl").is_file()
    first.close()
    second.close()
    assert waiting.bytes == 0


def test_without_room_on_the_disk_the_run_goes_on_and_says_so(happened: Events, tmp_path: Path) -> None:
    def full(clock: Callable[[], float]) -> Recorder:
        raise FileNotWrittenError(tmp_path / "late", "no space left on device")

    for waiting in (Waiting(0), Waiting(ROOM)):
        recorder = LateRecorder(full, waiting)
        for event in ended(happened, "failure"):
            recorder.on_event(event)
        recorder.close()
        assert recorder.folder is None
        assert "no space left" in " ".join(recorder.unwritten)
        assert waiting.bytes == 0


def test_what_is_still_to_be_drawn_takes_its_room_and_is_not_drawn_for_that(tmp_path: Path) -> None:
    drawn: list[str] = []

    def draw() -> tuple[Any, None]:
        drawn.append("top")
        return np.zeros((40, 60, 3), np.uint8), None

    view = LaterView("top", "top", 0.0, (60, 40), draw)
    waiting = Waiting(ROOM)
    recorder = kept_late(tmp_path / "late", [Event("observe", "before", Observation({"top": view}))], waiting)
    assert waiting.bytes >= 60 * 40 * 3
    assert not drawn
    recorder._forget()
    assert waiting.bytes == 0
