"""The meaning of a tree: modifiers applied to a description, pronouns resolved, commands in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import FREE, Description, Figure
from wonderful_team.offline.language.changes import PRONOUN, SAME
from wonderful_team.offline.language.commands import Command, Destination
from wonderful_team.offline.language.wording import singles, worded

_ASPECT = {relation: aspect for aspect, relation in SAME.items()}


@dataclass
class Meaning:
    """Reads one sentence from left to right, remembering what pronouns may mean."""

    last_thing: Description | None = None
    last_goal: Destination | None = None
    done: list[Command] = field(default_factory=list)
    last_angle: float | None = None
    pending_turn: list[Description] = field(default_factory=list)
    pending_sign: float = 1.0
    pending_put: Description | None = None
    mentioned: list[Description] = field(default_factory=list)
    tentative: int | None = None

    # Building blocks for reading by parts (see slots.py).

    def put(self, thing: Description, goal: Destination, kind: str = "put") -> None:
        """Bring a thing to a place, and remember both for pronouns."""
        self.last_thing = thing
        goal = own_match(goal, thing)
        if goal.how != "origin":
            self.last_goal = goal
        self._add(Command(kind, thing, goal))  # type: ignore[arg-type]

    def turn(self, thing: Description, amount_deg: float) -> None:
        """Turn a thing, clockwise positive."""
        self.last_thing, self.last_angle = thing, amount_deg
        self._add(Command("rotate", thing, rotate_deg=amount_deg))

    def handle(
        self,
        kind: str,
        thing: Description,
        figure: Figure | None = None,
        tool: Description | None = None,
        rotate_deg: float = 0.0,
    ) -> None:
        """Do something to a thing where it is."""
        self.last_thing, self.mentioned = thing, [thing]
        self._add(Command(kind, thing, rotate_deg=rotate_deg, figure=figure, tool=tool))  # type: ignore[arg-type]

    def shaken(self, thing: Description) -> bool:
        """Whether a thing was shaken just now: putting it back is part of that."""
        return bool(self.done) and self.done[-1].kind == "shake" and self.done[-1].thing == self.resolved_or_kept(thing)

    def turn_again(self, groups: Sequence[tuple[list[Description], float]]) -> float:
        """The angle that "that much" means: the last one said."""
        amount = groups[-1][1] if groups else self.last_angle
        if amount is None:
            raise NotUnderstoodError("it is not said what 'that much' means; name the angle in degrees")
        return amount

    def swap(self, one: Description, other: Description) -> None:
        """Two things change places: the first waits on free table meanwhile."""
        self.put(one, Destination("in", FREE))
        self.put(other, Destination("origin", one))
        self.done[-1] = replace(self.done[-1], after_last=True)
        self.put(one, Destination("origin", other))
        self.done[-1] = replace(self.done[-1], after_last=True)

    def tower_of_pairs(self, pairs: Sequence[tuple[Description, Description]]) -> None:
        """Each upper thing on its lower one, from the bottom up."""
        left = list(pairs)
        first = True
        while left:
            uppers = [upper for upper, _ in left]
            ready = next((pair for pair in left if pair[1] not in uppers), left[-1])
            left.remove(ready)
            self.put(ready[0], Destination("on", ready[1]))
            if not first:
                self.done[-1] = replace(self.done[-1], after_last=True)
            first = False

    def back(self, things: Sequence[Description]) -> None:
        """Bring things back to where they stood; what was moved last, or all that was moved, when nothing is named."""
        moved = list(dict.fromkeys(command.thing for command in self.done if command.kind != "rotate"))
        if things and not all(item.name in (PRONOUN, "") and item.noun == "thing" for item in things):
            back = [self._resolved(item) for item in things]
        elif len(moved) == 1 or (things and things[0].quantity == "one" and moved):
            back = [moved[-1]]
        elif moved:
            back = moved[::-1]
        else:
            raise NotUnderstoodError("it is not said what is to go back; name the thing")
        for thing in back:
            self.put(thing, Destination("origin"))

    def there(self, things: Sequence[Description], kind: str) -> None:
        """Put things at the last place named."""
        if self.last_goal is None:
            raise NotUnderstoodError("it is not said what 'there' means; name the place")
        for thing in self.or_last(things):
            self.put(thing, self.last_goal, kind)

    def mention(self, things: Sequence[Description]) -> None:
        """Remember things that a clause names, for pronouns in the next."""
        named = [thing for thing in things if thing.name not in (PRONOUN, "table")]
        if named:
            self.last_thing = named[0]

    def or_last(self, things: Sequence[Description]) -> list[Description]:
        """The things named, pronouns resolved; the last one when none is."""
        if not things:
            if self.last_thing is None:
                raise NotUnderstoodError("it is not said what is to be moved; name the thing")
            return [self.last_thing]
        return [self._resolved(thing) for thing in things]

    def resolved_or_kept(self, description: Description) -> Description:
        """A pronoun's thing when one is known; "the former" and "the latter" of two."""
        if description.name in ("former", "latter"):
            if len(self.mentioned) != 2:  # noqa: PLR2004
                raise NotUnderstoodError(f"it is not said what 'the {description.name}' means; name the thing")
            return self.mentioned[description.name == "latter"]
        if description.name == PRONOUN and self.last_thing is not None and description.quantity == "one":
            return self.last_thing
        return description

    def _resolved(self, description: Description) -> Description:
        if any(to.name == PRONOUN for related in description.related for to in related.to):
            description = self._resolved_inside(description)
        if description.name in ("former", "latter"):
            return self.resolved_or_kept(description)
        if description.name != PRONOUN:
            return description
        if self.last_thing is None:
            raise NotUnderstoodError("it is not said what 'it' means; name the thing")
        return self.last_thing

    def _resolved_inside(self, description: Description) -> Description:
        """Pronouns in relations: "the block that was at its left"."""
        if self.last_thing is None:
            raise NotUnderstoodError("it is not said what 'it' means; name the thing")
        last = self.last_thing
        related = tuple(
            replace(item, to=tuple(last if to.name == PRONOUN else to for to in item.to))
            for item in description.related
        )
        return worded(replace(description, related=related))

    def _add(self, command: Command) -> None:
        """Keep a command; what is only said again ("the block belongs in the bowl; put it there") counts once."""
        if self.tentative is not None and [item.thing for item in self.done[self.tentative :]] == [command.thing]:
            # "take it out of the box and put it …": one move, not two.
            del self.done[self.tentative :]
        self.tentative = None
        self.pending_put = None if self.pending_put == command.thing else self.pending_put
        same = self.done and replace(self.done[-1], after_last=False) == command and command.kind != "rotate"
        if not same:
            self.done.append(command)


def two_of(named: Sequence[Description]) -> tuple[Description, Description]:
    """Two references: as named, or the outer ones of "the two bowls"."""
    if len(named) == 2:  # noqa: PLR2004
        return named[0], named[1]
    if len(named) == 1 and len(apart := singles(named[0])) == 2:  # noqa: PLR2004
        return apart[0], apart[1]
    if len(named) == 1 and named[0].quantity != "one" and named[0].superlative is None:
        single = replace(named[0], quantity="one", number=1)
        single = replace(single, number=max(2, named[0].number))  # so many are spoken of
        left, right = (replace(single, superlative=side) for side in ("leftmost", "rightmost"))
        return worded(left), worded(right)
    raise NotUnderstoodError("'between' needs two things; name both")


def _may_mean(thing: Description, noun: str, name: str) -> bool:
    """Whether a noun may stand for the thing moved."""
    if name == PRONOUN or (noun in ("object", "thing") and not name):
        return True
    return thing.noun == noun and (not name or thing.name == name)


def own_match(goal: Destination, thing: Description) -> Destination:
    """The same goal; "the bowl of the same colour as that block", said of each block, is the one that matches it."""
    what = goal.what
    if what is None or goal.how not in ("in", "on") or thing.quantity not in ("each", "all"):
        return goal
    for related in what.related:
        to = related.to[0]
        plain = to == replace(Description(noun=to.noun, text=to.text, name=to.name), quantity=to.quantity)
        if related.relation in _ASPECT and plain and not to.like and _may_mean(thing, to.noun, to.name):
            kind = replace(what, related=tuple(item for item in what.related if item is not related))
            kind = worded(kind)
            return Destination("matching", kind, aspect=_ASPECT[related.relation])  # type: ignore[arg-type]
    return goal
