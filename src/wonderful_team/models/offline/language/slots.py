"""Reading a clause by its parts where the grammar knows no such order of words.

A clause is cut into noun phrases, places, angles and verbs; what each part is follows from the words beside it. Every word
must find its part, and the parts must make a whole: else the clause is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from wonderful_team.models.offline.description import Description, Related
from wonderful_team.models.offline.language.changes import PRONOUN, thing_of
from wonderful_team.models.offline.language.commands import Command, Destination
from wonderful_team.models.offline.language.grammar import parse
from wonderful_team.models.offline.language.meaning import Meaning, two_of
from wonderful_team.models.offline.language.tokens import Token
from wonderful_team.models.offline.language.wording import render, split_colours

VERBS = frozenset(("PUT", "TAKE", "ROTATE", "STACK", "PUSH", "SORT", "SWAP", "RETURN", "REMOVE", "LEAVE"))
_PLACES = {"IN": "in", "INTO": "in", "TO": "in", "ON": "on", "ONTO": "on", "LEFT_OF": "left", "RIGHT_OF": "right",
           "ABOVE": "above", "BELOW": "below", "NEAR": "near", "BY": "near"}  # fmt: skip
_GOES = frozenset(("INTO", "ONTO", "TO"))
_RELATIONS = {"in": "inside", "on": "on", "left": "left_of", "right": "right_of", "above": "above", "below": "below",
              "near": "near"}  # fmt: skip
BY_PARTS = frozenset(("STACK", "FORMER", "LATTER", "AROUND", "RESPECTIVELY"))
"""Words whose clauses are always read by their parts."""
_IN_NOUN = frozenset(
    "EACH ALL NUMBER REST COLOUR ORANGE DARK PATTERN MATERIAL LOOK SHAPE SUPER SIDE ORDINAL FREE SLOT NOUN LETTER ONE EVERYTHING IT "
    "THEY TABLE ASPECT ONE_OF OF_TWO SIDE_POST ON_TABLE CORNER LIKE SHAPED WITH OF THAT AUX AS SAME SHARE FROM EXCEPT FORMER LATTER".split()
)
_STARTS = frozenset(
    "EACH ALL NUMBER REST COLOUR ORANGE DARK PATTERN MATERIAL LOOK SHAPE SUPER SIDE ORDINAL FREE SLOT NOUN LETTER ONE EVERYTHING IT THEY "
    "TABLE ONE_OF FORMER LATTER THAT".split()
)
_LOOKS = frozenset(("COLOUR", "ORANGE", "DARK"))
_SOFT = frozenset("AUX THAT GIVE WANT OF IT WITH FOR AS AND COMMA THERE_IS ON_TABLE TABLE EACH AROUND SHARE".split())
_LEVELS = {"bottommost": 0, "middle": 1, "topmost": 2}
_LONGEST = 14
_TWO = 2


class Unclear(Exception):  # noqa: N818  caught inside this package
    """A clause whose parts do not make a whole; says what is missing or left over."""


@dataclass
class _Parts:
    """What a clause holds, in order: (kind, value)."""

    items: list[tuple[str, Any]] = field(default_factory=list)

    @property
    def kinds(self) -> set[str]:
        return {kind for kind, _ in self.items}

    def of(self, kind: str) -> list[Any]:
        return [value for name, value in self.items if name == kind]


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
            and any(t.kind in VERBS or t.kind == "AUX" for t in current)
        )
        if token.kind in ("SEP", "THEN") or joins:
            if current:
                out.append((current, then))
                current, then = [], False
            then = then or token.kind == "THEN"
        else:
            current.append(token)
    if current:
        out.append((current, then))
    return out


def read_clauses(tokens: Sequence[Token], meaning: Meaning) -> tuple[Command, ...]:
    """Commands of all clauses, read by their parts.

    Raises:
        Unclear: A clause is not whole.
    """
    for clause, then in clauses(tokens):
        before = len(meaning.done)
        _read(clause, meaning)
        if then and before and before < len(meaning.done):
            meaning.done[before] = replace(meaning.done[before], after_last=True)
    if meaning.pending_turn:
        raise Unclear("it is not said by how much to turn it")
    return tuple(meaning.done)


def _read(clause: Sequence[Token], meaning: Meaning) -> None:
    tree = None if any(token.kind in BY_PARTS for token in clause) else parse(list(clause), "sentence")
    if tree is not None:
        meaning.commands(tree)
        return
    parts = _parts(clause, meaning)
    kinds = parts.kinds
    if "SWAP" in kinds:
        _swap(parts, meaning)
    elif (
        kinds & {"angle", "again"}
        or ("OPPOSITE" in kinds and kinds & {"ROTATE", "FACE", "GIVE"})
        or (kinds & {"ROTATE", "FACE"} and not kinds & {"PUT", "place"})
    ):
        _turn(parts, meaning)
    elif "STACK" in kinds:
        _tower(parts, meaning)
    elif kinds & {"RETURN", "origin"} and "place" not in kinds:
        _back(parts, meaning)
    elif "ACCORDING" in kinds:
        _accordingly(parts, meaning)
    else:
        _put(parts, meaning)


def _parts(clause: Sequence[Token], meaning: Meaning) -> _Parts:
    parts = _Parts()
    at = 0
    while at < len(clause):
        token = clause[at]
        taken, found = _noun_phrase(clause, at, parts)
        if found is not None:
            at += taken
            if found.name == PRONOUN and parts.of("np"):
                if parts.items[-1][0] == "place":
                    raise Unclear("it is not clear what 'it' means; name the thing")
                continue  # "so that it lies left of the bowl": the thing named before
            if parts.items and parts.items[-1][0] == "except":
                _leave_out(parts, found)
                continue
            parts.items.append(("np", meaning.resolved_or_kept(found)))
            continue
        at += 1
        match token.kind:
            case "ANGLE":
                parts.items.append(("angle", float(token.value)))  # type: ignore[arg-type]
            case "SAMEANGLE":
                parts.items.append(("again", None))
            case "TURN":
                parts.items.append(("turn", float(token.value)))  # type: ignore[arg-type]
            case "SIDE_POST" | "CORNER" | "SIDE":
                value = token.value
                parts.items.append(("side", value if isinstance(value, str) else " ".join(value)))  # type: ignore[call-overload]
            case "ORIGIN":
                parts.items.append(("origin", None))
            case "THERE":
                parts.items.append(("there", None))
            case "WHERE":
                parts.items.append(("where", None))
            case "BETWEEN" | "OFF" | "FROM" | "EXCEPT":
                parts.items.append((token.kind.lower(), None))
            case kind if kind in _PLACES:
                parts.items.append(("place", kind))
            case kind if kind in VERBS or kind in ("GIVE", "WANT", "AUX", "FACE", "OPPOSITE", "ACCORDING", "MEASURE", "ENOUGH",
                                                   "AND", "COMMA", "ASPECT", "ITS", "SUPER", "PLACE_OF", "AROUND", "RESPECTIVELY"):  # fmt: skip
                parts.items.append((kind, token.value))
            case kind if kind in _SOFT:
                pass
            case _:
                raise Unclear(f"I do not see what {token.text!r} is for")
    return parts


def _leave_out(parts: _Parts, found: Description) -> None:
    """Add an exception to the noun phrase before it."""
    at = next((k for k in range(len(parts.items) - 1, -1, -1) if parts.items[k][0] == "np"), None)
    if at is None:
        raise Unclear("it is not clear what the exception is from")
    del parts.items[-1]
    whole = replace(parts.items[at][1], excluded=(*parts.items[at][1].excluded, found))
    parts.items[at] = ("np", replace(whole, text=render(whole)))


def _noun_phrase(clause: Sequence[Token], at: int, parts: _Parts) -> tuple[int, Description | None]:
    """The longest noun phrase that starts there: how many tokens it takes and what it says."""
    if clause[at].kind not in _STARTS:
        return 0, None
    end = at
    while end < len(clause) and end - at < _LONGEST:
        kind = clause[end].kind
        looks = (
            kind in ("AND", "COMMA") and end > at and clause[end - 1].kind in _LOOKS and _looks_follow(clause, end + 1)
        )
        if kind not in _IN_NOUN and not looks:
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


def _things(parts: _Parts, meaning: Meaning) -> list[Description]:
    """Noun phrases that stand after no word for a place."""
    out, free = [], True
    for kind, value in parts.items:
        if kind in ("place", "off", "from", "between", "except", "where"):
            free = False
        elif kind == "np":
            if free:
                out.append(value)
            free = True
    return out


def _swap(parts: _Parts, meaning: Meaning) -> None:
    things = [item for item in parts.of("np") if item.name != "table"]
    if len(things) == 1 and (things[0].quantity == "number" and things[0].number == _TWO):
        raise Unclear("name the two things to be swapped, each by its own words")
    if len(things) != _TWO:
        raise Unclear(f"a swap needs two things; I read {len(things)}")
    meaning.swap(things[0], things[1])


def _turn(parts: _Parts, meaning: Meaning) -> None:
    """Angles go to the things named before them, or after them when nothing stands before."""
    sign = 1.0
    for kind, value in parts.items:
        if kind == "turn":
            sign = float(value)
        elif kind == "side" and value in ("leftmost", "rightmost"):
            sign = -1.0 if value == "leftmost" else 1.0
    groups: list[tuple[list[Description], float]] = []
    things: list[Description] = []
    waiting: float | None = None
    for kind, value in parts.items:
        if kind == "np":
            things.append(value)
        elif kind in ("angle", "again", "OPPOSITE"):
            if kind == "OPPOSITE" and not parts.kinds & {"angle", "again"}:
                amount = 180.0
            elif kind == "OPPOSITE":
                sign = -sign
                continue
            else:
                amount = sign * float(value) if kind == "angle" else meaning.turn_again(groups)
            if things:
                groups.append((things, amount))
                things = []
            else:
                waiting = amount
    if things and waiting is not None:
        groups.append((things, waiting))
    elif things and not groups:
        meaning.pending_turn = [*things]
        meaning.pending_sign = sign
        meaning.last_thing = things[-1]
        return
    elif things:
        raise Unclear("it is not said by how much to turn the last thing")
    elif waiting is not None and not groups:
        _turn_later(parts, waiting, sign, meaning)
        return
    for group, amount in groups:
        for thing in group:
            meaning.turn(thing, amount)


def _turn_later(parts: _Parts, amount: float, sign: float, meaning: Meaning) -> None:
    """An angle without a thing: it completes a turn that waits for one, turns the last thing, or is kept for later."""
    if meaning.pending_turn:
        waiting, meaning.pending_turn = meaning.pending_turn, []
        factor = meaning.pending_sign if sign > 0 else 1.0
        for thing in waiting:
            meaning.turn(thing, amount * factor)
    elif parts.kinds & {"ROTATE", "FACE", "GIVE"} and meaning.last_thing is not None:
        meaning.turn(meaning.last_thing, amount)
    else:
        meaning.last_angle = amount


def _tower(parts: _Parts, meaning: Meaning) -> None:
    """Pairs "A on B", or a list from the bottom up; places within the tower ("at the bottom") order it."""
    groups: list[list[Description]] = []
    joins = True
    for kind, value in parts.items:
        if kind == "np":
            thing = replace(value, quantity="one", number=1) if len(split_colours(value)) == 1 else value
            if joins or not groups:
                groups.append([thing])
            else:
                groups[-1].append(thing)
            joins = True
        elif kind == "place" and value in ("ON", "ONTO", "IN", "INTO"):
            joins = False
        elif kind == "side" and groups and value in _LEVELS:
            groups[-1][-1] = replace(groups[-1][-1], superlative=value)
    chains = [group for group in groups if len(group) > 1]
    if chains and not (len(chains) == 1 and len(groups) > 1 and chains[0] is groups[-1] and len(chains[0]) == _TWO):
        if len(chains) < len(groups):
            raise Unclear("it is not clear which thing goes on which")
        meaning.tower_of_pairs([pair for chain in chains for pair in zip(chain[:-1], chain[1:], strict=True)])
        return
    named = [group[0] for group in groups]
    placed = [(_LEVELS.get(thing.superlative or "", k), thing) for k, thing in enumerate(named)]
    ordered = [
        replace(part, superlative=None if thing.superlative in _LEVELS else part.superlative, quantity="one", number=1)
        for _, thing in sorted(placed, key=lambda item: item[0])
        for part in split_colours(thing)
    ]
    listed = [replace(thing, text=render(thing)) for thing in ordered]
    if chains:
        listed.insert(0, chains[0][-1])
    if len(listed) < _TWO:
        raise Unclear("a tower needs at least two things, named from the bottom up, or pairs such as A on B")
    meaning.tower_of_pairs(list(zip(listed[1:], listed[:-1], strict=True)))


def _back(parts: _Parts, meaning: Meaning) -> None:
    things = _things(parts, meaning)
    meaning.back([thing for thing in things if thing.name != "table"])


def _accordingly(parts: _Parts, meaning: Meaning) -> None:
    """ "Sort the fruits onto the areas accordingly": each goes to the one that shares its colour, or what is named."""
    nps = parts.of("np")
    aspect = next((str(value) for value in parts.of("ASPECT")), "colour")
    things = _things(parts, meaning)
    kinds = [item for item in nps if item not in things and item.noun in ("area", "container", "object")]
    if len(things) != 1 or len(kinds) != 1:
        raise Unclear("name what is sorted and where to")
    meaning.match(things[0], kinds[0], aspect)


def _put(parts: _Parts, meaning: Meaning) -> None:
    things = _things(parts, meaning)
    pairs, source = _placed_pairs(parts)
    sides = parts.of("side")
    goes = parts.kinds & {"PUT", "PUSH", "RETURN"}
    wants = goes or parts.kinds & {"AUX", "WANT", "GIVE", "SORT", "TAKE", "LEAVE"}
    kind = "push" if "PUSH" in parts.kinds else "put"
    if "PLACE_OF" in parts.kinds:
        nps = parts.of("np")
        if len(nps) != _TWO or "AUX" not in parts.kinds:
            raise Unclear("it is not clear what goes where")
        meaning.put(nps[0], Destination("in", nps[1]), kind)
        return
    if "except" in parts.kinds:
        raise Unclear("it is not clear what is left out")
    if "RESPECTIVELY" in parts.kinds:
        _pairwise(parts, meaning, kind)
        return
    if "where" in parts.kinds:
        _where(parts, meaning, kind)
        return
    if parts.of("there"):
        meaning.there(things, kind)
        return
    if "REMOVE" in parts.kinds or (source is not None and not pairs and not sides and wants):
        meaning.tentative = None
        first = len(meaning.done)
        _away(things, source, meaning)
        if "REMOVE" not in parts.kinds:
            meaning.tentative = first
        return
    if "between" in parts.kinds and parts.of("np"):
        _between(parts, meaning, kind)
        return
    if not pairs and sides:
        for thing in meaning.or_last(things):
            meaning.put(thing, Destination("side", side=str(sides[-1])), kind)
        return
    if not pairs:
        _without_place(parts, things, meaning, bool(goes))
        return
    goal_at = next((k for k, (how, _) in enumerate(pairs) if how in _GOES), 0)
    how, what = pairs[goal_at]
    for other, reference in pairs[goal_at + 1 :]:
        what = _with(what, other, reference)
    things = meaning.or_last(things)
    for other, reference in pairs[:goal_at]:
        things[-1] = _with(things[-1], other, reference)
    if source is not None:
        things[-1] = _with(things[-1], "ON" if what.noun != "container" else "IN", source)
    if not wants and meaning.done == [] and len(things) != 1:
        raise Unclear("no word says what to do with them")
    for item in things:
        for thing in split_colours(item):
            meaning.put(thing, Destination(_PLACES[how], what), kind)  # type: ignore[arg-type]


def _pairwise(parts: _Parts, meaning: Meaning, kind: str) -> None:
    """ "the apple and the lime on the red and the green area respectively"."""
    at = next((k for k, (name, _) in enumerate(parts.items) if name == "place"), None)
    if at is None:
        raise Unclear("it is not said where to put them")
    things = [value for name, value in parts.items[:at] if name == "np"]
    goals = [value for name, value in parts.items[at:] if name == "np"]
    goals = [part for goal in goals for part in _by_colour(goal, len(things))]
    if len(things) != len(goals) or len(things) < _TWO:
        raise Unclear(f"'respectively' pairs {len(things)} things with {len(goals)} places")
    for thing, goal in zip(things, goals, strict=True):
        meaning.put(thing, Destination(_PLACES[parts.items[at][1]], goal), kind)  # type: ignore[arg-type]


def _by_colour(goal: Description, count: int) -> list[Description]:
    if len(goal.colours) != count or goal.pattern or goal.quantity == "one":
        return [goal]
    parts = [replace(goal, colours=(colour,), quantity="one", number=1) for colour in goal.colours]
    return [replace(part, text=render(part)) for part in parts]


def _placed_pairs(parts: _Parts) -> tuple[list[tuple[str, Description]], Description | None]:
    """(place word, noun phrase) pairs in order, and what something is taken out of."""
    pairs: list[tuple[str, Description]] = []
    source: Description | None = None
    word, out = "", False
    for kind, value in parts.items:
        if kind == "place":
            word = str(value)
        elif kind in ("off", "from"):
            out = True
        elif kind == "np":
            if out:
                source, out = value, False
            elif word:
                pairs.append((word, value))
            word = ""
    if word and not parts.kinds & {"there", "side", "origin", "angle"}:
        raise Unclear("the place after " + repr(word.lower().replace("_", " ")) + " is missing")
    return pairs, source


def _with(thing: Description, word: str, reference: Description) -> Description:
    related = Related(_RELATIONS[_PLACES[word]], (reference,))  # type: ignore[arg-type]
    full = replace(thing, related=(*thing.related, related))
    return replace(full, text=render(full))


def _between(parts: _Parts, meaning: Meaning, kind: str) -> None:
    position = next(k for k, (name, _) in enumerate(parts.items) if name == "between")
    after = [value for name, value in parts.items[position:] if name == "np"]
    before = [value for name, value in parts.items[:position] if name == "np"]
    rest = after[_TWO:]
    first, second = two_of(after[:_TWO])
    for thing in meaning.or_last(before or rest):
        meaning.put(thing, Destination("between", first, second), kind)


def _where(parts: _Parts, meaning: Meaning, kind: str) -> None:
    """ "the bowl is where the block belongs", "put the banana where the apple is"."""
    position = next(k for k, (name, _) in enumerate(parts.items) if name == "where")
    before = [value for name, value in parts.items[:position] if name == "np"]
    after = [value for name, value in parts.items[position:] if name == "np"]
    if len(before) != 1 or len(after) != 1:
        raise Unclear("it is not clear what goes where")
    if "AUX" in {name for name, _ in parts.items[:position]} and not parts.kinds & {"PUT", "PUSH"}:
        meaning.put(after[0], Destination("in", before[0]), kind)
    else:
        meaning.put(before[0], Destination("origin", after[0]), kind)


def _away(things: list[Description], source: Description | None, meaning: Meaning) -> None:
    free = Description(noun="area", name="free", text="free area")
    for thing in meaning.or_last(things):
        moved = _with(thing, "IN" if source.noun == "container" else "ON", source) if source is not None else thing
        meaning.put(moved, Destination("in", free), "put")


def _without_place(parts: _Parts, things: list[Description], meaning: Meaning, goes: bool) -> None:
    """Only names things, or goes on from the clause before."""
    if goes and meaning.last_goal is None:
        raise Unclear("it is not said where to put it")
    if not things:
        raise Unclear("it names nothing to be moved")
    meaning.mentioned = [thing for thing in things if thing.name not in (PRONOUN, "table")]
    meaning.mention(things)
    if meaning.done and meaning.last_goal is not None and not parts.kinds & {"TAKE", "SHARE", "AUX"}:
        # "put the star into the red bowl, then the blue one": another place for the same thing.
        last = meaning.done[-1]
        if last.to is not None and last.to.what is not None and _alike_kind(things[0], last.to.what):
            meaning.put(last.thing, replace(last.to, what=things[0]), last.kind)
            return
    if goes and things[0].name != PRONOUN:
        raise Unclear("it is not said where to put it")


def _alike_kind(one: Description, other: Description) -> bool:
    return (
        one.noun == other.noun
        or (one.like is not None and other.like is not None)
        or "object" in (one.noun, other.noun)
    )


def gist_of_matching(tokens: Sequence[Token]) -> Command | None:
    """The rule "each A to the B that shares its colour", however it is put; None when the words say more or less.

    It holds where only two kinds of thing are named, one to be moved and one to receive, something is said to match, and
    nothing singles any of them out.
    """
    kinds = {token.kind for token in tokens}
    if kinds & {"ANGLE", "TURN", "SUPER", "SIDE", "ORDINAL", "COLOUR", "PATTERN", "MATERIAL", "SWAP", "STACK", "BETWEEN", "LEFT_OF",
                "RIGHT_OF", "NEAR", "ABOVE", "BELOW", "SLOT", "ORIGIN", "RETURN", "EXCEPT", "REMOVE", "PUSH", "ROTATE", "FAR"}:  # fmt: skip
        return None
    says = kinds & {"MATCH", "SAME", "ACCORDING"} or (kinds & {"ITS", "BY"} and "ASPECT" in kinds)
    if not says or not kinds & {"PUT", "SORT", "AUX", "GIVE", "TAKE"}:
        return None
    nouns: list[tuple[str, str]] = []
    for token in tokens:
        if token.kind == "NOUN":
            noun, name, _ = token.value  # type: ignore[misc]
            if (noun, name) not in nouns:
                nouns.append((noun, name))
    places = [item for item in nouns if item[0] in ("area", "container")]
    moved = [item for item in nouns if item[0] not in ("area", "container")]
    if len(moved) != 1 or len(places) != 1:
        return None
    aspect = next((str(token.value) for token in tokens if token.kind == "ASPECT"), "colour")
    thing = Description(moved[0][0], "", moved[0][1], quantity="each")
    place = Description(places[0][0], "", places[0][1])
    goal = Destination("matching", replace(place, text=render(place)), aspect=aspect)  # type: ignore[arg-type]
    return Command("put", replace(thing, text=render(thing)), goal, conditional=True)
