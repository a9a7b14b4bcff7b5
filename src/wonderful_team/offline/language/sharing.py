"""What shares a colour, texture or shape with what: with the thing that is moved, or with another one that is named."""

from __future__ import annotations

from dataclasses import replace

from wonderful_team.offline.description import Description
from wonderful_team.offline.language.changes import PRONOUN
from wonderful_team.offline.language.commands import Destination
from wonderful_team.offline.language.wording import render

_SAME = {"colour": "same_colour", "texture": "same_pattern", "shape": "same_shape"}
_ASPECT = {relation: aspect for aspect, relation in _SAME.items()}


def _may_mean(thing: Description, noun: str, name: str) -> bool:
    """Whether a noun may stand for the thing moved."""
    if name == PRONOUN or (noun in ("object", "thing") and not name):
        return True
    return thing.noun == noun and (not name or thing.name == name)


def own_match(goal: Destination, thing: Description) -> Destination:
    """The same goal; "the bowl of the same colour as that block", said of each block, is the one that matches it."""
    what = goal.what
    if what is None or goal.how not in ("in", "on") or thing.quantity not in ("each", "all"):
        return goal
    for related in what.related:
        to = related.to[0]
        plain = to == replace(Description(noun=to.noun, text=to.text, name=to.name), quantity=to.quantity)
        if related.relation in _ASPECT and plain and not to.like and _may_mean(thing, to.noun, to.name):
            kind = replace(what, related=tuple(item for item in what.related if item is not related))
            kind = replace(kind, text=render(kind))
            return Destination("matching", kind, aspect=_ASPECT[related.relation])  # type: ignore[arg-type]
    return goal
