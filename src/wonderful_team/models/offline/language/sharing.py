"""What shares a colour, texture or shape with what: with the thing that is moved, or with another one that is named."""

from __future__ import annotations

from dataclasses import replace

from lark import Token, Tree

from wonderful_team.models.offline.description import Description, Related
from wonderful_team.models.offline.language.changes import CHANGES, tokens_in, value_of
from wonderful_team.models.offline.language.commands import Destination
from wonderful_team.models.offline.language.wording import render

_SAME = {"colour": "same_colour", "texture": "same_pattern", "shape": "same_shape"}
_ASPECT = {relation: aspect for aspect, relation in _SAME.items()}


def sharing(tree: Tree[Token], thing: Description) -> Destination:
    """The goal of a `matched`: a kind of thing, and what it shares with the thing moved, or with the one named."""
    description = Description(noun="area", text="")
    aspect = "colour"
    for child in tree.children:
        if isinstance(child, Token):
            if child.type == "NOUN":
                noun, name, _ = value_of(child)
                description = replace(description, noun=noun, name=name)
            elif child.type == "SHAPE":
                description = replace(description, noun="object", shape=value_of(child)[0])
            elif child.type == "ASPECT":
                aspect = str(value_of(child))
        elif child.data == "adj":
            description = CHANGES["adj"](child)(description)
        elif child.data == "match_post":
            aspect = next((str(value_of(token)) for token in tokens_in(child) if token.type == "ASPECT"), aspect)
    other = _other_named(tree, thing)
    if other is not None:
        related = Related(_SAME[aspect], (other,))  # type: ignore[arg-type]
        description = replace(description, related=(*description.related, related))
        return Destination("in", replace(description, text=render(description)))
    return Destination("matching", replace(description, text=render(description)), aspect=aspect)  # type: ignore[arg-type]


def _other_named(tree: Tree[Token], thing: Description) -> Description | None:
    """What "as the star" names, unless that is the thing moved itself ("as the fruit")."""
    for back in tree.find_data("back"):
        for token in tokens_in(back):
            if token.type == "SHAPE" and thing.shape != value_of(token)[0]:
                named = Description(noun="object", text="", shape=value_of(token)[0])
                return replace(named, text=render(named))
            if token.type == "NOUN":
                noun, name, _ = value_of(token)
                if not _may_mean(thing, noun, name):
                    named = Description(noun=noun, text="", name=name)
                    return replace(named, text=render(named))
    return None


def _may_mean(thing: Description, noun: str, name: str) -> bool:
    """Whether a noun may stand for the thing moved."""
    if noun in ("object", "thing") and not name:
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
