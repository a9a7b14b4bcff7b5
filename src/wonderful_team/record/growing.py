"""A record while it grows: every change is made once, free of keys, and added to a file as a line that is never written again.

A run may be killed at any moment. Then `record.json` stands as it was at the start, and the lines of `record.jsonl` make a whole
record of it again: `[number, place, how, value]`, where `how` is "set" (the place gets the value) or "add" (the list there
gets one more). So what an event costs does not grow with what has happened before it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from wonderful_team.errors import reading
from wonderful_team.record.versions import versions
from wonderful_team.redaction import known_secrets, redact_all

LINES_NAME = "record.jsonl"
RECORD_SCHEMA_VERSION = 1


class GrowingRecord:
    """A record's JSON values and the lines that tell its changes.

    Attributes:
        held: The record. Its requests are an object by their keys; `laid_out` makes the list that files hold of them.
    """

    def __init__(self, start: Mapping[str, Any]) -> None:
        self._known = known_secrets()
        self.held: dict[str, Any] = _by_key(redact_all(start))
        self._count = 0
        self._lines: list[str] = []

    def set(self, value: Any, *place: str | int) -> None:
        """Put a value in its place."""
        self._change(place, "set", value)

    def add(self, value: Any, *place: str | int) -> None:
        """Add a value to the list at a place; it is begun where there is none."""
        self._change(place, "add", value)

    def _change(self, place: tuple[str | int, ...], how: str, value: Any) -> None:
        clean = redact_all(value)
        place = tuple(redact_all(list(place)))
        self._count += 1
        self._lines.append("\n" + json.dumps([self._count, place, how, clean], ensure_ascii=False))
        _apply(self.held, place, how, clean)

    def lines(self) -> str:
        """The lines since the last time. Each begins with a new line, so that half of one spoils no other."""
        told, self._lines = "".join(self._lines), []
        return told

    def laid_out(self) -> dict[str, Any]:
        """The record as a file holds it."""
        whole = _as_list(self.held)
        # A key that was first used after something had been told that holds it.
        return whole if known_secrets() is self._known else dict(redact_all(whole))


def grown(folder: Path, start: dict[str, Any]) -> dict[str, Any]:
    """The record that the lines of a folder make of what stood in it at the start; as it is where there are none.

    A line that was cut when the process was killed ends it.

    Raises:
        ConfigError: The lines cannot be read.
    """
    path = folder / LINES_NAME
    if not path.is_file():
        return start
    with reading(f"the record's lines {str(path)!r}"):
        text = path.read_text(encoding="utf-8", errors="replace")
    record, count = _by_key(start), 0
    for line in text.split("\n"):
        try:
            number, place, how, value = json.loads(line)
            if number <= count:
                # Written once more, after half of it could not be.
                continue
            if number != count + 1:
                break
            _apply(record, tuple(place), how, value)
        except (ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError):
            continue
        count = number
    return _as_list(record)


def _apply(record: Any, place: tuple[str | int, ...], how: str, value: Any) -> None:
    *way, last = place
    for step in way:
        record = record[step]
    if how == "set":
        record[last] = value
    elif isinstance(record, dict):
        record.setdefault(last, []).append(value)
    else:
        record[last].append(value)


def _by_key(record: Mapping[str, Any]) -> dict[str, Any]:
    planner = record["planner"]
    requests = {entry["key"]: entry for entry in planner["requests"]}
    return {**record, "planner": {**planner, "requests": requests}}


def _as_list(record: Mapping[str, Any]) -> dict[str, Any]:
    planner = record["planner"]
    requests = [planner["requests"][key] for key in sorted(planner["requests"])]
    rest = {name: value for name, value in planner.items() if name != "requests"}
    return {**record, "planner": {**rest, "requests": requests}}


def as_lines(record: Mapping[str, Any]) -> str:
    """A record as text to look at: an entry a line. Indented all the way down it takes ten times as long to write."""
    return _spread(record, lambda part: _spread(part, lambda items: _spread(items, _compact, "   "), "  "), " ")


def _spread(value: Any, inner: Callable[[Any], str], margin: str) -> str:
    """An object or a list with each of its parts on a line of its own; anything else on one line."""
    if not value or not isinstance(value, dict | list):
        return _compact(value)
    if isinstance(value, list):
        return "[\n" + ",\n".join(margin + _compact(item) for item in value) + f"\n{margin[:-1]}]"
    parts = (f"{margin}{_compact(key)}: {inner(item)}" for key, item in value.items())
    return "{\n" + ",\n".join(parts) + f"\n{margin[:-1]}}}"


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def empty_record(command: str | None, started: str) -> dict[str, Any]:
    """A record in which nothing has happened yet."""
    happened = ("observations", "stages", "plans", "decisions", "gates", "executions", "subgoals", "verdicts")
    return {
        "schema_version": RECORD_SCHEMA_VERSION,
        "state": "running",
        "command": command,
        "configuration": {},
        "versions": versions(),
        "outcome": None,
        "files": {},
        "planner": {
            "instruction": None,
            "outlines": [],
            **{key: [] for key in happened},
            "warnings": [],
            "requests": [],
        },
        "clock": {"started": started, "requests": {}, "stages": [], "gates": [], "executions": []},
    }


def time_of_day(ago_s: float = 0.0) -> str:
    """The time of day so many seconds ago, to the second."""
    return (datetime.now(UTC) - timedelta(seconds=ago_s)).isoformat(timespec="seconds")
