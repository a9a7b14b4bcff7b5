"""What another's words mean: a person's, or those of a plan that another model wrote."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from wonderful_team.core.geometry import Box
from wonderful_team.core.text import ORDINALS
from wonderful_team.core.values import Target, TrueThing
from wonderful_team.simulated.appearance import fit, known, lightness, tokens
from wonderful_team.simulated.draft import Meaning
from wonderful_team.simulated.plan import stands_at
from wonderful_team.simulated.seeing import Seen
from wonderful_team.simulated.spots import free_spot, room_spot

NEARLY = 0.3
"""Things whose words fit less well than the best by no more than this fit as well."""
SIDES: Mapping[str, tuple[int, int]] = {
    "left": (-1, 0), "west": (-1, 0), "right": (1, 0), "east": (1, 0), "above": (0, -1), "north": (0, -1),
    "behind": (0, -1), "below": (0, 1), "south": (0, 1), "front": (0, 1),
}  # fmt: skip
"""Sides as the picture shows them: x right, y down."""


@dataclass(frozen=True, eq=False)
class Search:
    """Where words are looked up.

    Attributes:
        things: Everything on the table.
        slots: The instruction's pictures that are shown, by name.
        tables: Those of them that show a table and not one thing alone.
        pointed: Where the question itself points [picture px].
    """

    seen: Seen
    things: Mapping[str, TrueThing]
    slots: Mapping[str, Sequence[Seen]]
    tables: frozenset[str] = frozenset()
    pointed: Box | None = None

    def at(self, name: str) -> tuple[float, float]:
        """Where a thing stands in the whole view [view px]."""
        point = self.seen.picture.frame.point_to_view(self.seen.centre(name) or (0.0, 0.0))
        return point[0], point[1]

    def height(self, name: str) -> float:
        return self.things[name].height_m


def meaning_of(
    target: Target,
    seen: Seen,
    things: Mapping[str, TrueThing],
    slots: Mapping[str, Sequence[Seen]],
    tables: frozenset[str] = frozenset(),
    at: Box | None = None,
) -> Meaning | None:
    """The thing or place that a target's words mean.

    Args:
        target: The words.
        seen: The picture that is asked about.
        things: Everything on the table.
        slots: The instruction's pictures that are shown, by name.
        tables: Those of them that show a table.
        at: Where the question itself points [picture px]: it decides between things that fit the words alike.
    """
    search = Search(seen, things, slots, tables, at)
    if target.kind == "area":
        return _area(target, search)
    carried = "pick" in target.roles or "grasp" in target.roles
    name = _thing(target.words, target.where, target.like, search, carried)
    return None if name is None else Meaning(name)


def _thing(words: str, where: str, like: Sequence[str], search: Search, carried: bool = False) -> str | None:
    """The one thing that words mean; None when nothing fits."""
    names = [name for name, thing in search.things.items() if thing.kind == "object"] if carried else []
    names = names or list(search.things)
    alone = [name for name in like if f"{{{name}}}" in words] or ([] if where else list(like))
    told = tokens(words)
    if alone:
        names = _like(alone[0], search)
        told = []
    scores = {name: fit(told, name, search.things[name], search.seen) for name in names}
    if not scores:
        return None
    best = max(scores.values())
    if told and not any(known(told, name, search.things[name], search.seen) for name in names if scores[name] == best):
        return None
    fitting = [name for name in names if scores[name] >= best - NEARLY]
    sided = _beside(where, fitting, search)
    if sided is not None:
        return sided
    return _one_of(words.lower(), fitting, search)


def _like(slot: str, search: Search) -> list[str]:
    """The things that look like the one in a picture: that very thing, else those of its shape."""
    for seen in search.slots.get(slot, ()):
        for name in seen.sight.masks:
            if name in search.things:
                return [name]
            thing = seen.sight.things.get(name)
            shape = thing.shape if thing is not None else name
            same = [one for one, item in search.things.items() if item.shape == shape or shape.startswith(item.shape)]
            if same:
                return same
    return []


_CHOICES: Mapping[str, tuple[str, int]] = {
    "lightest": ("light", 1), "lighter": ("light", 1), "darkest": ("light", -1), "darker": ("light", -1),
    "tallest": ("high", 1), "taller": ("high", 1), "highest": ("high", 1), "shortest": ("high", -1), "shorter": ("high", -1),
    "lowest": ("high", -1), "largest": ("large", 1), "biggest": ("large", 1), "larger": ("large", 1),
    "smallest": ("large", -1), "smaller": ("large", -1),
}  # fmt: skip


def _one_of(words: str, names: Sequence[str], search: Search) -> str | None:
    """Which of several that fit is meant: by order from the left, by height, lightness or size; else the best known one."""
    if len(names) == 1:
        return names[0]
    in_order = sorted(names, key=search.at)
    backwards = "from the right" in words
    numbers = (ORDINALS[word] for word in re.findall(r"\w+", words) if word in ORDINALS)
    number = next((number for number in numbers if number <= len(in_order)), None)
    if number is not None:
        return in_order[-number] if backwards else in_order[number - 1]
    if "leftmost" in words or "rightmost" in words:
        return in_order[0] if "leftmost" in words else in_order[-1]
    measures: Mapping[str, Callable[[str], float]] = {
        "light": lambda name: lightness(name, search.seen),
        "high": search.height,
        "large": lambda name: float(search.seen.sight.masks[name].sum()),
    }
    for word, (measure, sign) in _CHOICES.items():
        if re.search(rf"\b{word}\b", words):
            return max(names, key=lambda name: sign * measures[measure](name))
    if search.pointed is not None:
        boxes = {name: box for name in names if (box := search.seen.box(name)) is not None}
        return max(boxes, key=lambda name: boxes[name].iou(search.pointed), default=None)  # type: ignore[arg-type]
    return in_order[0] if names else None


def _beside(where: str, names: Sequence[str], search: Search) -> str | None:
    """The nearest of these things on the named side of another one."""
    side = next((SIDES[word] for word in re.findall(r"[a-z]+", where.lower()) if word in SIDES), None)
    slot = re.search(r"\{([^}]*)\}", where)
    if side is None:
        return None
    found = _like(slot.group(1), search) if slot is not None else []
    other = found[0] if found else _thing(where.split(" of ", 1)[-1].split(";")[0], "", (), search)
    if other is None:
        return None
    x, y = search.at(other)
    ways = []
    for name in names:
        if name == other:
            continue
        dx, dy = search.at(name)[0] - x, search.at(name)[1] - y
        along, across = dx * side[0] + dy * side[1], abs(dx * side[1]) + abs(dy * side[0])
        if along > across:
            ways.append((math.hypot(dx, dy), name))
    return min(ways, default=(0.0, None))[1]


def _area(target: Target, search: Search) -> Meaning | None:
    """A place: where a picture of the instruction shows a thing, or free room."""
    tables = [name for name in target.like if name in search.tables]
    if tables and "free" not in target.words:
        return _shown_place(target.words, tables[-1], search)
    spot = _region_spot(target.words, target.where, search) or free_spot(search.seen, search.things)
    return None if spot is None else Meaning(at_m=spot)


def _region_spot(words: str, where: str, search: Search) -> tuple[float, float] | None:
    """Free room in or before a thing and off others, where the words name such; near to what it is for."""
    found: dict[str, list[str]] = {"inside": [], "before": [], "clear of": [], "short of": []}
    for said, slot in re.findall(r"(inside|before|clear of|short of)[^;{]*\{([^}]*)\}", where):
        found[said] += _like(slot, search)[:1]
    rooms = found["inside"] or found["before"]
    if not rooms:
        return None
    of = re.search(r"\bfor the (.*)", words)
    comes = _thing(of.group(1), "", (), search, carried=True) if of is not None else None
    return room_spot(
        search.things[rooms[0]],
        inside=bool(found["inside"]),
        off=[search.things[name] for name in (*found["clear of"], *found["short of"])],
        short_of=[search.things[name] for name in found["short of"]],
        others=[thing for name, thing in search.things.items() if thing.kind == "object" and name != comes],
        comes=None if comes is None else search.things[comes],
    )


def _shown_place(words: str, slot: str, search: Search) -> Meaning | None:
    """Where a thing stands in a picture of the table, as a place on the table."""
    seen = search.slots[slot][0]
    things = {name: thing for name in seen.sight.masks if (thing := seen.thing(name)) is not None}
    told = tokens(words.removeprefix("place of "))
    scores = {name: fit(told, name, thing, seen) for name, thing in things.items()}
    if not scores:
        return None
    best = max(scores.values())
    if told and not any(known(told, name, thing, seen) for name, thing in things.items() if scores[name] == best):
        return None
    name = _one_of(
        words.lower(), [one for one, score in scores.items() if score >= best - NEARLY], Search(seen, things, {})
    )
    camera = seen.sight.view.camera or search.seen.sight.view.camera
    at = None if name is None else stands_at(seen.sight, name, camera)
    return None if at is None else Meaning(at_m=at, slots=(slot,))
