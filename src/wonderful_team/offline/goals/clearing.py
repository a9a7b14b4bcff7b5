"""What stands in the way of an aim: things that lie on the thing to be moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wonderful_team.offline.description import FREE, ROOMY
from wonderful_team.offline.eyes import Eyes
from wonderful_team.offline.goals.aims import Aim, Named, seen_named
from wonderful_team.offline.vision import Thing
from wonderful_team.offline.vision.kinds import is_kind_here, part_on
from wonderful_team.offline.vision.table import height_above_table

LOWER_M = 0.002
"""What is lower than a thing by more than this does not lie on it [m]."""
SAME_COLOURS = 0.6
"""Likeness of colours from which two patches belong to one thing (0 to 1)."""

CARRIES = ("container", "area", "bottle", "lid", "cap")
"""Kinds of things that what lies on them goes with."""
DEEP_M, HOLLOW_M, HOLLOW_SHARE = 0.03, 0.012, 0.05
"""A container is at least so high; where it is open, at least this share of its middle lies so far below its top [m]."""


def _shows_through(upper: Thing, thing: Thing, eyes: Eyes) -> bool:
    """Whether a patch within a thing's outline is what the thing lies on or in, seen through a hole in it."""
    if upper.height_m is not None and thing.height_m is not None and upper.height_m < thing.height_m - LOWER_M:
        return True
    host = eyes.thing(thing.on)
    return host is not None and float(host.look.histogram @ upper.look.histogram) > SAME_COLOURS


def is_of_one_piece(part: Thing, thing: Thing) -> bool:
    """Whether what stands up from a thing has its colours: a neck, a handle."""
    return float(part.look.histogram @ thing.look.histogram) > SAME_COLOURS


def obstacles(aim: Aim, others: Sequence[Aim], eyes: Eyes) -> list[Aim]:
    """Aims that bring away what lies on the thing to be moved, or closes what it goes into; what another aim moves anyway is left to it.

    Only where the picture has depth or the thing is no container: what lies in a container travels with it, as what is on a
    bottle or lid does.
    """
    elsewhere = {other.thing.number for other in others}
    shut = closed_by(eyes.thing(aim.to.number), eyes) if aim.how == "in" and aim.to is not None else None
    if shut is not None:
        own = shut.number in elsewhere or shut.number == aim.thing.number or part_on(shut, eyes.scene) is None
        assert aim.to is not None  # it has just been looked at
        return [] if own else [out_of_the_way(shut, eyes, f"it closes the {aim.to.words}", "lid")]
    thing = eyes.thing(aim.thing.number)
    if thing is None or thing.flat or aim.kind == "trace" or aim.thing.description.noun in CARRIES:
        return []
    return [
        out_of_the_way(upper, eyes, f"it lies on the {aim.thing.words}")
        for upper in eyes.scene.on(thing)
        if upper.area_px <= thing.area_px and upper.number not in elsewhere and not _shows_through(upper, thing, eyes)
    ]


def closed_by(holder: Thing | None, eyes: Eyes) -> Thing | None:
    """What stands on a thing that should be open there: a lid, or whatever stands on its middle where no hollow shows; None where it may be open.

    A thing in an open container stands lower than what closes one: round it the container's floor shows. A lid, told by its
    handle, is no load wherever it lies: askew in the opening, or over the edge. Only depth tells.
    """
    depth = eyes.looked_at.depth_m
    if holder is None or holder.height_m is None or holder.height_m < DEEP_M or depth is None:
        return None
    for one in eyes.scene.on(holder):
        if is_kind_here(one, "lid", eyes.scene):
            return one
    uppers = [one for one in eyes.scene.on(holder) if one.box.contains(holder.box.centre)]
    heights = height_above_table(depth, np.isfinite(depth))
    if not uppers or heights is None:
        return None
    middle = holder.box.scaled(0.5)
    inside = heights[round(middle.y0) : round(middle.y1) + 1, round(middle.x0) : round(middle.x1) + 1]
    known = inside[np.isfinite(inside)]
    hollow = float((known < holder.height_m - HOLLOW_M).mean()) if known.size else 1.0
    return uppers[0] if hollow < HOLLOW_SHARE else None


def out_of_the_way(thing: Thing, eyes: Eyes, why: str, noun: str = "object") -> Aim:
    """Bring a thing onto free table."""
    return Aim("put", seen_named(eyes, thing, noun), "in", Named(ROOMY if noun == "lid" else FREE), why=why)


def cleared(aims: Sequence[Aim], eyes: Eyes) -> list[Aim]:
    """The aims, with things that lie on what is to be moved brought away first."""
    done: list[Aim] = []
    shift: dict[int, int] = {}
    for position, aim in enumerate(aims):
        firsts = []
        for away in obstacles(aim, [*done, *aims[position + 1 :]], eyes):
            firsts.append(len(done))
            done.append(away)
        shift[position] = len(done)
        done.append(replace(aim, after=tuple(sorted({shift[index] for index in aim.after} | set(firsts)))))
    return done


def leaving_first(aims: list[Aim], eyes: Eyes) -> list[Aim]:
    """Aims of one command, in an order in which what leaves a place does so before another thing goes there.

    The order stays where it was asked for, and where two change places.
    """
    if any(aim.after for aim in aims):
        return aims
    goals = [None if aim.to is None else aim.to.number for aim in aims]
    stands = [None if (thing := eyes.thing(aim.thing.number)) is None else thing.on for aim in aims]
    waiting, ordered = list(range(len(aims))), []
    while waiting:
        # What lies where it is to go already does not leave.
        leaving = {stands[k] for k in waiting if stands[k] != goals[k]} - {None}
        ready = next((k for k in waiting if goals[k] not in leaving - {stands[k]}), waiting[0])
        waiting.remove(ready)
        ordered.append(aims[ready])
    return ordered
