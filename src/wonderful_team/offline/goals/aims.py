"""One aim per thing that is to be moved, and who is meant."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from wonderful_team.offline.description import Description, Figure
from wonderful_team.offline.eyes import Eyes, one_of, unique_words
from wonderful_team.offline.language import render
from wonderful_team.offline.vision import Thing


@dataclass(frozen=True)
class Named:
    """A thing or area in words, and its number in the picture where it was found."""

    description: Description
    number: int | None = None

    @property
    def words(self) -> str:
        return self.description.text

    def same(self, other: Named) -> bool:
        """Whether both mean the same: the same thing in the picture, or the same words where it is not found."""
        if self.number is not None and other.number is not None:
            return self.number == other.number
        return _alike(self.description, other.description)


@dataclass(frozen=True)
class Aim:
    """One thing to be brought about.

    Attributes:
        how: As Destination.how without matching: in | on | left | right | above | below | near | between | origin | side;
            "" for rotate.
        to, other: References of the destination.
        after: Positions of aims that must come first.
        off, limit: What a pushed thing must not touch, and a line that it must not pass.
        legs: Where straight pushes take it, one after the other: before | inside | away; () where one push does.
        others: Numbers of other things that would do as well.
        figure: What a tool is led along over the thing (trace), or how the thing is moved in the air (shake).
    """

    kind: Literal["put", "rotate", "push", "trace", "shake", "twist"]
    thing: Named
    how: str = ""
    to: Named | None = None
    other: Named | None = None
    side: str = ""
    rotate_deg: float = 0.0
    after: tuple[int, ...] = ()
    why: str = ""
    off: Named | None = None
    limit: Named | None = None
    legs: tuple[str, ...] = ()
    others: frozenset[int] = frozenset()
    figure: Figure | None = None

    def same_goal(self, other: Aim) -> bool:
        """Whether both bring the thing to the same state."""
        if {self.kind, other.kind} & {"trace", "shake", "twist"}:
            return (self.kind, self.figure) == (other.kind, other.figure)
        if self.kind == "rotate" or other.kind == "rotate":
            return self.kind == other.kind and abs((self.rotate_deg - other.rotate_deg + 180) % 360 - 180) < 0.5
        if _family(self.how) != _family(other.how) or self.side != other.side:
            return False
        return _same(self.to, other.to) and _same(self.other, other.other)

    def same(self, other: Aim) -> bool:
        alike = self.thing.same(other.thing) or other.thing.number in self.others or self.thing.number in other.others
        return alike and self.same_goal(other)


@dataclass
class Aims:
    """Everything an instruction comes to, and what was left out on purpose.

    Attributes:
        absent: What the words presume and the picture does not show, each by name.
        settled: What was seen in its place already; without any of it, nothing is fulfilled.
        said: What the user said beside the instruction.
    """

    aims: list[Aim] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    question: str = ""
    choices: tuple[str, ...] = ()
    literal: bool = False
    absent: list[str] = field(default_factory=list)
    settled: list[str] = field(default_factory=list)
    said: tuple[str, ...] = ()

    def misses(self, description: Description, eyes: Eyes) -> None:
        """Note that nothing fits a description."""
        said = f"no {_absent_part(description, eyes)} is in the picture"
        if said not in self.absent:
            self.absent.append(said)

    @property
    def unfounded(self) -> str:
        """What keeps the words from being carried out or fulfilled, or ""."""
        if self.absent:
            return "; ".join(self.absent)
        if not self.aims and not self.settled:
            return "; ".join(["nothing that the words speak of is seen in its place", *self.notes])
        return ""


def seen_named(eyes: Eyes, thing: Thing, noun: str = "object") -> Named:
    """A thing by words that lead to it."""
    return Named(unique_words(eyes, thing, noun), thing.number)


def _absent_part(description: Description, eyes: Eyes) -> str:
    """Words for what does not show: a thing that others are told by, or else the thing itself."""
    others = (to for related in description.related for to in related.to)
    gone = next((to for to in others if not eyes.find(one_of(to))), None)
    return render(one_of(description)) if gone is None else _absent_part(gone, eyes)


def _family(how: str) -> str:
    return "in" if how in ("in", "on") else how


def _same(one: Named | None, other: Named | None) -> bool:
    if one is None or other is None:
        return one is None and other is None
    return one.same(other)


def _alike(one: Description, other: Description) -> bool:
    """Whether two descriptions of things that are not both found in the picture may mean the same."""
    if one.like or other.like:
        return one.like == other.like
    if one.superlative != other.superlative or one.ordinal != other.ordinal:
        return False
    if one.name and other.name and one.name != other.name:
        return False
    if set(one.colours) != set(other.colours) or (one.shape and other.shape and one.shape != other.shape):
        return False
    if one.material and other.material and one.material != other.material:
        return False
    if one.pattern and other.pattern and one.pattern != other.pattern:
        return False
    general = ("object", "thing")
    return one.noun == other.noun or one.noun in general or other.noun in general
