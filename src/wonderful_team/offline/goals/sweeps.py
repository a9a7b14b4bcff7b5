"""Aims of an instruction to push things into a place with walls or a line: which of them, over which stops."""

from __future__ import annotations

from dataclasses import replace

from wonderful_team.offline.description import FREE, Description, Way
from wonderful_team.offline.eyes import Eyes, one_of
from wonderful_team.offline.goals.aims import Aim, Aims, Named, seen_named
from wonderful_team.offline.language import Command, worded
from wonderful_team.offline.pushing.sweeping import choose, is_walled, sweep_of, swept


def swept_aims(command: Command, what: Description, things: list[Named], eyes: Eyes, result: Aims) -> list[Aim] | None:
    """One aim per thing to be pushed; None where the way there does not matter or the place does not show.

    Exactly so many are pushed as are asked for: those that lie there already count.
    """
    to, off, limit = (_named(item, eyes, result) for item in (what, command.off, command.limit))
    sweep = None if to is None else sweep_of(to, off, limit, lambda item: item.number)
    if to is None or sweep is None or not is_walled(eyes.scene, sweep):
        return None
    named = {sweep.into, *sweep.lines}
    numbers = tuple(item.number for item in things if item.number is not None and item.number not in named)
    first = Aim("push", things[0], "in", to, off=off, limit=limit, legs=("inside",)) if things else None
    if result.literal or first is None:
        return [replace(first, thing=item) for item in things] if first is not None else []
    there = swept(eyes.scene, sweep, numbers)
    wanted = command.thing.number if command.thing.quantity == "number" else len(numbers)
    if there:
        result.settled.append(f"{len(there)} of them lie in the {to.words} already")
    left = tuple(number for number in numbers if number not in there)
    count = max(0, min(wanted, len(numbers)) - len(there))
    words = {item.number: item for item in things}
    free = frozenset(left) if count < len(left) else frozenset[int]()
    aims: list[Aim] = []
    for order, way in choose(eyes.scene, sweep, left, count):
        before = (len(result.aims) + len(aims) - 1,) if aims else ()
        if order.aside:
            seen = eyes.thing(order.number)
            assert seen is not None  # it was chosen from this scene
            who = words.get(order.number) or seen_named(eyes, seen)
            why = f"it blocks the way into the {to.words}"
            aims.append(Aim("push", who, "in", Named(FREE), after=before, why=why, off=to, legs=("away",)))
            continue
        legs = ("before",) * (len(way.stops) - 1) + ("inside",)
        aims.append(replace(first, thing=words[order.number], after=before, legs=legs, others=free))
    pushed = sum(aim.legs != ("away",) for aim in aims)
    if pushed < count:
        result.notes.append(f"for {count - pushed} of them no straight way into the {to.words} is free yet")
    if not pushed and count:
        # Nothing can be reached: the plan says so where the place on the way is not found.
        aims += [replace(first, thing=words[number], others=free) for number in left[:count]]
    return aims


def way_places(aim: Aim) -> list[Description]:
    """The places on the way of a thing, in order."""
    into = aim.off if aim.legs == ("away",) else aim.to
    assert into is not None  # an aim with legs goes somewhere
    off = None if aim.legs == ("away",) or aim.off is None else aim.off.description
    limit = None if aim.limit is None else aim.limit.description
    places = []
    for leg in aim.legs:
        way = Way(aim.thing.description, into.description, leg, off, limit)  # type: ignore[arg-type]
        places.append(Description("area", f"free area for the {aim.thing.words}", "free", way=way))
    return places


def _named(description: Description | None, eyes: Eyes, result: Aims) -> Named | None:
    if description is None:
        return None
    single = one_of(description)
    number = eyes.number(single)
    if number is None:
        result.misses(single, eyes)
    return Named(worded(single), number)
