"""Edge strips as pictures with captions, in the order left, top, right, bottom: both sides of an edge in one picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wonderful_team.agents.rendering import picture_parts, words
from wonderful_team.contracts import EDGES, Edge, Strip
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Part
from wonderful_team.images import StripSide, across_edge

_OUTSIDE: dict[Edge, str] = {"left": "left of", "top": "above", "right": "right of", "bottom": "below"}


def strip_parts(strips: Sequence[Strip]) -> list[Part]:
    """What lies just inside and just outside each edge, announced by the edge; what is missing is named."""
    by_side = {(strip.edge, strip.side): strip.picture for strip in strips}
    return [part for edge in EDGES for part in _edge_parts(edge, by_side)]


def _edge_parts(edge: Edge, by_side: Mapping[tuple[Edge, StripSide], Picture]) -> list[Part]:
    inside, outside = by_side.get((edge, "inside")), by_side.get((edge, "outside"))
    both = None if inside is None or outside is None else across_edge(inside, outside, f"strip {edge}")
    if both is not None:
        return picture_parts(both, f"across the {edge} edge of the box; what lies {_OUTSIDE[edge]} the line is outside")
    parts: list[Part] = []
    for side, picture in (("inside", inside), ("outside", outside)):
        if picture is None:
            parts += words(f"The strip just {side} the {edge} edge is missing.")
        else:
            parts += picture_parts(picture, f"just {side} the {edge} edge of the box")
    return parts
