"""What is said once and meant again: the noun of "the green one", and the many that an exception is from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import Description
from wonderful_team.offline.language.changes import ONE, OTHERS
from wonderful_team.offline.language.commands import Command
from wonderful_team.offline.language.wording import worded


def with_nouns(commands: Iterable[Command]) -> tuple[Command, ...]:
    """The commands with every "one" as the noun that it stands for: of the thing or place before it."""
    done: list[Command] = []
    thing: Description | None = None
    place: Description | None = None
    for item in map(_excepted, commands):
        to = item.to
        there = None if to is None or _holds(to.what) else to.what
        before = [command.thing for command in done]
        thing = with_noun(item.thing, thing or place or there)
        thing = _besides(thing, before or [there])
        if to is not None:
            what = None if to.what is None else _besides(with_noun(to.what, place or thing), [*before, thing])
            other = None if to.other is None else with_noun(to.other, what or thing)
            to, place = replace(to, what=what, other=other), what or place
        done.append(replace(item, thing=thing, to=to))
    return tuple(done)


def _besides(description: Description, named: Sequence[Description | None]) -> Description:
    """What "the other block" means: a block that is none of those named before.

    Raises:
        NotUnderstoodError: None was named.
    """
    if all(item.name != OTHERS for item in description.excluded):
        return description
    kinds = (description.noun, "thing") if description.noun not in ("object", "thing") else None
    known = [item for item in named if item is not None and (kinds is None or item.noun in kinds)]
    if not known:
        raise NotUnderstoodError(f"I do not know: which other {description.noun} is meant; name it")
    left_out = (*(item for item in description.excluded if item.name != OTHERS), *dict.fromkeys(known))
    return worded(replace(description, excluded=left_out))


def _holds(what: Description | None) -> bool:
    return what is not None and what.noun in ("container", "area")


def with_noun(description: Description, before: Description | None) -> Description:
    """A description whose "one" is of the kind said before it; an object where none was."""
    full = description
    if description.name == ONE:
        named = before is not None and before.like is None and before.name not in ("free", "table", ONE)
        kind = before if named and before is not None else Description(noun=description.noun, text="")
        full = replace(description, noun=kind.noun, name=kind.name, shape=description.shape or kind.shape)
    related = tuple(replace(item, to=tuple(with_noun(to, full) for to in item.to)) for item in full.related)
    excluded = tuple(with_noun(item, full) for item in full.excluded)
    whole = replace(full, related=related, excluded=excluded)
    return description if whole == description else worded(whole)


def _excepted(command: Command) -> Command:
    """An exception said last ("put all blocks into the box except the red one") is from the many, not from the box."""
    to = command.to
    if to is None or to.what is None or not to.what.excluded or command.thing.quantity == "one":
        return command
    thing = replace(command.thing, excluded=(*command.thing.excluded, *to.what.excluded))
    what = replace(to.what, excluded=())
    what, thing = (worded(item) for item in (what, thing))
    return replace(command, thing=thing, to=replace(to, what=what))
