"""What each rule of the grammar changes in the description of a thing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Literal, TypeAlias

from lark import Token, Tree

from wonderful_team.offline.description import Description, Related
from wonderful_team.offline.language.wording import worded

Change: TypeAlias = Callable[[Description], Description]

_RELATIONS = {"LEFT_OF": "left_of", "RIGHT_OF": "right_of", "ABOVE": "above", "BELOW": "below", "NEAR": "near",
              "BY": "near", "FAR": "far_from", "ON": "on", "IN": "inside"}  # fmt: skip
SAME = {"colour": "same_colour", "texture": "same_pattern", "shape": "same_shape"}
ONE = "one"
"""Name of a description whose noun is one that was said before: "the green one"."""
OTHERS = "others"
"""Name of what "the other block" leaves out: the things that were named before."""
PRONOUN = "it"
"""Name of a description that stands for something said before."""


def thing_of(tree: Tree[Token]) -> Description:
    """The description of an `np`."""
    if isinstance(tree.children[0], Token) and tree.children[0].type == "PLACE_OF":
        return _place_of(tree)
    description = Description(noun="object", text="")
    for child in tree.children:
        if isinstance(child, Tree):
            description = CHANGES[str(child.data)](child)(description)
    if _is_bare_one(tree, description):
        description = replace(description, noun="thing", name=PRONOUN)
    words = [token for adj in trees(tree, "adj") for token in tokens_in(adj)]
    some = {token.type for token in words} & {"OF_TWO", "OF", "ONE_OF"}
    many = any(_is_many(head) for head in trees(tree, "head"))
    both_of_a_list = description.number > 1 and not many
    if description.quantity == "all" and (both_of_a_list or some):
        description = replace(
            description, quantity="one", number=1 if both_of_a_list and not some else description.number
        )
    if description.quantity == "all" and not many and any(item.name == OTHERS for item in description.excluded):
        description = replace(description, quantity="one")
    if description.quantity == "one" and any(token.type == "SUPER" and _compares(token) for token in words):
        description = replace(description, number=max(description.number, 2))
    return worded(description)


def _compares(token: Token) -> bool:
    """Whether a word such as "bigger" or "biggest" speaks of one among several; "big" need not."""
    return str(token.value.text).endswith(("er", "est")) and value_of(token) not in ("middle", "nearest")


def _is_many(head: Tree[Token]) -> bool:
    """Whether a head is no noun in the singular: "both the red block and the green one" speaks of one each."""
    values = [value_of(token) for token in tokens_in(head) if token.type in ("NOUN", "SHAPE")]
    return not values or bool(values[-1][-1])


def _is_bare_one(tree: Tree[Token], description: Description) -> bool:
    """Whether the words are "this one" or "that one" alone."""
    heads = [token.type for head in trees(tree, "head") for token in tokens_in(head)]
    return heads == ["ONE"] and description == Description(noun="object", text="", name=ONE)


def _place_of(tree: Tree[Token]) -> Description:
    """The words "the place of the red star in {scene}": where that picture shows it."""
    thing = thing_of(next(trees(tree, "np")))
    like = next((str(value_of(tokens_in(slot)[-1])) for slot in trees(tree, "in_slot")), None)
    if like is None:
        like, thing = thing.like, replace(thing, like=None)
        thing = worded(thing)
    return worded(Description(noun="area", text="", placed=thing, like=like))


def related_of(tree: Tree[Token]) -> Related:
    """The relation of a `post`."""
    nouns = tuple(thing_of(child) for child in trees(tree, "np"))
    if any(token.type == "BETWEEN" for token in tokens_in(tree)):
        return Related("between", nouns)
    kind = tokens_in(next(trees(tree, "relation")))[0]
    return Related(_RELATIONS[kind.type], nouns)  # type: ignore[arg-type]


def _quantity(tree: Tree[Token]) -> Change:
    kinds = {token.type: token for token in tokens_in(tree)}
    if "ONE_OF" in kinds:
        # Any of several will do.
        return lambda d: replace(d, quantity="each" if "EACH" in kinds else "number", number=1)
    if "REST" in kinds:
        others = Description(noun="thing", name=OTHERS, text="")
        number = int(float(value_of(kinds["NUMBER"]))) if "NUMBER" in kinds else 1
        quantity: Literal["all", "number"] = "number" if "NUMBER" in kinds else "all"
        return lambda d: replace(d, quantity=quantity, number=number, excluded=(*d.excluded, others))
    if "NUMBER" in kinds:
        number = int(float(value_of(kinds["NUMBER"])))
        return lambda d: replace(d, quantity="number", number=number)
    if "EACH" in kinds:
        return lambda d: replace(d, quantity="each")
    counted = 2 if any(value_of(token) == 2 for token in kinds.values()) else 1  # noqa: PLR2004  "both"
    return lambda d: replace(d, quantity="all", number=counted)


def _head(tree: Tree[Token]) -> Change:
    def change(description: Description) -> Description:
        for token in tokens_in(tree):
            description = _head_word(description, token)
        return description

    return change


def _head_word(description: Description, token: Token) -> Description:
    value = value_of(token)
    match token.type:
        case "NOUN":
            noun, name, many = value
            free = description.name if description.name == "free" else ""
            description = replace(description, noun=noun, name=name or free)
        case "SHAPE":
            shape, many = value
            description = replace(description, shape=shape, noun="object")
        case "LETTER":
            return replace(description, noun="letter", name=value)
        case "ORANGE":
            many = bool(value)
            description = replace(description, noun="fruit", name="orange")
        case "SLOT":
            return replace(
                description, like=value, like_only="texture" if "texture" in value else description.like_only
            )
        case "EVERYTHING":
            return replace(description, noun="thing", quantity="all")
        case "IT" | "THEY":
            return replace(description, noun="thing", name=PRONOUN)
        case "FORMER" | "LATTER":
            return replace(description, noun="thing", name=token.type.lower())
        case "TABLE":
            return replace(description, noun="area", name="table")
        case "ONE":
            return replace(description, name=description.name or ONE)
        case _:
            return description
    return replace(description, quantity="all", plural=True) if many and description.quantity == "one" else description


def _adj(tree: Tree[Token]) -> Change:
    children = list(tree.children)

    def change(description: Description) -> Description:
        for child in children:
            if isinstance(child, Tree):
                description = CHANGES[str(child.data)](child)(description)
            else:
                description = _adjective(description, child)
        return description

    return change


_FIELDS = {"PATTERN": "pattern", "MATERIAL": "material", "SUPER": "superlative", "SIDE": "superlative",
           "SIDE_POST": "superlative", "FREE": "name"}  # fmt: skip
"""Words whose value is that of one field."""


def _adjective(description: Description, token: Token) -> Description:
    value = value_of(token)
    if token.type in _FIELDS:
        return replace(description, **{_FIELDS[token.type]: value})
    match token.type:
        case "LOOK":
            return replace(description, pattern=value[0], colours=(*description.colours, *value[1]))
        case "SHAPE":
            return replace(description, shape=value[0])
        case "ORDINAL":
            return replace(description, ordinal=value, superlative=description.superlative or "leftmost")
        case "OF_TWO" | "NUMBER":
            return replace(description, number=int(float(value)))
        case "SLOT":
            return replace(description, like=value, like_only="texture" if "texture" in value else None)
        case "SHAPED" | "ASPECT" if description.like:
            texture = token.type == "ASPECT" and value in ("texture", "colour")
            return replace(description, like_only="texture" if texture else "shape")
        case "NOUN":
            return replace(description, name=value[1] or description.name)
        case "LETTER":
            return replace(description, noun="letter", name=value)
        case "CORNER":
            return replace(description, superlative=value[0], name=" ".join(value))
        case _:
            return description


def _colour(tree: Tree[Token]) -> Change:
    colours: list[str] = []
    dark: bool | None = None
    for token in tokens_in(tree):
        if token.type == "DARK":
            dark = bool(value_of(token))
        elif token.type == "ORANGE":
            colours.append("orange")
        elif token.type == "COLOUR":
            colours.append(str(value_of(token)))
    return lambda d: replace(
        d, colours=tuple(dict.fromkeys((*d.colours, *colours))), dark=d.dark if dark is None else dark
    )


def _plain_post(tree: Tree[Token]) -> Change:
    kinds = [token.type for token in tree.children if isinstance(token, Token)]

    def change(description: Description) -> Description:
        if "EXCEPT" in kinds:
            return _except(tree, description)
        if set(kinds) & {"SAME", "ITS", "WHOSE"}:
            aspect = str(value_of(next(token for token in tokens_in(tree) if token.type == "ASPECT")))
            named = [thing_of(np) for np in trees(tree, "np")]
            reference = named[0] if named else Description(noun="thing", name=PRONOUN, text=PRONOUN)
            return replace(description, related=(*description.related, Related(SAME[aspect], (reference,))))  # type: ignore[arg-type]
        if "SUPER" in kinds and "TO" in kinds:
            reference = thing_of(next(trees(tree, "np")))
            return replace(description, related=(*description.related, Related("nearest", (reference,))))
        if "LIKE" in kinds and (nouns := list(trees(tree, "np"))):
            shown = thing_of(nouns[0])
            return replace(description, like=shown.like or description.like)
        if kinds[:1] == ["FROM"]:
            return replace(description, superlative=value_of(tree.children[-1]))
        for child in tree.children:
            description = _post_part(child, kinds, description)
        return description

    return change


def _post_part(child: Token | Tree[Token], kinds: list[str], description: Description) -> Description:
    """What one part of a phrase after the noun adds."""
    if isinstance(child, Tree):
        if child.data == "in_slot":
            return replace(description, like=value_of(tokens_in(child)[-1]))
        return CHANGES[str(child.data)](child)(description)
    if child.type == "ASPECT":
        only: Literal["shape", "texture"] = "shape" if value_of(child) == "shape" else "texture"
        return replace(description, like_only=only) if "SLOT" in kinds else description
    if child.type == "SLOT":
        return replace(description, like=value_of(child))
    if child.type == "NOUN":
        return replace(description, noun=value_of(child)[0], name=value_of(child)[1])
    return _adjective(description, child)


def _except(tree: Tree[Token], description: Description) -> Description:
    spared = tuple(thing_of(np) for np in trees(tree, "np"))
    return replace(description, excluded=(*description.excluded, *spared))


def _post(tree: Tree[Token]) -> Change:
    beside = next((token for token in tokens_in(tree) if token.type == "BESIDE_IT"), None)
    if beside is not None:
        named = list(trees(tree, "np"))
        it = (thing_of(named[0]) if named else Description(noun="thing", text="it", name=PRONOUN),)
        both = (Related(value_of(beside), it), Related("nearest", it))
        return lambda d: replace(d, related=(*d.related, *both))
    related = related_of(tree)
    if len(related.to) == 1 and related.to[0].like is not None and "scene" in related.to[0].like:
        # "in {scene}" says which picture shows it; the thing itself is looked for on the table.
        return lambda d: d
    return lambda d: replace(d, related=(*d.related, related))


CHANGES: dict[str, Callable[[Tree[Token]], Change]] = {
    "quantity": _quantity,
    "head": _head,
    "adj": _adj,
    "colour": _colour,
    "plain_post": _plain_post,
    "post": _post,
}


def value_of(token: Any) -> Any:
    return token.value.value


def trees(tree: Tree[Token], rule: str) -> Iterator[Tree[Token]]:
    """Children under that rule, looking through the rules that only group."""
    for child in tree.children:
        if isinstance(child, Tree) and child.data == rule:
            yield child


def tokens_in(tree: Tree[Token]) -> list[Token]:
    return list(tree.scan_values(lambda item: isinstance(item, Token)))
