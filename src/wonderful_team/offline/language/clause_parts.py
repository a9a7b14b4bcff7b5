"""The parts of a clause, in order: noun phrases, places, angles and verbs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from wonderful_team.offline.description import Description
from wonderful_team.offline.language.changes import PRONOUN, thing_of
from wonderful_team.offline.language.grammar import parse
from wonderful_team.offline.language.meaning import Meaning
from wonderful_team.offline.language.tokens import Token
from wonderful_team.offline.language.wording import worded

_GOALS = frozenset(("place", "side", "between", "where", "there", "origin", "off", "from"))
"""Parts that say where to."""
_SIDES = frozenset(("SIDE_POST", "CORNER"))
_WITH = frozenset(("WITH", "FOR"))
VERBS = frozenset(
    (
        "PUT",
        "TAKE",
        "ROTATE",
        "STACK",
        "PUSH",
        "SORT",
        "SWAP",
        "RETURN",
        "REMOVE",
        "LEAVE",
        "DRAW",
        "WIPE",
        "SHAKE",
        "OPEN",
    )
)
PLACES = {"IN": "in", "INTO": "in", "TO": "in", "ON": "on", "ONTO": "on", "LEFT_OF": "left", "RIGHT_OF": "right",
           "ABOVE": "above", "BELOW": "below", "NEAR": "near", "BY": "near"}  # fmt: skip
STARTS = frozenset(
    "EACH ALL NUMBER REST COLOUR ORANGE DARK PATTERN MATERIAL LOOK SHAPE SUPER SIDE ORDINAL FREE SLOT NOUN LETTER ONE EVERYTHING IT THEY "
    "TABLE ONE_OF FORMER LATTER THAT".split()
)
_IN_NOUN = STARTS | frozenset(
    "AS ASPECT AUX BESIDE_IT CORNER EXCEPT FROM ITS LIKE OF OF_TWO ON_TABLE SAME SHAPED SHARE SIDE_POST WHOSE WITH".split()
)
_LOOKS = frozenset(("COLOUR", "ORANGE", "DARK"))
_SOFT = frozenset("AUX THAT GIVE WANT OF IT WITH FOR AS AND COMMA THERE_IS ON_TABLE TABLE EACH AROUND SHARE".split())
_NAMED = {"SAMEANGLE": "again", "ORIGIN": "origin", "THERE": "there", "WHERE": "where", "BETWEEN": "between", "OFF": "off",
          "FROM": "from", "EXCEPT": "except"}  # fmt: skip
_KEPT = frozenset(
    "CONTAIN FILL GIVE WANT AUX FACE OPPOSITE ACCORDING MEASURE ENOUGH AND COMMA ASPECT ITS SUPER PLACE_OF AROUND RESPECTIVELY FIGURE TIMES".split()
)
_LONGEST = 14
_MANY = ("them", "they")


class Unclear(Exception):  # noqa: N818  caught inside this package
    """A clause whose parts do not make a whole; says what is missing or left over."""


@dataclass
class Parts:
    """What a clause holds, in order: (kind, value)."""

    items: list[tuple[str, Any]] = field(default_factory=list)

    @property
    def kinds(self) -> set[str]:
        return {kind for kind, _ in self.items}

    def of(self, kind: str) -> list[Any]:
        return [value for name, value in self.items if name == kind]


def parts_of(clause: Sequence[Token], meaning: Meaning) -> Parts:
    """Cut a clause into its parts; a side that the last thing is told by is where it goes when nothing else is said."""
    kinds = {token.kind for token in clause}
    parts = _cut(clause, meaning, _WITH if kinds & {"SWAP", "FILL"} else frozenset())
    if parts.items and parts.items[-1] in (("place", "IN"), ("place", "INTO")) and meaning.last_goal is not None:
        parts.items[-1] = ("there", None)  # "carry it to the bowl and drop it in"
    if (parts.kinds & {"PUT", "PUSH"} or not kinds & VERBS) and not parts.kinds & _GOALS and kinds & _SIDES:
        return _cut(clause, meaning, _SIDES)
    return parts


def _cut(clause: Sequence[Token], meaning: Meaning, apart: frozenset[str]) -> Parts:
    """The parts of a clause; no noun phrase holds a word of the kinds `apart`."""
    parts = Parts()
    at = 0
    while at < len(clause):
        token = clause[at]
        taken, found = _noun_phrase(clause, at, apart)
        if found is not None:
            at += taken
            if found.name == PRONOUN and token.text in _MANY and len(meaning.mentioned) > 1 and not parts.of("np"):
                parts.items += [("np", thing) for thing in meaning.mentioned]
                continue
            if found.name == PRONOUN and parts.of("np"):
                if parts.items[-1][0] == "place" and len(meaning.mentioned) == 1:
                    parts.items.append(("np", meaning.mentioned[0]))
                    continue  # "take the bowl and put the block in it"
                if parts.items[-1][0] == "place":
                    raise Unclear("it is not clear what 'it' means; name the thing")
                continue  # "so that it lies left of the bowl": the thing named before
            if parts.items and parts.items[-1][0] == "except":
                _leave_out(parts, found)
                continue
            parts.items.append(("np", meaning.resolved_or_kept(found)))
            continue
        at += 1
        part = _part(token)
        if part is not None:
            parts.items.append(part)
    return parts


def _part(token: Token) -> tuple[str, Any] | None:
    """A part that is one word or phrase; None for one that says nothing here."""
    value: Any = token.value
    if token.kind in _NAMED:
        return _NAMED[token.kind], None
    if token.kind in ("ANGLE", "TURN"):
        return token.kind.lower(), float(value)
    if token.kind in ("SIDE_POST", "CORNER", "SIDE"):
        words = value if isinstance(value, tuple) else (value,)
        return "side", " ".join(str(word) for word in words)
    if token.kind in PLACES:
        return "place", token.kind
    if token.kind in VERBS or token.kind in _KEPT:
        return token.kind, value
    if token.kind in _SOFT:
        return None
    raise Unclear(f"I do not see what {token.text!r} is for")


def _leave_out(parts: Parts, found: Description) -> None:
    """Add an exception to the noun phrase before it."""
    at = next((k for k in range(len(parts.items) - 1, -1, -1) if parts.items[k][0] == "np"), None)
    if at is None:
        raise Unclear("it is not clear what the exception is from")
    del parts.items[-1]
    whole = replace(parts.items[at][1], excluded=(*parts.items[at][1].excluded, found))
    parts.items[at] = ("np", worded(whole))


def _noun_phrase(clause: Sequence[Token], at: int, apart: frozenset[str]) -> tuple[int, Description | None]:
    """The longest noun phrase that starts there: how many tokens it takes and what it says."""
    if clause[at].kind not in STARTS:
        return 0, None
    end, told = at, False
    while end < len(clause) and end - at < _LONGEST:
        kind, after = clause[end].kind, clause[end + 1].kind if end + 1 < len(clause) else ""
        looks = (
            kind in ("AND", "COMMA") and end > at and clause[end - 1].kind in _LOOKS and _looks_follow(clause, end + 1)
        )
        inside = kind in ("IN", "ON") and end > at and (after == "CORNER" or _is_shown(clause, at, end))
        inside = inside or (kind == "IN" and end > at and after in _LOOKS and _is_looks_alone(clause, end + 1))
        inside = inside or (kind == "TO" and end > at and clause[end - 1].value == "nearest")
        told = (told or (kind in (*PLACES, "BETWEEN") and _is_relative(clause, end))) and kind != "COMMA"
        before = {token.kind for token in clause[at:end]}
        joins = kind == "AND" and (told and "BETWEEN" in before or "EXCEPT" in before)
        two = [token.kind for token in clause[end - 1 : end + 1]] == ["SLOT", "SLOT"] and end > at
        if (
            kind in apart
            or (
                kind in ("IT", "THEY")
                and end > at
                and clause[end - 1].kind in ("NOUN", "SHAPE", "LETTER", "SLOT", "ONE")
            )
            or (two and clause[at - 1].kind in PLACES)
            or not (kind in _IN_NOUN or looks or inside or joins or (told and _is_relative(clause, end)))
        ):
            break
        end += 1
    for stop in range(end, at, -1):
        if clause[stop - 1].kind in ("AUX", "WITH", "OF", "THAT", "AS", "AND", "COMMA", "FROM", "SHARE"):
            continue
        tree = parse(list(clause[at:stop]), "np")
        if tree is not None:
            return stop - at, thing_of(tree)
    return 0, None


def _looks_follow(clause: Sequence[Token], at: int) -> bool:
    """Whether a colour follows that belongs to the same noun ("red and blue striped", "red, green and blue blocks")."""
    return at < len(clause) and clause[at].kind in _LOOKS and at + 1 < len(clause)


def _is_relative(clause: Sequence[Token], at: int) -> bool:
    """Whether a place word says where something stands: after "that is", or "there is" at the front."""
    if clause[0].kind == "ON_TABLE":
        return True
    while at and clause[at - 1].kind == "AUX":
        at -= 1
    return at > 0 and clause[at - 1].kind == "THAT"


def _is_shown(clause: Sequence[Token], start: int, at: int) -> bool:
    """Whether "in {picture}" tells a thing: something else in the clause is its place, or it is a place itself."""
    if at + 1 >= len(clause) or clause[at + 1].kind != "SLOT" or clause[at - 1].kind not in ("NOUN", "ONE", "SHAPE"):
        return False
    place = start > 0 and clause[start - 1].kind in PLACES
    return place or any(
        token.kind in (*PLACES, "ANGLE", "ROTATE", "CONTAIN") for token in (*clause[:start], *clause[at + 2 :])
    )


def _is_looks_alone(clause: Sequence[Token], at: int) -> bool:
    """Whether colours stand there without a noun ("the square in dark blue")."""
    while at < len(clause) and clause[at].kind in _LOOKS:
        at += 1
    return at == len(clause) or clause[at].kind not in STARTS
