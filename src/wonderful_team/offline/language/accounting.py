"""Whether everything that words say has found its place in what they were read as.

A plan that passes over a picture, a colour, an angle or "and back" is worse than a refusal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from wonderful_team.offline.description import Description
from wonderful_team.offline.language.commands import Command
from wonderful_team.offline.language.tokens import Token

_PLACES = ("IN", "INTO", "ON", "ONTO", "TO", "NEAR", "LEFT_OF", "RIGHT_OF", "ABOVE", "BELOW")


_SIDES = ("left", "right")
"""Words for a side that are said of no place ("on its right"); before a place they say nothing ("right into the bowl")."""
_END = Token("SEP", ".", ".")


def passed_over(tokens: Sequence[Token], commands: Sequence[Command]) -> list[str]:
    """The words of a text that its commands say nothing of."""
    things = [item for command in commands for item in _all_things(command)]
    shown = {item.like for item in things} | {item.since for item in things}
    shown |= {name for command in commands for name in command.pictures}
    places = {command.to.how for command in commands if command.to is not None}
    relations = {related.relation for item in things for related in item.related}
    sides = {word for item in things for word in (item.superlative, *item.name.split())}
    sides |= {word for command in commands if command.to is not None for word in command.to.side.split()}
    turned = any(command.kind == "rotate" for command in commands)
    said: dict[str, set[Any]] = {
        "SLOT": shown,
        "COLOUR": {*(colour for item in things for colour in item.colours)},
        "PATTERN": {item.pattern for item in things},
        "MATERIAL": {item.material for item in things},
        "LETTER": {item.name for item in things},
        "SUPER": {item.superlative for item in things} | relations,
        "DARK": {item.dark for item in things},
    }
    for relation in ("left_of", "right_of", "above", "below", "between"):
        if relation.removesuffix("_of") not in places and relation not in relations:
            said[relation.upper()] = set()
    lost = [token.text for token in tokens if token.kind in said and token.value not in said[token.kind]]
    lost += [token.text for token in tokens if token.kind in ("NOUN", "SHAPE") and not _is_meant(token, things)]
    lost += [token.text for token in tokens if token.kind == "ASPECT" and not _has_aspect(things, commands)]
    lost += [token.text for token, after in pairwise([*tokens, _END]) if token.text in _SIDES and not (
        token.value in sides or turned or relations or after.kind in _PLACES)]  # fmt: skip
    kinds = {command.kind for command in commands}
    for at, token in enumerate(tokens):
        after = tokens[at + 1].kind if at + 1 < len(tokens) else ""
        if (
            (token.kind == "ANGLE" and not kinds & {"rotate", "open"})
            or (token.kind == "TIMES" and "shake" not in kinds)
            or (token.kind == "BESIDE_IT" and not any(item.related for item in things))
            or (token.kind == "EXCEPT" and not any(item.excluded and item.quantity != "one" for item in things))
            or (
                token.kind == "ORIGIN"
                and after not in _PLACES
                and "origin" not in places
                and not kinds & {"rotate", "shake"}
            )
        ):
            lost.append(token.text)
    return lost


def _is_meant(token: Token, things: Sequence[Description]) -> bool:
    """Whether a noun or a shape that says what a thing is belongs to one of the things."""
    value = token.value
    assert isinstance(value, tuple)  # of every noun and shape
    if token.kind == "SHAPE":
        return any(item.shape == value[0] for item in things)
    kind, name = value[0], value[1]
    if name:
        return any(item.name == name for item in things)
    return kind not in ("block", "letter", "ball", "bottle") or any(item.noun == kind for item in things)


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
    for item in (command.thing, *ends, command.off, command.limit, command.tool):
        if item is not None:
            yield from _inside(item)


def _inside(item: Description) -> Iterator[Description]:
    yield item
    for other in (*item.excluded, *(to for related in item.related for to in related.to)):
        yield from _inside(other)
    if item.placed is not None:
        yield from _inside(item.placed)
