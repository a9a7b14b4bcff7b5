"""What the instruction's pictures of a whole table show: where things should be, and which thing moves where.

Pictures of one camera share its framing: a pixel of the camera's view means the same place in every one of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import Eyes, unique_words
from wonderful_team.offline.goals.aims import Aim, Aims, Named, seen_named
from wonderful_team.offline.goals.clearing import out_of_the_way
from wonderful_team.offline.language import Command, worded
from wonderful_team.offline.vision import Thing, likeness, see
from wonderful_team.offline.vision.changes import LEFT, STAYED, came_to, difference, gap_px, moved_between

ALIKE = 0.35
"""Least likeness of looks at which two pictures may show the same thing (0 to 1)."""
IN_THE_WAY = 0.8
"""Two things whose centres are nearer than this share of their radii together cannot both lie there."""


@dataclass(frozen=True, eq=False)
class Shift:
    """A thing of the scene now, and where a picture shows it [px of the picture looked at]."""

    thing: Thing
    to: Point
    placed: Description
    like: str
    since: str | None = None


def shown_aims(command: Command, eyes: Eyes, result: Aims) -> list[Aim]:
    """Aims of a goal picture, of a sequence of frames, or of "and then restore".

    Raises:
        NotUnderstoodError: The pictures were not given, or do not show what is moved.
    """
    missing = [name for name in command.pictures if name not in eyes.pictures]
    if missing:
        raise NotUnderstoodError(
            f"the instruction speaks of {{{missing[0]}}}, but no such picture of the table was given"
        )
    if command.kind == "restore":
        return _restored(result)
    if command.kind == "follow":
        return _followed(command, eyes, result)
    return [aim for name in command.pictures for aim in _arranged(name, eyes, result)]


def _restored(result: Aims) -> list[Aim]:
    """Everything that was asked to be moved goes back, the last one first; what was only in the way may stay."""
    wanted = [aim.thing for aim in result.aims if not aim.why and aim.kind != "rotate"]
    back: dict[int | None, Named] = {}
    for thing in reversed(wanted):
        back.setdefault(thing.number, thing)
    if not back:
        raise NotUnderstoodError("it is not said what is to be restored: nothing is moved before")
    return [Aim("put", thing, "origin", after=tuple(range(len(result.aims)))) for thing in back.values()]


def _arranged(name: str, eyes: Eyes, result: Aims) -> list[Aim]:
    """Every thing that a picture shows goes to where it is there; what lies on such a place is brought away first."""
    shifts = _shifts(name, eyes)
    moves = [
        shift
        for shift in shifts
        if gap_px(shift.to, shift.thing.centre) > STAYED * shift.thing.radius_px or result.literal
    ]
    result.settled += [
        f"the {shift.placed.text} is where {{{name}}} shows it" for shift in shifts if shift not in moves
    ]
    ordered = _in_free_order(moves)
    first = len(result.aims)
    known = {shift.thing.number for shift in shifts}
    aims: list[Aim] = []
    for other in eyes.scene.objects:
        blocked = [shift for shift in moves if other.number not in known and _blocks(other, shift)]
        if blocked:
            aims.append(out_of_the_way(other, eyes, f"it lies where the {blocked[0].placed.text} goes"))
    cleared = tuple(range(first, first + len(aims)))
    for shift in ordered:
        aims.append(Aim("put", seen_named(eyes, shift.thing), "in", Named(_place(shift)), after=cleared))
    return aims


def _place(shift: Shift) -> Description:
    return worded(Description(noun="area", text="", placed=shift.placed, like=shift.like, since=shift.since))


def _shifts(name: str, eyes: Eyes) -> list[Shift]:
    """The things of a picture paired with those of now by their looks, the surest pair first."""
    shown = eyes.pictures[name]
    there = Eyes(shown)
    pairs = sorted(
        ((likeness(one, other), k, one) for k, other in enumerate(there.scene.things) for one in eyes.scene.things),
        key=lambda pair: -pair[0],
    )
    taken: set[int] = set()
    given: set[int] = set()
    shifts = []
    for score, k, one in pairs:
        if score < ALIKE or k in given or one.number in taken:
            continue
        given.add(k)
        taken.add(one.number)
        seen = there.scene.things[k]
        to = eyes.here(shown, seen.centre)
        shifts.append(Shift(one, to, unique_words(there, seen, "object"), name))
    if not shifts:
        raise NotUnderstoodError(f"none of the things that {{{name}}} shows is in the picture")
    return sorted(shifts, key=lambda shift: shift.thing.centre)


def _blocks(other: Thing, shift: Shift) -> bool:
    return gap_px(other.centre, shift.to) < IN_THE_WAY * (other.radius_px + shift.thing.radius_px)


def _in_free_order(moves: list[Shift]) -> list[Shift]:
    """What stands on another's place goes first."""
    left, done = list(moves), []
    while left:
        free = [
            shift for shift in left if not any(other is not shift and _blocks(other.thing, shift) for other in left)
        ]
        done.append((free or left)[0])
        left.remove(done[-1])
    return done


def _followed(command: Command, eyes: Eyes, result: Aims) -> list[Aim]:
    """One move between each frame and the next, in order."""
    frames = [eyes.pictures[name] for name in command.pictures]
    named = None
    if command.thing.quantity == "one":
        best = eyes.best(command.thing)
        named = None if best is None else best.thing
    first = len(result.aims)
    aims: list[Aim] = []
    where: dict[int, Point] = {}
    for k in range(1, len(frames)):
        arrived = came_to(frames[k - 1], frames[k])
        mover = _mover(frames[k - 1], frames[k], eyes, where, named)
        if arrived is None or mover is None:
            if difference(frames[k - 1], frames[k]).any():
                raise NotUnderstoodError(
                    f"it does not show what moves between {{{command.pictures[k - 1]}}} and {{{command.pictures[k]}}}"
                )
            continue
        to = eyes.here(frames[k], arrived.centre)
        who = seen_named(eyes, mover)
        shift = Shift(mover, to, who.description, command.pictures[k], command.pictures[k - 1])
        if named is not None and mover.number == named.number:
            who = Named(command.thing, mover.number)
        after = (first + len(aims) - 1,) if aims else ()
        under = _under(to, mover, eyes, where, aims)
        how, place = ("in", Named(_place(shift))) if under is None else ("on", under)
        aims.append(Aim("put", who, how, place, after=after))
        where[mover.number] = to
    return aims


def _under(to: Point, mover: Thing, eyes: Eyes, where: dict[int, Point], aims: list[Aim]) -> Named | None:
    """The thing that lies where something is put: what was put there last, else what has stood there."""
    for aim in reversed(aims):
        number = aim.thing.number
        if number is not None and number != mover.number and number in where:
            thing = eyes.thing(number)
            if thing is not None and gap_px(where[number], to) < 0.6 * thing.radius_px:
                return aim.thing
    there = [thing for thing in eyes.scene.things if thing.number not in (mover.number, *where)]
    under = next((thing for thing in there if gap_px(thing.centre, to) < 0.6 * thing.radius_px), None)
    return None if under is None else seen_named(eyes, under)


def _mover(before: Picture, after: Picture, eyes: Eyes, where: dict[int, Point], named: Thing | None) -> Thing | None:
    """The thing of now that moved between two frames: it looks like that, and is where that was."""
    pair = moved_between(before, after)
    if pair is None:
        return _left_its_place(before, after, eyes, where, named)
    place = eyes.here(before, pair[0].centre)

    def fits(thing: Thing) -> float:
        away = gap_px(where.get(thing.number, thing.centre), place) / thing.radius_px
        bonus = 0.1 if named is not None and thing.number == named.number else 0.0
        return likeness(thing, pair[1]) * float(np.exp(-0.5 * away**2)) + bonus

    best = max(eyes.scene.things, key=fits, default=None)
    return best if best is not None and fits(best) > ALIKE else _left_its_place(before, after, eyes, where, named)


def _left_its_place(
    before: Picture, after: Picture, eyes: Eyes, where: dict[int, Point], named: Thing | None
) -> Thing | None:
    """The thing of now whose place in the earlier frame shows table in the later one."""
    changed = difference(before, after)
    scene = see(after)
    table = ~scene.occupied
    best, most = None, LEFT
    grid = cv2.resize(changed.astype(np.uint8), table.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    for thing in eyes.scene.things:
        x, y = where.get(thing.number, thing.centre)
        points = _points(thing, (x - thing.centre[0], y - thing.centre[1]))
        pixels = (after.frame.to_picture(eyes.looked_at.frame.to_view(points)) / scene.zoom).astype(int)
        inside = (pixels >= 0).all(axis=1) & (pixels[:, 0] < table.shape[1]) & (pixels[:, 1] < table.shape[0])
        pixels = pixels[inside]
        if not len(pixels):
            continue
        left = float((table & grid)[pixels[:, 1], pixels[:, 0]].mean())
        if named is not None and thing.number == named.number:
            left += 0.1
        if left > most:
            best, most = thing, left
    return best


def _points(thing: Thing, move: Point) -> Array:
    """Pixels of what shows of a thing, moved [picture px], shape (N, 2)."""
    rows, columns = np.nonzero(thing.mask)
    x = (columns + 0.5 + thing.offset[0]) * thing.zoom + move[0]
    y = (rows + 0.5 + thing.offset[1]) * thing.zoom + move[1]
    return np.stack([x, y], axis=1)
