"""What stands in the way of an aim: things that lie on the thing to be moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.offline.description import FREE
from wonderful_team.offline.eyes import Eyes
from wonderful_team.offline.goals.aims import Aim, Named, seen_named
from wonderful_team.offline.vision import Thing

LOWER_M = 0.002
"""What is lower than a thing by more than this does not lie on it [m]."""
SAME_COLOURS = 0.6
"""Likeness of colours from which two patches belong to one thing (0 to 1)."""


def _shows_through(upper: Thing, thing: Thing, eyes: Eyes) -> bool:
    """Whether a patch within a thing's outline is what the thing lies on or in, seen through a hole in it."""
    if upper.height_m is not None and thing.height_m is not None and upper.height_m < thing.height_m - LOWER_M:
        return True
    host = eyes.thing(thing.on)
    return host is not None and float(host.look.histogram @ upper.look.histogram) > SAME_COLOURS


def obstacles(aim: Aim, others: Sequence[Aim], eyes: Eyes) -> list[Aim]:
    """Aims that bring away what lies on the thing to be moved; what another aim moves anyway is left to it.

    Only where the picture has depth or the thing is no container: what lies in a container travels with it.
    """
    thing = eyes.thing(aim.thing.number)
    if thing is None or thing.flat or aim.thing.description.noun in ("container", "area"):
        return []
    elsewhere = {other.thing.number for other in others}
    return [
        out_of_the_way(upper, eyes, f"it lies on the {aim.thing.words}")
        for upper in eyes.scene.on(thing)
        if upper.area_px <= thing.area_px and upper.number not in elsewhere and not _shows_through(upper, thing, eyes)
    ]


def out_of_the_way(thing: Thing, eyes: Eyes, why: str) -> Aim:
    """Bring a thing onto free table."""
    return Aim("put", seen_named(eyes, thing), "in", Named(FREE), why=why)


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
