"""The wish "everything with the texture of {x} goes into it", read by what it holds, whatever the order of its words.

A clause with any word outside a closed list of kinds is not read here.
"""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.offline.description import Description, Related
from wonderful_team.offline.language.changes import SAME
from wonderful_team.offline.language.commands import Command, Destination
from wonderful_team.offline.language.tokens import Token
from wonderful_team.offline.language.wording import worded

_SAID = frozenset(
    "AUX GIVE WANT OF IT WITH FOR AS AND COMMA SEP ON_TABLE TABLE AROUND THAT THEY TAKE LIKE LOOK FROM THERE".split()
)
_GATHER = _SAID | frozenset(
    "PUT SORT IN INTO TO ON ONTO CONTAIN FILL SLOT NOUN ALL EACH EVERYTHING SHARE SAME MATCH ASPECT SHAPED WHOSE ITS BY WHERE THEN".split()
)
_SHARED = frozenset("SAME MATCH SHARE OF WITH ITS WHOSE SLOT".split())


def gathering_template(tokens: Sequence[Token]) -> Command | None:
    """The words "all that has the texture of {x} goes into it": one picture, many things, one aspect; None for others."""
    kinds = {token.kind for token in tokens}
    names = {str(token.value) for token in tokens if token.kind == "SLOT"}
    aspects = {str(token.value) for token in tokens if token.kind == "ASPECT"} | (
        {"shape"} if "SHAPED" in kinds else set()
    )
    aspects = aspects or {"shape" for k, token in enumerate(tokens) if k and _is_aspect(token, tokens[k - 1])}
    many = bool(kinds & {"ALL", "EACH", "EVERYTHING"}) or any(
        isinstance(token.value, tuple) and token.kind == "NOUN" and token.value[2] for token in tokens
    )
    going = bool(kinds & {"PUT", "IN", "INTO", "ON", "ONTO", "TO", "CONTAIN", "FILL", "SORT"})
    if len(names) != 1 or len(aspects) != 1 or not many or not going:
        return None
    if not kinds & {"SAME", "MATCH", "SHARE", "ITS", "LIKE", "SHAPED", "WITH", "OF", "AS", "WHOSE"}:
        return None
    nouns = {token.value[:2] for token in tokens if token.kind == "NOUN" and isinstance(token.value, tuple)}
    if not kinds <= _GATHER or not nouns <= {("object", ""), ("container", ""), ("thing", "")}:
        return None
    if kinds & {"ON_TABLE", "TABLE"}:
        return None  # what goes somewhere goes to the table
    holder = worded(Description("object", "", like=names.pop()))
    related = Related(SAME[aspects.pop()], (holder,))  # type: ignore[arg-type]
    things = Description("object", "", quantity="all", related=(related,))
    return Command("put", worded(things), Destination("in", holder))


def _is_aspect(token: Token, before: Token) -> bool:
    """Whether "shape" is what is shared, not another word for an object."""
    return token.text in ("shape", "shapes") and before.kind in _SHARED
