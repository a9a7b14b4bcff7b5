"""Whether everything that words say has found its place in what they were read as.

A plan that passes over a picture, a colour, an angle or "and back" is worse than a refusal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wonderful_team.models.offline.description import Description
from wonderful_team.models.offline.language.commands import Command
from wonderful_team.models.offline.language.tokens import Token

_PLACES = ("IN", "INTO", "ON", "ONTO", "TO", "NEAR", "LEFT_OF", "RIGHT_OF", "ABOVE", "BELOW")


def passed_over(tokens: Sequence[Token], commands: Sequence[Command]) -> list[str]:
    """The words of a text that its commands say nothing of."""
    things = [item for command in commands for item in _all_things(command)]
    shown = {item.like for item in things} | {item.since for item in things}
    shown |= {name for command in commands for name in command.pictures}
    said: dict[str, set[str | None]] = {
        "SLOT": shown,
        "COLOUR": {*(colour for item in things for colour in item.colours)},
        "PATTERN": {item.pattern for item in things},
        "MATERIAL": {item.material for item in things},
        "LETTER": {item.name for item in things},
        "SUPER": {item.superlative for item in things},
    }
    lost = [token.text for token in tokens if token.kind in said and token.value not in said[token.kind]]
    lost += [token.text for token in tokens if token.kind == "ASPECT" and not _has_aspect(things, commands)]
    kinds = {command.kind for command in commands}
    hows = {command.to.how for command in commands if command.to is not None}
    for at, token in enumerate(tokens):
        after = tokens[at + 1].kind if at + 1 < len(tokens) else ""
        if (
            (token.kind == "ANGLE" and "rotate" not in kinds)
            or (token.kind == "BESIDE_IT" and not any(item.related for item in things))
            or (token.kind == "EXCEPT" and not any(item.excluded for item in things))
            or (token.kind == "ORIGIN" and after not in _PLACES and not hows & {"origin"} and "rotate" not in kinds)
        ):
            lost.append(token.text)
    return lost


def _has_aspect(things: Sequence[Description], commands: Sequence[Command]) -> bool:
    """Whether anything is told by its colour, texture or shape, or by sharing one."""
    if any(command.to is not None and command.to.aspect for command in commands):
        return True
    return any(
        item.like_only or item.colours or item.pattern or item.material or item.shape or item.dark is not None
        or any(related.relation.startswith("same_") for related in item.related)
        for item in things
    )  # fmt: skip


def _all_things(command: Command) -> Iterator[Description]:
    """Every description that a command holds."""
    ends = () if command.to is None else (command.to.what, command.to.other)
    for item in (command.thing, *ends, command.off, command.limit):
        if item is not None:
            yield from _inside(item)


def _inside(item: Description) -> Iterator[Description]:
    yield item
    for other in (*item.excluded, *(to for related in item.related for to in related.to)):
        yield from _inside(other)
    if item.placed is not None:
        yield from _inside(item.placed)
