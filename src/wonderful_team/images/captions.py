"""Words for what depends on the unit of a picture's numbers: its size and its tick labels.

Agents write them in pixels; a provider whose model counts otherwise writes the same words in that unit.
"""

from __future__ import annotations

from wonderful_team.core.pictures import Axes
from wonderful_team.images.axes import Ticks

_UNIT_WORDS = {
    Ticks.PIXELS: "pixels",
    Ticks.THOUSANDTHS: "thousandths of width and height (0 to 1000)",
    Ticks.PERCENT: "percent of width and height (0 to 100)",
    Ticks.UNIT: "shares of width and height (0 to 1)",
}


def size_words(size_px: tuple[int, int]) -> str:
    """A picture's size in words."""
    return f"{size_px[0]} x {size_px[1]} px"


def axes_words(axes: Axes, ticks: Ticks = Ticks.PIXELS, whose: str = "the main view's picture") -> str:
    """What the tick labels along a picture's edges mean."""
    if axes.reference is not None:
        return f"tick labels along the edges, in {_UNIT_WORDS[ticks]} of {whose}"
    if ticks is Ticks.PIXELS:
        return "tick labels in its own pixels along the edges"
    return f"tick labels along the edges, in {_UNIT_WORDS[ticks]}"
