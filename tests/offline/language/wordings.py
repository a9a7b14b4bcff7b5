"""Other words for the tabletop's tasks: how a file of them is read, and what readings are compared by."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

FIRST_SEED, MOST_SEEDS = 500, 60
WORDS = {
    "ANGLE": "angle",
    "DRAGGED": "dragged_texture",
    "BASE": "base_texture",
    "NUMBER": "number",
    "DIRECTION": "direction",
    "TEXTURE": "texture",
    "ADJ": "adjective",
    "QUALITY": "quality",
    "FIRST": "first_noun",
    "SECOND": "second_noun",
}
"""Words in capitals, and the scene's words that they stand for."""


@dataclass(frozen=True)
class Wording:
    """One way to put a task.

    Attributes:
        task: Name of the task, or the plain words that say the same.
        text: The words, with capitals and picture slots.
        presumes: Words of the scene that the text presumes.
    """

    task: str
    text: str
    presumes: tuple[tuple[str, str], ...] = ()

    @property
    def is_plain(self) -> bool:
        """Whether the heading is an instruction of its own and no task."""
        return " " in self.task

    def suits(self, words: Mapping[str, str]) -> bool:
        """Whether a scene has the words that are presumed."""
        return all(words[name] == filled(value, words) for name, value in self.presumes)


def filled(text: str, words: Mapping[str, str]) -> str:
    """The scene's own words in place of capitals."""
    for capitals, name in WORDS.items():
        if name in words:
            text = re.sub(rf"\b{capitals}\b", words[name], text)
    return text


def read_wordings(text: str) -> list[Wording]:
    """The wordings of a file."""
    out: list[Wording] = []
    task = ""
    for line in text.splitlines():
        if line.startswith("## "):
            task = line[3:].strip()
        elif line.strip() and not line.startswith("#"):
            head = re.match(r"\[([^\]]+)\]\s*", line)
            presumes = tuple(part.split("=", 1) for part in head.group(1).split(",")) if head else ()
            body = line[head.end() :] if head else line
            out.append(Wording(task, body.strip(), tuple((name.strip(), value.strip()) for name, value in presumes)))
    return out


def gist(understood: Any) -> list[tuple[Any, ...]]:
    """What commands say, without the words that they came from."""
    return [
        (
            command.kind,
            _what(command.thing),
            None
            if command.to is None
            else (
                _how(command.to.how),
                _what(command.to.what),
                _what(command.to.other),
                command.to.aspect,
                command.to.side,
            ),
            round(command.rotate_deg),
            command.pictures,
            _what(command.off),
            _what(command.limit),
        )
        for command in understood.commands
    ]


def _how(how: str) -> str:
    return "in" if how == "on" else how


def _what(description: Any) -> Any:
    if description is None:
        return None
    shown = description.like is not None and description.like_only is None
    noun = "thing" if shown or description.noun in ("thing", "object") else description.noun
    related = tuple((item.relation, tuple(_what(to) for to in item.to)) for item in description.related)
    number = (description.quantity, description.number) if description.quantity == "number" else (description.quantity,)
    return (
        noun, description.name, description.colours, description.dark, description.pattern, description.shape, description.material,
        description.superlative, description.ordinal, description.like, description.like_only, related,
        ("all",) if number == ("each",) else number, tuple(_what(item) for item in description.excluded),
    )  # fmt: skip
