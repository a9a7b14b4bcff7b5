"""Steps in words, as models read them: one step in one line."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from wonderful_team.core.actions import At, Beside, OriginOf, Place, Step

_BESIDE = {"left": "to the left of", "right": "to the right of", "above": "above (in the picture)", "below": "below"}
_HEIGHTS = {"above": "just above", "at": "down to", "clear": "clear of everything over"}


def place_words(place: Place) -> str:
    """A place in words."""
    match place:
        case At():
            return place.target
        case Beside():
            return f"the spot {_BESIDE[place.side]} {place.target}"
        case OriginOf():
            return f"where {place.target} stood at the start"


def turn_words(rotate_deg: float) -> str:
    """A turn in words: degrees, clockwise or anticlockwise seen from above."""
    return f"{abs(rotate_deg):g} degrees {'clockwise' if rotate_deg >= 0 else 'anticlockwise'}"


def step_words(step: Step) -> str:
    """One step in one line, with the subgoal that it serves."""
    said = {item.name: _field_words(item.name, getattr(step, item.name)) for item in fields(step)}
    turn = getattr(step, "rotate_deg", 0.0)
    return f"[{step.subgoal}] {step.words.told}".format(**said, turned=f", turned {turn_words(turn)}" if turn else "")


def _field_words(name: str, value: Any) -> str:
    match name:
        case "rotate_deg":
            return turn_words(value)
        case "height":
            return _HEIGHTS[value]
        case "contact":
            return {"surface": ", touching the surface", "air": ", in the air", None: ""}[value]
        case "tight":
            return " and keep squeezing" if value else ""
    return value if isinstance(value, str) else place_words(value)
