"""Pushes into a place with walls or a line: which things, in which order, over which stops. And the words for those places.

The places of a plan are found again from its words and the picture alone: the plan's lines say who is pushed before.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias, TypeVar

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.offline.description import Description
from wonderful_team.offline.description import Way as Place
from wonderful_team.offline.language import Destination, describe, render, try_understand
from wonderful_team.offline.pushing.pushes import Field, Way, best_way, inside, study_field
from wonderful_team.offline.vision import Match, Scene

Number: TypeAlias = Callable[[Description], int | None]
"""Who is meant by a description of one thing: its number in a scene, or None."""
Meant = TypeVar("Meant")
FLAT_M = 0.006
"""Walls that are no higher than this are only drawn on the table [m]."""
LOOKS = 16
"""How many ways are looked for at most before the most that was found is taken."""
_WORDS = {"before": "before", "inside": "inside", "away": "away from"}
_AREA = re.compile(
    r"^(?:the\s+)?(?:free\s+|empty\s+)?(?:area|place|spot|space)\s+for\s+the\s+(?P<thing>.+)$", re.IGNORECASE
)
_LEG = re.compile(r"^(?P<leg>before|inside|away from)\s+the\s+(?P<what>.+)$", re.IGNORECASE)
_KEEP = re.compile(r"^(?P<how>clear of|short of)\s+the\s+(?P<what>.+)$", re.IGNORECASE)


@dataclass(frozen=True)
class Sweep:
    """A place to be swept into, by numbers of things in a scene.

    Attributes:
        lines: What must not be touched.
        limit: Whether the line is also as far in as a thing may go.
    """

    into: int
    lines: tuple[int, ...] = ()
    limit: bool = False


@dataclass(frozen=True)
class Order:
    """One thing to be pushed into the place, or aside."""

    number: int
    aside: bool = False


@lru_cache(maxsize=64)
def field_of(scene: Scene, sweep: Sweep) -> Field | None:
    """The table for a sweep; None when there is no way in.

    Walls whose height does not show may only be drawn on the table: where they bar every way they are taken to be.
    """
    by_number = {thing.number: thing for thing in scene.things}
    into, lines = by_number[sweep.into], [by_number[number] for number in sweep.lines]
    field = study_field(scene, into, lines, limit=sweep.limit)
    if field is None or field.room.walls is None or (into.height_m is not None and into.height_m > FLAT_M):
        return field
    if any(best_way(field, number) is not None for number in field.blocks if not inside(field, number)):
        return field
    return study_field(scene, into, lines, limit=sweep.limit, flat_walls=True)


def is_walled(scene: Scene, sweep: Sweep) -> bool:
    """Whether the place has walls or a line, so that the way there matters."""
    field = field_of(scene, sweep)
    return field is not None and (field.room.walls is not None or bool(sweep.lines))


def swept(scene: Scene, sweep: Sweep, numbers: Sequence[int]) -> list[int]:
    """Which of these things lie wholly in the place."""
    field = field_of(scene, sweep)
    return [] if field is None else [n for n in numbers if n in field.blocks and inside(field, n)]


@lru_cache(maxsize=64)
def choose(scene: Scene, sweep: Sweep, numbers: tuple[int, ...], count: int) -> tuple[tuple[Order, Way], ...]:
    """Who is pushed, in order, and how: the easiest first; what bars every way is pushed aside before.

    Fewer than asked for come back where no more straight pushes are free.
    """
    field = field_of(scene, sweep)
    if field is None:
        return ()
    left = tuple(n for n in numbers if n in field.blocks)
    count = min(count, len(left))
    found = _search(field, left, count, [LOOKS])
    aside: Way | None = None
    if len(found) < count:
        stuck = next(number for number in left if number not in {way.number for way in found})
        rest = tuple(number for number in left if number != stuck)
        for way in _asides(field, stuck):
            after = _after(field, way)
            then = best_way(after, stuck)
            if then is not None:
                freed = [then, *_search(_after(after, then), rest, count - 1, [LOOKS])]
                if len(freed) > len(found):
                    found, aside = freed, way
                    break
    orders = [(Order(way.number), way) for way in found]
    return tuple(orders if aside is None else [(Order(aside.number, aside=True), aside), *orders])


def _search(field: Field, left: tuple[int, ...], count: int, looks: list[int], *, fixed: bool = False) -> list[Way]:
    """Ways for so many of these things, one after the other, so that each leaves room for the next; the most found.

    Args:
        field: Where everything is believed to be.
        left: Who may be pushed; in this order when `fixed`.
        count: How many.
        looks: How many ways may still be looked for: [n], counted down.
        fixed: The order is given.
    """
    if count <= 0 or not left:
        return []
    first = [way for number in (left[:1] if fixed else left) if (way := best_way(field, number)) is not None]
    looks[0] -= len(left[:1] if fixed else left)
    best: list[Way] = []
    for easy in sorted(first, key=lambda way: (way.cost, way.number)):
        for deep in (False, True):
            way = best_way(field, easy.number, deep=True) if deep else easy
            if way is None or (deep and way.stops[-1] is easy.stops[-1]):
                continue
            rest = tuple(number for number in left if number != way.number)
            found = [way, *_search(_after(field, way), rest, count - 1, looks, fixed=fixed)]
            if len(found) > len(best):
                best = found
            if len(best) == count or looks[0] <= 0:
                return best
    return best


def _asides(field: Field, stuck: int) -> list[Way]:
    """Pushes of one thing out of the way of a stuck one, the cheapest first."""
    ways = [aside_way(field, number, stuck) for number in field.blocks if number != stuck and not inside(field, number)]
    return sorted((way for way in ways if way is not None), key=lambda way: (way.cost, way.number))


def aside_way(field: Field, number: int, stuck: int) -> Way | None:
    """How a thing is pushed out of the way of another; None when that would not help."""
    then = best_way(field.without(number), stuck) if stuck in field.blocks and number in field.blocks else None
    return None if then is None else best_way(field, number, clear_of=(field.blocks[stuck].at, *then.stops))


def _after(field: Field, way: Way) -> Field:
    start: Array = field.blocks[way.number].at
    for stop in way.stops:
        field, start = field.with_move(way.number, stop, start), stop
    return field


@lru_cache(maxsize=128)
def _in_turn(scene: Scene, sweep: Sweep, orders: tuple[Order, ...]) -> tuple[Way, ...]:
    """The way of each thing in a given order, those before it believed to be where they were pushed; as far as there are ways."""
    field = field_of(scene, sweep)
    found: list[Way] = []
    while field is not None and len(orders) > 1 and orders[0].aside:
        way = aside_way(field, orders[0].number, orders[1].number)
        if way is None:
            return tuple(found)
        found.append(way)
        field, orders = _after(field, way), orders[1:]
    if field is None:
        return ()
    left = tuple(order.number for order in orders if order.number in field.blocks and not order.aside)
    return (*found, *_search(field, left, len(left), [LOOKS], fixed=True))


# Words for the places.


def place_words(place: Place) -> tuple[str, str, tuple[str, ...]]:
    """A place in words (what, where), and the names of the pictures that they speak of."""
    where = [f"{_WORDS[place.leg]} the {render(place.into)}"]
    if place.off is not None:
        where.append(f"clear of the {render(place.off)}")
    if place.limit is not None:
        where.append(f"short of the {render(place.limit)}")
    named = (place.thing, place.into, place.off, place.limit)
    pictures = tuple(dict.fromkeys(item.like for item in named if item is not None and item.like))
    return f"free area for the {render(place.thing)}", "; ".join(where), pictures


def read_place(words: str, where: str) -> Description | None:
    """The inverse of place_words; None for any other words."""
    area = _AREA.match(words.strip())
    parts = [part.strip() for part in where.split(";") if part.strip()]
    leg = _LEG.match(parts[0]) if parts else None
    if area is None or leg is None:
        return None
    kept: dict[str, Description] = {}
    for part in parts[1:]:
        keep = _KEEP.match(part)
        if keep is None:
            return None
        kept[keep.group("how").lower()] = describe(keep.group("what"))
    name = next(key for key, value in _WORDS.items() if value == leg.group("leg").lower())
    thing, into = describe(area.group("thing")), describe(leg.group("what"))
    place = Place(thing, into, name, kept.get("clear of"), kept.get("short of"))  # type: ignore[arg-type]
    return Description("area", f"{words}, {where}", "free", way=place)


def find_place(place: Place, scene: Scene, number: Number, plan: Sequence[str]) -> list[Match]:
    """Where a place is in a scene, as a match like any other; [] when there is no such way.

    Args:
        place: In words, understood.
        scene: As seen.
        number: Who is meant by a description, in that scene.
        plan: Its lines, which say who is pushed before.
    """
    who, sweep = number(place.thing), sweep_of(place.into, place.off, place.limit, number)
    if who is None or sweep is None:
        return []
    orders = _orders(plan, number)
    mine = Order(who, place.leg == "away")
    ways = _in_turn(scene, sweep, orders if mine in orders else (mine,))
    way = next((item for item in ways if item.number == who), None)
    field = field_of(scene, sweep)
    if way is None or field is None or (place.leg == "before" and len(way.stops) == 1):
        return []
    at = way.stops[0] if place.leg == "before" else way.stops[-1]
    side = field.blocks[who].side * field.zoom
    point: Point = field.point(at)
    why = f"a straight push gets the {render(place.thing)} there and meets nothing else"
    return [Match(None, Box.around(point, side, side), point, 1.0, 1.0, why)]


def sweep_of(
    into: Meant, off: Meant | None, limit: Meant | None, number: Callable[[Meant], int | None]
) -> Sweep | None:
    """A place and its lines by numbers; None when one of them does not show."""
    place, lines = number(into), [number(item) for item in (off, limit) if item is not None]
    seen = tuple(item for item in lines if item is not None)
    return None if place is None or len(seen) < len(lines) else Sweep(place, seen, limit is not None)


def _orders(plan: Sequence[str], number: Number) -> tuple[Order, ...]:
    """Who is pushed, in order, by the lines of a plan."""
    pushed = ((number(thing), to.what is not None and to.what.name == "free") for thing, to in pushes_of(plan))
    return tuple(Order(who, free) for who, free in pushed if who is not None)


def pushes_of(plan: Sequence[str]) -> Iterator[tuple[Description, Destination]]:
    """What the lines of a plan push, and where to."""
    for line in plan:
        understood = try_understand(line.partition(":")[2].strip() or line)
        for command in understood.commands if understood is not None else ():
            if command.kind == "push" and command.to is not None:
                yield command.thing, command.to
