"""Reading a clause by its parts, whatever their order.

A clause is cut into noun phrases, places, angles and verbs; what each part is follows from the words beside it. Every word
must find its part, and the parts must make a whole: else the clause is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.offline.description import Description
from wonderful_team.offline.language.clause_meaning import (
    read_back,
    read_contain,
    read_put,
    read_swap,
    read_tower,
    read_turn,
)
from wonderful_team.offline.language.clause_parts import PLACES, STARTS, VERBS, Unclear, parts_of
from wonderful_team.offline.language.commands import Command, Destination
from wonderful_team.offline.language.handling import read_handled
from wonderful_team.offline.language.meaning import Meaning
from wonderful_team.offline.language.templates import gathering_template
from wonderful_team.offline.language.tokens import Token
from wonderful_team.offline.language.wording import worded

_INTO = ("IN", "INTO", "ON", "ONTO", "TO")


def clauses(tokens: Sequence[Token]) -> list[tuple[list[Token], bool]]:
    """Clauses in order, each with whether "then" comes before it."""
    out: list[tuple[list[Token], bool]] = []
    current: list[Token] = []
    then = False
    for index, token in enumerate(tokens):
        after = tokens[index + 1].kind if index + 1 < len(tokens) else ""
        joins = (
            token.kind in ("AND", "COMMA")
            and after in VERBS
            and any(t.kind in VERBS or t.kind in ("AUX", "SLOT", "NOUN", "SHAPE", "IT") for t in current)
            and not (not out and current[0].kind in PLACES and not any(t.kind in VERBS for t in current))
        )
        back = (
            token.kind in ("AND", "COMMA") and _back_follows(tokens, index) and any(t.kind in PLACES for t in current)
        )
        again = token.kind in ("AND", "COMMA") and _goes_on(current, tokens[index + 1 :])
        if token.kind in ("SEP", "THEN") or joins or back or again:
            if current:
                out.append((current, then))
                current, then = [], False
            then = then or token.kind == "THEN"
        else:
            current.append(token)
    if current:
        out.append((current, then))
    return out


def _goes_on(before: Sequence[Token], after: Sequence[Token]) -> bool:
    """Whether another thing and its place follow: "the banana in the bowl and the apple on the plate"."""
    end = next((k for k, token in enumerate(after) if token.kind in ("AND", "COMMA", "SEP", "THEN")), len(after))
    kinds = [token.kind for token in after[:end]]
    if not kinds or kinds[0] not in STARTS or set(kinds) & {"AUX", "CONTAIN", "THAT", *VERBS}:
        return False
    went = any(token.kind in _INTO for token in before) and before[-1].kind not in _INTO
    return went and not any(token.kind == "STACK" for token in before) and any(kind in PLACES for kind in kinds[1:-1])


def _back_follows(tokens: Sequence[Token], at: int) -> bool:
    """Whether what follows says that something goes back to where it was ("and it goes back home")."""
    after = at + 1
    while after < len(tokens) and tokens[after].kind in ("IT", "THEY", "SLOT", "AUX"):
        after += 1
    return after < len(tokens) and tokens[after].kind == "ORIGIN"


def read_clauses(tokens: Sequence[Token], meaning: Meaning) -> tuple[Command, ...]:
    """Commands of all clauses, read by their parts.

    Raises:
        Unclear: A clause is not whole.
    """
    for clause, then in clauses(tokens):
        before = len(meaning.done)
        _read(clause, meaning)
        moved = list(dict.fromkeys(command.thing for command in meaning.done[before:]))
        if len(moved) > 1 or (moved and len(meaning.mentioned) > 1):
            meaning.mentioned = moved  # what "them" means next
        if then and before and before < len(meaning.done):
            meaning.done[before] = replace(meaning.done[before], after_last=True)
    if meaning.pending_turn:
        raise Unclear("it is not said by how much to turn it")
    if meaning.pending_put is not None:
        raise Unclear("it is not said where to put it")
    return tuple(meaning.done)


def _read(clause: Sequence[Token], meaning: Meaning) -> None:
    gathered = gathering_template(clause)
    if gathered is not None:
        assert gathered.to is not None  # it goes into something
        meaning.put(gathered.thing, gathered.to)
        return
    parts = parts_of(clause, meaning)
    kinds = parts.kinds
    if read_handled(parts, meaning):
        return
    if "SWAP" in kinds:
        read_swap(parts, meaning)
    elif (
        kinds & {"angle", "again"}
        or ("OPPOSITE" in kinds and kinds & {"ROTATE", "FACE", "GIVE"})
        or (kinds & {"ROTATE", "FACE"} and not kinds & {"PUT", "place"})
    ):
        read_turn(parts, meaning)
    elif kinds & {"CONTAIN", "FILL"}:
        read_contain(parts, meaning)
    elif "STACK" in kinds:
        read_tower(parts, meaning)
    elif kinds & {"RETURN", "origin"} and "place" not in kinds:
        read_back(parts, meaning)
    else:
        read_put(parts, meaning)


def matching_template(tokens: Sequence[Token]) -> Command | None:
    """The rule "each A to the B that shares its colour", however it is put; None when the words say more or less.

    It holds where only two kinds of thing are named, one to be moved and one to receive, something is said to match, and
    nothing singles any of them out.
    """
    kinds = {token.kind for token in tokens}
    if kinds & {"ANGLE", "TURN", "SUPER", "SHAPE", "SIDE", "ORDINAL", "COLOUR", "PATTERN", "MATERIAL", "SWAP", "STACK", "BETWEEN", "LEFT_OF",
                "RIGHT_OF", "NEAR", "ABOVE", "BELOW", "SLOT", "ORIGIN", "RETURN", "EXCEPT", "REMOVE", "PUSH", "ROTATE", "FAR"}:  # fmt: skip
        return None
    says = kinds & {"MATCH", "SAME", "ACCORDING"} or (kinds & {"ITS", "BY"} and "ASPECT" in kinds)
    if not says or not kinds & {"PUT", "SORT", "AUX", "GIVE", "TAKE", "MATCH"}:
        return None
    nouns: list[tuple[str, str]] = []
    for token in tokens:
        if token.kind == "NOUN":
            assert isinstance(token.value, tuple)  # a NOUN's value
            item = (str(token.value[0]), str(token.value[1]))
            if item not in nouns:
                nouns.append(item)
    places = [item for item in nouns if item[0] in ("area", "container")]
    moved = [item for item in nouns if item[0] not in ("area", "container")]
    if not places and "SORT" in kinds:
        places = [("area", "")]
    if len(moved) != 1 or len(places) != 1:
        return None
    aspect = next((str(token.value) for token in tokens if token.kind == "ASPECT"), "colour")
    thing = Description(moved[0][0], "", moved[0][1], quantity="each" if "EACH" in kinds else "all")
    place = Description(places[0][0], "", places[0][1])
    goal = Destination("matching", worded(place), aspect=aspect)  # type: ignore[arg-type]
    return Command("put", worded(thing), goal, conditional="SORT" in kinds)
