"""What the parts of a clause come to: each kind of clause by the parts that it holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from wonderful_team.offline.description import FREE, Description, Related
from wonderful_team.offline.language.changes import PRONOUN
from wonderful_team.offline.language.clause_parts import PLACES, Parts, Unclear
from wonderful_team.offline.language.commands import Destination
from wonderful_team.offline.language.meaning import Meaning, two_of
from wonderful_team.offline.language.wording import singles, split_colours, worded

_GOES = frozenset(("INTO", "ONTO", "TO"))
_RELATIONS = {"in": "inside", "on": "on", "left": "left_of", "right": "right_of", "above": "above", "below": "below",
              "near": "near"}  # fmt: skip
_LEVELS = {"bottommost": 0, "middle": 1, "topmost": 2}
_TWO = 2


def _things(parts: Parts) -> list[Description]:
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


def read_swap(parts: Parts, meaning: Meaning) -> None:
    """Two things change places."""
    things = [item for item in parts.of("np") if item.name != "table"]
    if len(apart := [part for item in things for part in singles(item)]) == _TWO:
        things = apart
    if len(things) == 1 and (things[0].quantity == "number" and things[0].number == _TWO):
        raise Unclear("name the two things to be swapped, each by its own words")
    if len(things) != _TWO:
        raise Unclear(f"a swap needs two things; I read {len(things)}")
    meaning.swap(things[0], things[1])


def read_turn(parts: Parts, meaning: Meaning) -> None:
    """Angles go to the things named before them, or after them when nothing stands before."""
    sign = _way(parts)
    groups, things, waiting = _turned(parts, sign, meaning)
    if things and waiting is not None:
        groups.append((things, waiting))
    elif things and not groups:
        meaning.pending_turn, meaning.pending_sign = [*things], sign
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


def _way(parts: Parts) -> float:
    """1 for clockwise, -1 for counterclockwise."""
    sign = 1.0
    for kind, value in parts.items:
        if kind == "turn":
            sign = float(value)
        elif kind == "side" and value in ("leftmost", "rightmost"):
            sign = -1.0 if value == "leftmost" else 1.0
    # "by 30 degrees in the opposite direction"
    return -sign if "OPPOSITE" in parts.kinds and parts.kinds & {"angle", "again"} else sign


def _turned(
    parts: Parts, sign: float, meaning: Meaning
) -> tuple[list[tuple[list[Description], float]], list[Description], float | None]:
    """Things with their angles, things that still wait for one, and an angle that waits for a thing."""
    groups: list[tuple[list[Description], float]] = []
    things: list[Description] = []
    waiting: float | None = None
    told = parts.kinds & {"angle", "again"}
    for kind, value in parts.items:
        if kind == "np":
            things.append(value)
        elif kind in ("angle", "again") or (kind == "OPPOSITE" and not told):
            amount = (
                180.0 if kind == "OPPOSITE" else meaning.turn_again(groups) if kind == "again" else sign * float(value)
            )
            if things:
                groups.append((things, amount))
                things = []
            else:
                waiting = amount
    return groups, things, waiting


def _turn_later(parts: Parts, amount: float, sign: float, meaning: Meaning) -> None:
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


def read_tower(parts: Parts, meaning: Meaning) -> None:
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
    listed = [worded(thing) for thing in ordered]
    if chains:
        listed.insert(0, chains[0][-1])
    if len(listed) < _TWO:
        raise Unclear("a tower needs at least two things, named from the bottom up, or pairs such as A on B")
    meaning.tower_of_pairs(list(zip(listed[1:], listed[:-1], strict=True)))


def read_contain(parts: Parts, meaning: Meaning) -> None:
    """The words "the bowl must contain the block", "cover the area with the block"."""
    nps = parts.of("np")
    if len(nps) < _TWO:
        raise Unclear("it is not clear what goes where")
    holder, *things = nps
    for item in things:
        for thing in split_colours(item):
            meaning.put(thing, Destination("in", holder))


def read_back(parts: Parts, meaning: Meaning) -> None:
    """Things go back to where they stood."""
    things = _things(parts)
    meaning.back([thing for thing in things if thing.name != "table"])


def read_put(parts: Parts, meaning: Meaning) -> None:
    """Things go to a place, are taken away, or are only named for the next clause."""
    if "except" in parts.kinds:
        raise Unclear("it is not clear what is left out")
    passed_over = parts.kinds & {"origin", "angle", "again", "turn", "ASPECT", "MEASURE", "FACE", "OPPOSITE", "STACK"}
    if passed_over:
        raise Unclear(f"it is not clear what {', '.join(sorted(passed_over)).lower()} is for")
    goes = bool(parts.kinds & {"PUT", "PUSH", "RETURN"})
    wants = goes or bool(parts.kinds & {"AUX", "WANT", "GIVE", "SORT", "TAKE", "LEAVE"})
    again = not wants and bool(meaning.done) and meaning.done[-1].kind == "push"
    kind = "push" if again or "PUSH" in parts.kinds else "put"
    special = next((reader for word, reader in _SPECIAL.items() if word in parts.kinds), None)
    if special is not None:
        special(parts, meaning, kind)
        return
    things = _things(parts)
    pairs, source = _placed_pairs(parts)
    sides = parts.of("side")
    if sides and (pairs or len(sides) > 1 or "ITS" in parts.kinds):
        raise Unclear("it is not clear what is at that side")
    removed = "REMOVE" in parts.kinds and not any(how in _GOES for how, _ in pairs)
    if removed or (source is not None and not pairs and not sides and wants):
        _away(things, source, meaning, sure="REMOVE" in parts.kinds)
    elif pairs:
        if not wants and meaning.done == [] and len(things) != 1:
            raise Unclear("no word says what to do with them")
        _to_place(things, pairs, source, meaning, kind)
    elif sides:
        for thing in meaning.or_last(things):
            meaning.put(thing, Destination("side", side=str(sides[-1])), kind)
    else:
        _without_place(parts, things, meaning, goes)


def _to_place(
    things: list[Description],
    pairs: list[tuple[str, Description]],
    source: Description | None,
    meaning: Meaning,
    kind: str,
) -> None:
    """Of several places the first that something goes to is meant; the others say where a thing or the place is."""
    goal_at = next((k for k, (how, _) in enumerate(pairs) if how in _GOES), 0)
    how, what = pairs[goal_at]
    for other, reference in pairs[goal_at + 1 :]:
        what = related_to(what, other, reference)
    things = meaning.or_last(things)
    for other, reference in pairs[:goal_at]:
        things[-1] = related_to(things[-1], other, reference)
    if source is not None:
        things[-1] = related_to(things[-1], "IN" if source.noun == "container" else "ON", source)
    for item in things:
        for thing in split_colours(item):
            meaning.put(thing, Destination(PLACES[how], what), kind)  # type: ignore[arg-type]


def _home(parts: Parts, meaning: Meaning, kind: str) -> None:
    """The words "the place of the block is the bowl"."""
    nps = parts.of("np")
    if len(nps) != _TWO or "AUX" not in parts.kinds:
        raise Unclear("it is not clear what goes where")
    meaning.put(nps[0], Destination("in", nps[1]), kind)


def _pairwise(parts: Parts, meaning: Meaning, kind: str) -> None:
    """The words "the apple and the lime on the red and the green area respectively"."""
    at = next((k for k, (name, _) in enumerate(parts.items) if name == "place"), None)
    if at is None:
        raise Unclear("it is not said where to put them")
    things = [value for name, value in parts.items[:at] if name == "np"]
    goals = [value for name, value in parts.items[at:] if name == "np"]
    goals = [part for goal in goals for part in singles(goal)]
    if len(things) != len(goals) or len(things) < _TWO:
        raise Unclear(f"'respectively' pairs {len(things)} things with {len(goals)} places")
    for thing, goal in zip(things, goals, strict=True):
        meaning.put(thing, Destination(PLACES[parts.items[at][1]], goal), kind)  # type: ignore[arg-type]


def _placed_pairs(parts: Parts) -> tuple[list[tuple[str, Description]], Description | None]:
    """(place word, noun phrase) pairs in order, and what something is taken out of."""
    pairs: list[tuple[str, Description]] = []
    source: Description | None = None
    word, out = "", False
    for kind, value in parts.items:
        if kind == "place":
            word, out = str(value), False  # "drop it off in the bowl": nothing is taken off the bowl
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


def related_to(thing: Description, word: str, reference: Description) -> Description:
    """A thing told by how it stands to another; `word` is the kind of a token for a place."""
    related = Related(_RELATIONS[PLACES[word]], (reference,))  # type: ignore[arg-type]
    return worded(replace(thing, related=(*thing.related, related)))


def _between(parts: Parts, meaning: Meaning, kind: str) -> None:
    position = next(k for k, (name, _) in enumerate(parts.items) if name == "between")
    after = [value for name, value in parts.items[position:] if name == "np"]
    before = [value for name, value in parts.items[:position] if name == "np"]
    rest = after[_TWO:]
    first, second = two_of(after[:_TWO])
    for thing in meaning.or_last(before or rest):
        meaning.put(thing, Destination("between", first, second), kind)


def _where(parts: Parts, meaning: Meaning, kind: str) -> None:
    """The words "the bowl (the top left corner) is where the block belongs", "put the banana where the apple is"."""
    nps = parts.of("np")
    if len(parts.of("where")) == _TWO and len(nps) == 2 * _TWO and all(map(_same_looks, nps[:_TWO], nps[:1:-1])):
        meaning.swap(nps[0], nps[1])
        return
    position = next(k for k, (name, _) in enumerate(parts.items) if name == "where")
    before = [value for name, value in parts.items[:position] if name == "np"]
    after = [value for name, value in parts.items[position:] if name == "np"]
    sides = [value for name, value in parts.items[:position] if name == "side"]
    if sides and not before and len(after) == 1:
        meaning.put(after[0], Destination("side", side=str(sides[-1])), kind)
        return
    if len(before) != 1 or len(after) != 1 or sides:
        raise Unclear("it is not clear what goes where")
    if "AUX" in {name for name, _ in parts.items[:position]} and not parts.kinds & {"PUT", "PUSH"}:
        how = next((value for name, value in parts.items[:position] if name == "place"), "IN")
        meaning.put(after[0], Destination(PLACES[how], before[0]), kind)  # type: ignore[arg-type]
    else:
        meaning.put(before[0], Destination("origin", after[0]), kind)


def _same_looks(one: Description, other: Description) -> bool:
    """Whether words may mean the same thing: "the yellow block" and "the yellow one"."""
    return (one.colours, one.shape, one.like) == (other.colours, other.shape, other.like)


def _away(things: list[Description], source: Description | None, meaning: Meaning, *, sure: bool) -> None:
    """Onto free table; unless sure, a following "put it …" makes one move of both."""
    meaning.tentative, first = None, len(meaning.done)
    for thing in meaning.or_last(things):
        moved = related_to(thing, "IN" if source.noun == "container" else "ON", source) if source is not None else thing
        meaning.put(moved, Destination("in", FREE), "put")
    meaning.tentative = None if sure else first


def _without_place(parts: Parts, things: list[Description], meaning: Meaning, goes: bool) -> None:
    """Only names things, or goes on from the clause before."""
    if not things:
        raise Unclear("it names nothing to be moved")
    if meaning.last_angle is not None and not meaning.done and not goes:
        for thing in things:
            meaning.turn(thing, meaning.last_angle)  # "by 30 degrees: the star"
        return
    if goes and meaning.last_goal is None and len(things) == 1 and things[0].name != PRONOUN:
        meaning.pending_put = things[0]  # "move the block: it belongs in the bowl"
    elif goes and meaning.last_goal is None:
        raise Unclear("it is not said where to put it")
    meaning.mentioned = [thing for thing in things if thing.name not in (PRONOUN, "table")]
    if meaning.last_thing is not None:
        things = meaning.or_last(things)
    meaning.mention(things)
    if meaning.done and meaning.last_goal is not None and not parts.kinds & {"TAKE", "SHARE", "AUX"}:
        # "put the star into the red bowl, then the blue one": another place for the same thing.
        last = meaning.done[-1]
        if _stood_beside(things[0]):
            # "put the star into the bowl, then what was left of it": another thing to the same place.
            meaning.put(things[0], meaning.last_goal, last.kind)
            return
        if last.to is not None and last.to.what is not None and _alike_kind(things[0], last.to.what):
            meaning.put(last.thing, replace(last.to, what=things[0]), last.kind)
            return
        if things[0].noun == last.thing.noun and not things[0].like:
            # "put the lemon into the bowl, then the pear": another thing of that kind to the same place.
            meaning.put(things[0], meaning.last_goal, last.kind)
            return
    if goes and things[0].name != PRONOUN and meaning.pending_put is None:
        raise Unclear("it is not said where to put it")


def _stood_beside(thing: Description) -> bool:
    """Whether a thing is told by where it stands."""
    return len(thing.related) > 1 and thing.related[-1].relation == "nearest"


def _alike_kind(one: Description, other: Description) -> bool:
    return (
        one.noun == other.noun
        or (one.like is not None and other.like is not None)
        or "object" in (one.noun, other.noun)
    )


_SPECIAL: dict[str, Callable[[Parts, Meaning, str], None]] = {
    "PLACE_OF": _home,
    "RESPECTIVELY": _pairwise,
    "where": _where,
    "there": lambda parts, meaning, kind: meaning.there(_things(parts), kind),
    "between": _between,
}
"""Words that settle alone how a clause is read."""
