"""Simple wishes read by what they hold, whatever the order of their words.

Each gist has its own closed list of kinds of words: a clause with any other word is not read here. What the clause holds
must settle alone what is meant: one thing and one angle, one thing and one container, one container and what it shares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.models.offline.description import Description, Related
from wonderful_team.models.offline.language.commands import Command, Destination
from wonderful_team.models.offline.language.tokens import Token
from wonderful_team.models.offline.language.wording import render

_SAID = frozenset(
    "AUX GIVE WANT OF IT WITH FOR AS AND COMMA SEP ON_TABLE TABLE AROUND THAT THEY TAKE LIKE LOOK FROM THERE".split()
)
_TURN = _SAID | frozenset(
    "ROTATE TURN ANGLE SLOT NOUN BY TO MEASURE SIDE_POST FACE ITS IN ENOUGH ONE SHARE NEAR PUT".split()
)
_PUT = (_SAID - {"FROM"}) | frozenset(
    "PUT PUSH IN INTO TO ON ONTO CONTAIN FILL SLOT NOUN ONE_OF NUMBER ALL EACH SHARE ONE FREE WHERE THEN EVERYTHING RETURN".split()
)
_GATHER = _SAID | frozenset(
    "PUT SORT IN INTO TO ON ONTO CONTAIN FILL SLOT NOUN ALL EACH EVERYTHING SHARE SAME MATCH ASPECT SHAPED WHOSE ITS BY WHERE THEN".split()
)
_INTO = ("IN", "INTO", "TO", "ON", "ONTO", "CONTAIN", "FILL")
_SAME = {"texture": "same_pattern", "colour": "same_colour", "shape": "same_shape"}
_TWO = 2


def gist_of_gathering(tokens: Sequence[Token]) -> Command | None:
    """The words "all that has the texture of {x} goes into it": one picture, many things, one aspect; None for others."""
    kinds = {token.kind for token in tokens}
    names = {str(token.value) for token in tokens if token.kind == "SLOT"}
    aspects = {str(token.value) for token in tokens if token.kind == "ASPECT"} | (
        {"shape"} if "SHAPED" in kinds else set()
    )
    aspects = aspects or {"shape" for k, token in enumerate(tokens) if k and _is_aspect(token, tokens[k - 1])}
    many = bool(kinds & {"ALL", "EACH", "EVERYTHING"}) or any(map(_plural, tokens))
    going = bool(kinds & {"PUT", "IN", "INTO", "ON", "ONTO", "TO", "CONTAIN", "FILL", "SORT"}) or any(
        map(_receives, tokens)
    )
    if len(names) != 1 or len(aspects) != 1 or not many or not going:
        return None
    if not kinds & {"SAME", "MATCH", "SHARE", "ITS", "LIKE", "SHAPED", "WITH", "OF", "AS", "WHOSE"}:
        return None
    nouns = {token.value[:2] for token in tokens if token.kind == "NOUN" and isinstance(token.value, tuple)}
    if not kinds <= _GATHER or not nouns <= {("object", ""), ("container", ""), ("thing", "")}:
        return None
    if _meant_elsewhere(tokens):
        return None
    holder = _shown(names.pop())
    related = Related(_SAME[aspects.pop()], (holder,))  # type: ignore[arg-type]
    things = Description("object", "", quantity="all", related=(related,))
    return Command("put", _worded(things), Destination("in", holder))


def _plural(token: Token) -> bool:
    return isinstance(token.value, tuple) and token.kind == "NOUN" and bool(token.value[2])


def _receives(token: Token) -> bool:
    return token.kind == "CONTAIN" or token.text in ("receive", "receives")


def _is_aspect(token: Token, before: Token) -> bool:
    """Whether "shape" is what is shared, not another word for an object."""
    return token.text in ("shape", "shapes") and before.kind in (
        "SAME",
        "MATCH",
        "SHARE",
        "OF",
        "WITH",
        "ITS",
        "WHOSE",
        "SLOT",
    )


def _meant_elsewhere(tokens: Sequence[Token]) -> bool:
    """Whether what goes somewhere goes to a place of another kind ("on the table")."""
    return any(token.kind in ("ON_TABLE", "TABLE") for token in tokens)


def gist_of_turning(tokens: Sequence[Token]) -> Command | None:
    """One pictured thing and one angle: the thing is turned by it; None for others."""
    kinds = {token.kind for token in tokens}
    names = {str(token.value) for token in tokens if token.kind == "SLOT"}
    angles = {float(token.value) for token in tokens if token.kind == "ANGLE"}  # type: ignore[arg-type]
    ways = {float(token.value) for token in tokens if token.kind == "TURN"}  # type: ignore[arg-type]
    sides = {str(token.value) for token in tokens if token.kind == "SIDE_POST"}
    ways |= {-1.0 if side == "leftmost" else 1.0 for side in sides}
    if (
        len(names) != 1
        or len(angles) != 1
        or len(ways) > 1
        or not kinds <= _TURN
        or not sides <= {"leftmost", "rightmost"}
    ):
        return None
    if not kinds & {"ROTATE", "TURN", "FACE", "MEASURE"} or any(map(_plural, tokens)):
        return None
    return Command("rotate", _shown(names.pop()), rotate_deg=angles.pop() * (ways.pop() if ways else 1.0))


def gist_of_putting(tokens: Sequence[Token]) -> Command | None:
    """Two pictured things, one of them after a word for going into: the other goes into it; None for others."""
    kinds = {token.kind for token in tokens}
    if not kinds <= _PUT or not kinds & {"PUT", "PUSH", "AUX", "GIVE", "WANT", "CONTAIN", "FILL", "SHARE", "LEAVE"}:
        return None
    if {str(token.text) for token in tokens if token.kind == "SEP"} - {".", ":", ";", "?", "!"}:
        return None
    named = list(dict.fromkeys(str(token.value) for token in tokens if token.kind == "SLOT"))
    if len(named) != _TWO:
        return None
    if "AS" in kinds:
        # "use {x} as the container"
        held = {
            str(tokens[k].value)
            for k in range(len(tokens) - 1)
            if tokens[k].kind == "SLOT" and _after(tokens, k) == "AS"
        }
        named = [name for name in named if name not in held] + list(held)
    else:
        held = set()
    held |= {
        str(tokens[k].value)
        for k in range(1, len(tokens))
        if tokens[k].kind == "SLOT" and _before(tokens, k) in ("IN", "INTO", "TO", "ON", "ONTO")
    }
    holders = {
        str(tokens[k].value) for k in range(len(tokens)) if tokens[k].kind == "SLOT" and _after(tokens, k) == "receives"
    } | (
        {
            str(tokens[k].value)
            for k in range(1, len(tokens))
            if tokens[k].kind == "SLOT" and _before(tokens, k) == "FILL"
        }
    )
    places = held if not holders else holders
    if len(places) != 1:
        return None
    place = next(iter(places))
    thing = next(name for name in named if name != place)
    what = _counted(tokens, thing)
    kind = "push" if "PUSH" in kinds else "put"
    return Command(kind, what, Destination("in", _shown(place)))  # type: ignore[arg-type]  # fmt: skip


def _before(tokens: Sequence[Token], at: int) -> str:
    """The kind of the word before a picture, nouns that name it passed over."""
    at -= 1
    while at > 0 and tokens[at].kind in ("NOUN", "LIKE", "THAT"):
        at -= 1
    return tokens[at].kind if at >= 0 else ""


def _after(tokens: Sequence[Token], at: int) -> str:
    """The kind of the word after a picture, helping verbs passed over."""
    at += 1
    while at < len(tokens) - 1 and tokens[at].kind == "AUX":
        at += 1
    if at < len(tokens) and _receives(tokens[at]):
        return "receives"
    return tokens[at].kind if at < len(tokens) else ""


def _counted(tokens: Sequence[Token], name: str) -> Description:
    """How many of what a picture shows."""
    description = _shown(name)
    for k, token in enumerate(tokens):
        if token.kind == "SLOT" and token.value == name:
            for before in tokens[max(0, k - 4) : k][::-1]:
                if before.kind in ("ALL", "EACH"):
                    return _worded(Description("object", "", like=name, quantity="all"))
                if before.kind in ("NUMBER", "ONE_OF"):
                    number = int(float(before.value)) if before.kind == "NUMBER" else 1  # type: ignore[arg-type]
                    return _worded(Description("object", "", like=name, quantity="number", number=number))
                if before.kind not in ("OF", "NOUN", "THAT", "ONE", "LIKE"):
                    break
    return description


def _shown(name: str) -> Description:
    return _worded(Description("object", "", like=name))


def _worded(description: Description) -> Description:
    return replace(description, text=render(description))


def whole_gist(tokens: Sequence[Token]) -> tuple[Command, ...]:
    """The command of a text that is one simple wish; () for any other."""
    for reader in (gist_of_turning, gist_of_putting):
        command = reader(tokens)
        if command is not None:
            return (command,)
    return ()
