"""The meaning of a tree: modifiers applied to a description, pronouns resolved, commands in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from lark import Token, Tree

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.models.offline.description import Description
from wonderful_team.models.offline.language.changes import (
    PRONOUN,
    first_token,
    thing_of,
    tokens_in,
    trees,
    value_of,
)
from wonderful_team.models.offline.language.commands import Command, Destination
from wonderful_team.models.offline.language.sharing import own_match, sharing
from wonderful_team.models.offline.language.wording import render, split_colours

_GOALS = {"IN": "in", "INTO": "in", "TO": "in", "ON": "on", "ONTO": "on", "LEFT_OF": "left", "RIGHT_OF": "right", "ABOVE": "above", "BELOW": "below",
          "NEAR": "near", "BY": "near"}  # fmt: skip


_STANDS = frozenset("is are was were lies lie stands stood sits stand sit".split())
"""Words that say where a thing is, not where it should be."""


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

    def commands(self, sentence: Tree[Token]) -> tuple[Command, ...]:
        after = False
        for child in sentence.children:
            if not isinstance(child, Tree):
                continue
            if child.data == "join":
                after = first_token(child).type == "THEN"
                continue
            before = len(self.done)
            getattr(self, f"_{child.data}")(child)
            if after and before and before < len(self.done):
                self.done[before] = replace(self.done[before], after_last=True)
            after = False
        return tuple(self.done)

    def _put(self, tree: Tree[Token], kind: str = "put") -> None:
        things, matched = self._things(tree)
        where = next((found for goal in trees(tree, "goal") for found in trees(goal, "goal_where")), None)
        if where is not None and str(tokens_in(where)[-1].value.text) not in _STANDS:
            # "the bowl is where the block belongs"
            self.put(self._resolved(thing_of(next(trees(where, "np")))), Destination("in", things[0]), kind)
            return
        goals = list(trees(tree, "goal"))
        if goals:
            goal = self._goal(goals[-1], things[0])
        else:
            side = next(token for token in tokens_in(tree) if token.type == "SIDE")
            goal = Destination("side", side=str(value_of(side)))
        conditional = matched is not None
        if matched is not None and goal is None:
            goal = matched
        if goal is None:
            raise NotUnderstoodError("it is not said what 'it' or 'there' means; name the place")
        goal = own_match(goal, things[0])
        for item in things:
            for thing in split_colours(item):
                self._add(Command(kind, thing, goal, conditional=conditional))  # type: ignore[arg-type]

    def _contain(self, tree: Tree[Token]) -> None:
        things, _ = self._things(tree)
        holder = self._resolved(thing_of(next(trees(tree, "np"))))
        for thing in things:
            self._add(Command("put", thing, Destination("in", holder)))

    def _ellipsis(self, tree: Tree[Token]) -> None:
        self._put(tree, self.done[-1].kind if self.done and self.done[-1].kind != "rotate" else "put")

    def _push(self, tree: Tree[Token]) -> None:
        self._put(tree, "push")

    def _rotate(self, tree: Tree[Token]) -> None:
        angle = next(trees(tree, "angle"))
        amount, sign = 0.0, 1.0
        for token in tokens_in(angle):
            if token.type == "ANGLE":
                amount = float(value_of(token))
            elif token.type == "TURN":
                sign = float(value_of(token))
            elif token.type == "SIDE_POST" and value_of(token) == "leftmost":
                sign = -1.0
        for thing in self._things(tree)[0]:
            self.turn(thing, sign * amount)

    def _stack(self, tree: Tree[Token]) -> None:
        chain = [self._things(tree)[0][0], *(self._resolved(thing_of(np)) for np in trees(tree, "np"))]
        for upper, lower in reversed(list(zip(chain[:-1], chain[1:], strict=True))):
            self._add(Command("put", upper, Destination("on", lower), after_last=bool(self.done)))

    def _swap(self, tree: Tree[Token]) -> None:
        one, other = (self._resolved(thing_of(np)) for np in trees(tree, "np"))
        self.swap(one, other)

    def _sort(self, tree: Tree[Token]) -> None:
        things, _ = self._things(tree)
        goals = list(trees(tree, "goal"))
        aspect = next((str(value_of(token)) for token in tokens_in(tree) if token.type == "ASPECT"), "colour")
        goal = self._goal(goals[-1], things[0]) if goals else Destination("matching", _area(), aspect=aspect)  # type: ignore[arg-type]
        if goal is not None and goals and goal.how in ("in", "on") and goal.what is not None and not goal.what.colours:
            goal = Destination("matching", replace(goal.what, quantity="one"), aspect=aspect)  # type: ignore[arg-type]
        if goal is None:
            raise NotUnderstoodError(
                "it is not said where the things are to be sorted to; name the areas or containers"
            )
        for thing in things:
            many = thing if thing.quantity != "one" else replace(thing, quantity="all")
            self._add(Command("put", many, goal, conditional=True))

    def _things(self, tree: Tree[Token]) -> tuple[list[Description], Destination | None]:
        """The things moved; where two places could hold them, the last one that is not a bare pronoun."""
        found: list[Description] = []
        matched: Destination | None = None
        for things in trees(tree, "things"):
            descriptions = [self._resolved(thing_of(np)) for np in trees(things, "np")]
            pronoun = all(_is_pronoun(np) for np in trees(things, "np"))
            again = bool(found) and found[0].quantity != "one" and descriptions[0].noun == found[0].noun
            if not ((pronoun or again) and found):
                found = descriptions
                self.last_thing = descriptions[-1]
            for had in trees(things, "had_match"):
                matched = sharing(next(trees(had, "matched")), found[0])
        return found, matched

    def _goal(self, tree: Tree[Token], thing: Description) -> Destination | None:
        child = next(item for item in tree.children if isinstance(item, Tree))
        goal: Destination | None
        match str(child.data):
            case "goal_at":
                what = thing_of(next(trees(child, "np")))
                if what.name == PRONOUN:
                    return self._pronoun_goal(next(trees(child, "where")))
                goal = Destination(_goal_how(next(trees(child, "where"))), what)
            case "goal_between":
                first, second = two_of([self._resolved(thing_of(np)) for np in trees(child, "np")])
                goal = Destination("between", first, second)
            case "goal_where":
                other = self._resolved(thing_of(next(trees(child, "np"))))
                return Destination("origin", other)
            case "goal_match":
                goal = sharing(next(trees(child, "matched")), thing)
            case "goal_side":
                token = first_token(child, ("SIDE_POST", "CORNER"))
                value = value_of(token)
                goal = Destination("side", side=value if isinstance(value, str) else " ".join(value))
            case "goal_there":
                return self.last_goal
            case _:
                goal = Destination("origin")
        if goal.how not in ("origin",):
            self.last_goal = goal
        return goal

    def _pronoun_goal(self, where: Tree[Token]) -> Destination | None:
        """For "into it": the last place; "onto it", "left of it" after a put: the thing that was put."""
        how = _goal_how(where)
        if how == "in" and self.last_goal is not None:
            return self.last_goal
        same = next((item.to[0] for item in self.last_thing.related if item.relation.startswith("same_")), None) if (
            self.last_thing is not None) else None  # fmt: skip
        if same is not None:
            return Destination(how, same)
        if self.done:
            return Destination(how, self.done[-1].thing)
        return None

    # Building blocks for reading by parts (see slots.py).

    def put(self, thing: Description, goal: Destination, kind: str = "put") -> None:
        """Bring a thing to a place, and remember both for pronouns."""
        self.last_thing = thing
        if goal.how != "origin":
            self.last_goal = goal
        self._add(Command(kind, thing, goal))  # type: ignore[arg-type]

    def turn(self, thing: Description, amount_deg: float) -> None:
        """Turn a thing, clockwise positive."""
        self.last_thing, self.last_angle = thing, amount_deg
        self._add(Command("rotate", thing, rotate_deg=amount_deg))

    def turn_again(self, groups: Sequence[tuple[list[Description], float]]) -> float:
        """The angle that "that much" means: the last one said."""
        amount = groups[-1][1] if groups else self.last_angle
        if amount is None:
            raise NotUnderstoodError("it is not said what 'that much' means; name the angle in degrees")
        return amount

    def swap(self, one: Description, other: Description) -> None:
        """Two things change places: the first waits on free table meanwhile."""
        spot = Description(noun="area", name="free", text="free area")
        self.put(one, Destination("in", spot))
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

    def match(self, thing: Description, kind: Description, aspect: str) -> None:
        """Each of several things to the one of a kind that shares an aspect with it."""
        many = thing if thing.quantity != "one" else replace(thing, quantity="all")
        single = replace(kind, quantity="one", number=1)
        goal = Destination("matching", replace(single, text=render(single)), aspect=aspect)  # type: ignore[arg-type]
        self.last_thing = many
        self._add(Command("put", many, goal, conditional=True))

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
        full = replace(description, related=related)
        return replace(full, text=render(full))

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
    if len(named) == 1 and named[0].quantity != "one" and named[0].superlative is None:
        single = replace(named[0], quantity="one", number=1)
        left, right = (replace(single, superlative=side) for side in ("leftmost", "rightmost"))
        return replace(left, text=render(left)), replace(right, text=render(right))
    raise NotUnderstoodError("'between' needs two things; name both")


def _area() -> Description:
    return Description(noun="area", text="area")


def _goal_how(where: Tree[Token]) -> Any:
    kinds = [token.type for token in where.scan_values(lambda item: isinstance(item, Token))]
    return "in" if "IN" in kinds or "INTO" in kinds else _GOALS[kinds[0]]


def _is_pronoun(tree: Tree[Token]) -> bool:
    return thing_of(tree).name == PRONOUN
