"""Every request of a run, in the order of sending."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from markupsafe import Markup

from wonderful_team.core.text import recorded_names, spoken
from wonderful_team.pages.pictures import Album, pictured


@dataclass(frozen=True, eq=False)
class Part:
    """Words or a picture, as shown to the model."""

    words: Markup | None = None
    picture: Markup | None = None
    caption: str = ""


@dataclass(frozen=True, eq=False)
class Asked:
    """One attempt at one request.

    Attributes:
        number: From 1, in order of sending.
        sent_s, answered_s: Since the start of the run; answered_s None when no answer came.
        pictures: Hashes of the pictures, as drawn.
        exact: The words to the letter, where the page shows the instruction's pictures in the place of their names.
    """

    number: int
    entry: dict[str, Any]
    parts: tuple[Part, ...]
    pictures: tuple[str, ...]
    sent_s: float
    answered_s: float | None
    exact: str = ""

    @property
    def anchor(self) -> str:
        return f"request-{self.number}"

    @property
    def attempt(self) -> int:
        """Which plan of the trial it served, from 0: the first part of its id where that is a number."""
        first = str(self.entry["id"]).partition("/")[0]
        return int(first) if first.isdecimal() else 0

    @property
    def answer(self) -> dict[str, Any] | None:
        return self.entry["answer"] or None

    @property
    def failure(self) -> str:
        """What came instead of an answer, in words."""
        return str((self.entry.get("failed") or {}).get("message", ""))

    @property
    def sent(self) -> bool:
        """Whether it went to a model; one that was refused before is no call."""
        return bool((self.entry.get("failed") or {}).get("sent", True))

    @property
    def seconds(self) -> float | None:
        return None if self.answered_s is None else self.answered_s - self.sent_s

    @property
    def label(self) -> str:
        """Contract and target, short enough for a bar."""
        targets = self.entry["targets"]
        return str(self.entry["contract"]) + (f" {targets[0]}" if len(targets) == 1 else "")

    @property
    def gist(self) -> str:
        """The answer in a few words, where one field says it."""
        parsed = (self.answer or {}).get("parsed")
        if not isinstance(parsed, dict):
            return "" if self.answer is None else str(parsed)[:80]
        for field in ("decision", "status", "kind"):
            if isinstance(parsed.get(field), str):
                return str(parsed[field])
        if isinstance(parsed.get("approved"), bool):
            return "approved" if parsed["approved"] else "a doubt"
        for field in ("steps", "targets", "subgoals", "points", "verdicts"):
            if isinstance(parsed.get(field), list):
                count = len(parsed[field])
                return f"{count} {field if count != 1 else field[:-1]}"
        return ""


def in_order(record: dict[str, Any], album: Album) -> tuple[Asked, ...]:
    """All requests, first sent first."""
    times = record["clock"]["requests"]
    names = recorded_names(record["planner"]["instruction"])

    def sent(entry: dict[str, Any]) -> float:
        return float(times.get(entry["key"], {}).get("sent_s", 0.0))

    asked = []
    for number, entry in enumerate(sorted(record["planner"]["requests"], key=sent), start=1):
        drawn = tuple(part["drawn"] for part in entry["parts"] if part.get("drawn"))
        answered = times.get(entry["key"], {}).get("answered_s")
        words = "\n\n".join(_sent_words(part) for part in entry["parts"])
        exact = words if spoken(words, names) != words else ""
        asked.append(
            Asked(number, entry, _parts(entry["parts"], record, album, names), drawn, sent(entry), answered, exact)
        )
    return tuple(asked)


def _sent_words(part: dict[str, Any]) -> str:
    return str(part["words"]) if "words" in part else f"[picture] {part['picture']}"


def _parts(
    parts: list[dict[str, Any]], record: dict[str, Any], album: Album, names: Mapping[str, str]
) -> tuple[Part, ...]:
    """Words that follow each other in one block: a page of a thousand requests should not hold ten times as many."""
    made: list[Part] = []
    seen: set[str] = set()

    def slot(key: str, name: str) -> Markup:
        # The picture where it is spoken of first: some questions name one in every second line.
        picture = Markup("") if name in seen else album.image(key, name, "inline")
        seen.add(name)
        return Markup("{}[{}]").format(picture, name)

    for in_words, together in groupby(parts, key=lambda part: "words" in part):
        if in_words:
            made.append(Part(pictured("\n\n".join(part["words"] for part in together), record, album, slot)))
        else:
            made += (_picture(part, album, names) for part in together)
    return tuple(made)


def _picture(part: dict[str, Any], album: Album, names: Mapping[str, str]) -> Part:
    width, height = part.get("sent_px") or part["size_px"]
    name, on_sheet = spoken(part["picture"], names), part.get("on_sheet")
    if on_sheet is None:
        caption = f"{name}, {width} × {height} px as sent"
    else:
        caption = f"{name}: number {on_sheet} on one sheet of {width} × {height} px"
    return Part(picture=album.image(part["drawn"], caption), caption=caption)
