"""What an instruction (or a subgoal) comes to in this picture: one aim per thing moved, with who is meant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from wonderful_team.offline.description import LINE_BY_LINE, Description
from wonderful_team.offline.eyes import (
    GOOD,
    NEARLY_EQUAL,
    PICTURE_SIDES,
    Eyes,
    as_pictured,
    is_rim,
    is_shown_alone,
    one_of,
    seen_as,
    side_words,
    told_apart,
    unique_words,
)
from wonderful_team.offline.goals.aims import Aim, Aims, Named
from wonderful_team.offline.goals.clearing import closed_by, leaving_first
from wonderful_team.offline.goals.handling import handled_aims
from wonderful_team.offline.goals.ranking import ranked_aims
from wonderful_team.offline.goals.showing import shown_aims
from wonderful_team.offline.goals.sweeps import swept_aims
from wonderful_team.offline.language import Command, Destination, Understood, describe, render, worded
from wonderful_team.offline.vision import Match, Thing
from wonderful_team.offline.vision.kinds import part_on
from wonderful_team.offline.vision.relations import OUTER, is_at, superlative_keys

RIVAL = 0.6
"""A second match with at least this share of the best score could be taken for it."""
LARGER = 1.3
"""A thing goes into another that is at least so many times its area."""
ASIDE = 0.25
"""One thing lies clearly further left (right, up, down) than another from this share of its width on."""
AS_LARGE = 0.05
"""Things that differ by a smaller share are as large, tall or dark as each other."""
SOLID = ("block", "letter", "fruit", "ball")
"""Kinds that hold nothing."""
HOLDERS = ("container", "area")
"""Kinds that are larger than what goes onto them."""


def derive(understood: Understood, eyes: Eyes, *, strict: bool = True, literal: bool = False) -> Aims:
    """Instantiate commands in a picture.

    Args:
        understood: The words, read.
        eyes: The picture.
        strict: Ask when two things fit equally; else take the better one.
        literal: Keep aims that the picture shows as reached already.
    """
    result = Aims(literal=literal, said=understood.said)
    moved: dict[int, int] = {}
    stay = frozenset(number for what in understood.spared for number in _numbers(what, eyes, result))
    for command in understood.commands:
        first = len(result.aims)
        aims = leaving_first(_of_command(command, eyes, result, strict), eyes)
        kept = command.off or command.limit
        if kept is not None and aims and not any(aim.off or aim.limit for aim in aims):
            result.absent.append(f"no way is known there that keeps off the {kept.text}")
        for aim in aims:
            if aim.thing.number in stay:
                result.notes.append(f"{aim.thing.words} stays where it is, as asked")
                continue
            after = set(aim.after)
            if command.after_last and first:
                after.add(first - 1)
            if aim.thing.number is not None:
                twin = next((prior for prior in result.aims[:first] if prior.same(aim)), None)
                if twin is not None and twin.thing.words != aim.thing.words and command.thing.quantity == "one":
                    result.absent.append(f"the {twin.thing.words} and the {aim.thing.words} are one and the same thing")
                if aim.thing.number in moved:
                    after.add(moved[aim.thing.number])
                moved[aim.thing.number] = len(result.aims)
            result.aims.append(replace(aim, after=tuple(sorted(after))))
        if result.question:
            break
    return result


def _numbers(description: Description, eyes: Eyes, result: Aims) -> list[int]:
    """Numbers of the things that a description means."""
    found = [match.thing.number for match in eyes.find(one_of(description)) if match.thing is not None]
    if not found:
        result.misses(description, eyes)
    return found[:1] if description.quantity == "one" else found


def _of_command(command: Command, eyes: Eyes, result: Aims, strict: bool) -> list[Aim]:
    if command.kind == "arrange" or command.kind == "follow" or command.kind == "restore":  # noqa: PLR1714  narrows the type
        return shown_aims(command, eyes, result)
    goal = command.to
    into = goal is not None and goal.how == "in" and goal.what is not None
    # What goes into something is smaller than it: that settles words which fit both.
    place = eyes.best(one_of(goal.what)) if into and goal is not None and goal.what is not None else None
    pushed = command.kind == "push" and into
    things = _things(command.thing, eyes, result, strict, place.thing if place is not None else None, every=pushed)
    if command.kind not in ("put", "push"):
        return _in_place(command, things, eyes, result)
    assert goal is not None  # the grammar gives every put and push a goal
    if goal.how in ("matching", "ranked"):
        return _told_by_things(command, goal, things, eyes, result)
    if pushed and goal.what is not None:
        aims = swept_aims(command, goal.what, things, eyes, result)
        if aims is not None:
            return aims
        things = things[: command.thing.number] if command.thing.quantity == "number" else things
    if goal.what is not None and command.conditional and not eyes.find(one_of(goal.what)):
        result.notes.append(f"there is no {render(one_of(goal.what))}")
        return []
    to, other = _places(goal, command.thing, things, eyes, result, strict)
    aims = []
    for thing in things:
        if to is not None and command.thing.quantity != "one" and thing.number == to.number:
            continue
        moved_before = any(aim.thing.number == thing.number for aim in result.aims if thing.number is not None)
        if to is not None and goal.how in ("in", "on"):
            if goal.how == "in" and not _holds(eyes.thing(to.number), eyes.thing(thing.number), goal.what):
                result.absent.append(f"the {to.words} holds no {thing.words}")
            if not (result.literal or moved_before) and already(eyes, thing, to):
                result.settled.append(f"{thing.words} is already {goal.how} {to.words}")
                continue
        aims.append(Aim(command.kind, thing, goal.how, to, other, goal.side))
    return aims


def _in_place(command: Command, things: list[Named], eyes: Eyes, result: Aims) -> list[Aim]:
    """What is done to things where they are."""
    if command.kind == "rotate":
        return [Aim("rotate", thing, rotate_deg=command.rotate_deg) for thing in things]
    return handled_aims(command, things, eyes, result)


def _told_by_things(command: Command, goal: Destination, things: list[Named], eyes: Eyes, result: Aims) -> list[Aim]:
    """Where things go that are told their places by what they look like, or by the prices beside them."""
    assert goal.what is not None  # the grammar gives both a kind of thing
    if goal.how == "ranked":
        return ranked_aims(things, goal.what, goal.side == "descending", eyes, result)
    return [aim for thing in things for aim in _matching_aim(command, goal, thing, eyes, result)]


def _holds(holder: Thing | None, thing: Thing | None, said: Description | None) -> bool:
    """Whether a thing goes into another: into a block, letter or fruit nothing does, into others what is clearly smaller."""
    if said is not None and said.noun in SOLID and not said.like:
        return False
    if holder is None or thing is None or holder.flat or is_rim(holder):
        return True
    return holder.area_px > LARGER * thing.area_px


def _places(
    goal: Destination, moved: Description, things: list[Named], eyes: Eyes, result: Aims, strict: bool
) -> tuple[Named | None, Named | None]:
    """The references of a destination; what is moved cannot be one, and what goes into something is smaller than it."""
    if goal.how == "side" and not eyes.find(spot := describe(f"free area {side_words(goal.side)}")):
        result.misses(spot, eyes)
    taken = frozenset(item.number for item in things if item.number is not None and moved.quantity == "one")
    fits = goal.how == "in" or (goal.how == "on" and goal.what is not None and goal.what.noun in HOLDERS)
    held = eyes.thing(things[0].number) if len(things) == 1 and fits else None
    to = None if goal.what is None else _one(goal.what, eyes, result, strict, taken=taken, holds=held)
    shut = closed_by(eyes.thing(to.number), eyes) if goal.how == "in" and to is not None else None
    if to is not None and shut is not None and part_on(shut, eyes.scene) is None:
        said = f"the {to.words} is closed: it shows no opening, and the {seen_as(eyes, shut)} stands on what covers it"
        said += "; no way is known to open it"
        result.absent += [] if said in result.absent else [said]
    return to, None if goal.other is None else _one(goal.other, eyes, result, strict, taken=taken)


def _things(
    description: Description, eyes: Eyes, result: Aims, strict: bool, place: Thing | None, *, every: bool = False
) -> list[Named]:
    """The things that a description means; `every`: all that it fits, however many are asked for."""
    if description.quantity == "one":
        return [_one(description, eyes, result, strict, fits_in=place)]
    wanted = description if description.quantity == "all" else replace(description, quantity="all")
    order = wanted.superlative if description.quantity == "number" and description.number > 1 else None
    if order is not None:
        wanted = replace(wanted, superlative=None)
    left_out = {number for item in description.excluded for number in _numbers(item, eyes, result)}
    matches = [match for match in eyes.find(wanted) if match.thing is not None and match.thing.number not in left_out]
    matches.sort(key=lambda match: match.box.x0)
    if order is not None:
        keys = superlative_keys([match.thing for match in matches if match.thing is not None], order)
        matches = [match for _, match in sorted(zip(keys, matches, strict=True), key=lambda pair: pair[0])]
    if place is not None:
        # What goes into something is neither that thing itself nor larger than it.
        matches = [m for m in matches if m.thing is not None and m.thing.number != place.number] or matches
    result.absent += _miscounted(description, len(matches))
    if description.quantity == "number" and not every:
        matches = matches[: description.number]
    if not matches:
        result.misses(description, eyes)
    noun = description.noun if description.noun != "thing" else "object"
    named = [
        Named(unique_words(eyes, match.thing, noun, description.name, description.shape), match.thing.number)
        for match in matches
        if match.thing is not None  # always: filtered above
    ]
    told_apart = len({item.words for item in named})
    if told_apart < len(named):
        result.absent.append(
            f"{len(named)} things fit '{description.text}', but words tell only {told_apart} of them apart"
        )
    return named


def _miscounted(description: Description, count: int) -> Iterator[str]:
    """Where the picture shows things that fit, but not as many as the words say."""
    if 0 < count < description.number:
        yield f"{description.number} are asked for, but only {count} fit '{description.text}'"
    elif count == 1 and description.plural and description.noun not in ("object", "thing"):
        yield f"several are spoken of, but only one fits '{description.text}'"
    elif description.quantity == "all" and 1 < description.number < count:
        yield f"'both' is said of {count} things that fit '{description.text}'"


def _one(
    description: Description,
    eyes: Eyes,
    result: Aims,
    strict: bool,
    *,
    taken: frozenset[int] = frozenset(),
    holds: Thing | None = None,
    fits_in: Thing | None = None,
) -> Named:
    """Who is meant by a description of one thing.

    Args:
        description: The words.
        eyes: The picture.
        result: Takes the question when the words do not settle it.
        strict: Whether to ask.
        taken: Numbers of things that cannot be meant, since they are what is moved.
        holds: The thing that is to go into it: of several that fit, one that is larger.
        fits_in: The thing it is to go into: of several that fit, one that is smaller.
    """
    single = worded(one_of(description))
    everything = eyes.find(single)
    taken |= {number for item in description.excluded for number in _numbers(item, eyes, result)}
    matches = [match for match in everything if match.thing is None or match.thing.number not in taken]
    matches = as_pictured(single, matches, eyes)
    if holds is not None and single.noun in HOLDERS:
        matches = [m for m in matches if m.thing is None or m.thing.area_px > LARGER * holds.area_px]
    if matches and matches[0].thing is not None:
        result.absent += _presumed(single, description.number, matches[0], eyes)
    equal = _equal(single, matches)
    if len(equal) > 1:
        equal = _by_size(equal, holds, fits_in) or equal
    if len(equal) > 1:
        equal = _as_answered(single, equal, eyes, result.said) or equal
    if strict and not result.question and len(equal) > 1:
        result.question = f"Which one is meant by 'the {single.text}'? {len(equal)} things fit equally well."
        result.choices = tuple(_choices(single, equal, eyes))
    best = equal[0] if equal else next(iter(matches), None)
    if best is None:
        result.misses(single, eyes)
    if best is None or best.thing is None:
        return Named(single, None)
    if is_shown_alone(single) and (seen := seen_as(eyes, best.thing)):
        return Named(replace(single, text=seen), best.thing.number)
    plain = not (single.superlative or single.like or single.related)
    from_side = single.superlative in ("tallest", "shortest") and best.thing.height_m is None
    rivalled = plain and len(equal) == 1 and len(everything) > 1 and _rivalled(everything)
    if from_side or best is not everything[0] or rivalled or single.excluded:
        # The words alone lead elsewhere or could: say it so that they do not.
        return Named(unique_words(eyes, best.thing, single.noun, single.name, single.shape), best.thing.number)
    return Named(single, best.thing.number)


def _presumed(description: Description, number: int, chosen: Match, eyes: Eyes) -> Iterator[str]:
    """What words presume of the one that they pick, where the picture shows otherwise.

    That there are so many to pick from, that the only one lies at that side, that one is clearly the largest.
    """
    compared, wish = replace(description, superlative=None, ordinal=1), description.superlative
    fits = [match.thing for match in eyes.find(compared) if match.thing is not None]
    if len(fits) < number:
        yield f"{number} are spoken of, but only {len(fits)} fit '{render(compared)}'"
    elif wish in PICTURE_SIDES and len(fits) == 1 and " " not in description.name:
        if not is_at(eyes.scene, chosen.point, wish, OUTER if wish == "middle" else 1 / 2):
            yield f"the {render(compared)} is not {side_words(wish)}"
    elif (
        wish not in (None, "middle", "nearest", *LINE_BY_LINE)
        and " " not in description.name
        and len(fits) > description.ordinal
    ):
        assert wish is not None  # ruled out just now
        first, second = sorted(superlative_keys(fits, wish))[description.ordinal - 1 :][:2]
        least = ASIDE * chosen.box.width if wish in PICTURE_SIDES else AS_LARGE * max(abs(first), abs(second))
        if abs(first - second) < least:
            yield f"no {render(compared)} is clearly the {wish} of {len(fits)}"


def _rivalled(matches: list[Match]) -> bool:
    """Whether the second best fits nearly as well: where relations do not show, as in a crop, it could be taken."""
    return matches[1].thing is not None and matches[1].score >= RIVAL * matches[0].score


def _equal(description: Description, matches: list[Match]) -> list[Match]:
    """The matches between which the words do not decide; at most one when they do."""
    if not matches or matches[0].thing is None:
        return []
    if description.superlative or description.like or description.related:
        return matches[:1]
    return [
        match
        for match in matches
        if match.thing is not None and match.score >= GOOD and matches[0].score - match.score < NEARLY_EQUAL
    ]


def _by_size(equal: list[Match], holds: Thing | None, fits_in: Thing | None) -> list[Match]:
    """Those that are larger than what they are to hold, or else smaller than what they go into."""
    sizes = [(match, match.thing.area_px) for match in equal if match.thing is not None and match.thing is not fits_in]
    if holds is not None:
        return [match for match, size in sizes if size > LARGER * holds.area_px]
    return [match for match, size in sizes if fits_in is not None and LARGER * size < fits_in.area_px]


def _as_answered(description: Description, equal: list[Match], eyes: Eyes, said: tuple[str, ...]) -> list[Match]:
    """The match that the user named when asked, word for word; none where nobody did."""
    choices = _choices(description, equal, eyes)
    return [
        match
        for match, choice in zip(equal, choices, strict=True)
        if any(line.endswith(f": {choice}") for line in said) and choices.count(choice) == 1
    ]


def _choices(description: Description, equal: list[Match], eyes: Eyes) -> list[str]:
    return [
        told_apart(eyes, match.thing, description.noun, description.name, description.shape)
        for match in equal
        if match.thing is not None  # always: filtered by _equal
    ]


def _matching_aim(command: Command, goal: Destination, thing: Named, eyes: Eyes, result: Aims) -> list[Aim]:
    """The thing goes to the one of that kind which shares its colour (texture, shape); none, or there already: no aim."""
    seen = eyes.thing(thing.number)
    assert goal.what is not None  # the grammar gives matching a kind of thing
    if seen is None:
        return []
    wanted = _sharing(one_of(goal.what), goal.aspect or "colour", seen)
    matches = [match for match in eyes.find(wanted) if match.thing is not None and match.thing.number != seen.number]
    if not matches or matches[0].score < GOOD:
        result.notes.append(f"there is no {render(wanted)} for the {thing.words}")
        return []
    there = matches[0].thing
    assert there is not None  # filtered above
    to = Named(worded(wanted), there.number)
    if not result.literal and already(eyes, thing, to):
        result.settled.append(f"the {thing.words} is already in the {to.words}")
        return []
    return [Aim("push" if command.kind == "push" else "put", thing, "in", to)]


def _sharing(kind: Description, aspect: str, thing: Thing) -> Description:
    if aspect == "colour":
        return replace(kind, colours=(thing.look.colours[0].name,))
    if aspect == "texture":
        return replace(kind, colours=tuple(share.name for share in thing.look.colours[:2]), pattern=thing.look.pattern)
    return replace(kind, shape=thing.look.shape)


def already(eyes: Eyes, thing: Named, to: Named) -> bool:
    """Whether the picture shows the thing in or on its destination."""
    inner, outer = eyes.thing(thing.number), eyes.thing(to.number)
    if inner is None or outer is None or inner.number == outer.number:
        return False
    return inner.on == outer.number or (outer.area_px > inner.area_px and outer.covers(inner.centre))
