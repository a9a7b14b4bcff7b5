"""Edge strips as pictures with captions, in the order left, top, right, bottom."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.agents.rendering import picture_parts, words
from wonderful_team.contracts import EDGES, Strip
from wonderful_team.core.values import Part


def strip_parts(strips: Sequence[Strip]) -> list[Part]:
    """Every strip, announced by its edge and side; strips that are missing are named."""
    parts: list[Part] = []
    for edge in EDGES:
        for side in ("inside", "outside"):
            found = [strip for strip in strips if (strip.edge, strip.side) == (edge, side)]
            for strip in found:
                parts += picture_parts(strip.picture, f"just {side} the {edge} edge of the box")
            if not found:
                parts += words(f"The strip just {side} the {edge} edge is missing.")
    return parts
