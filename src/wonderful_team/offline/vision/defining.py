"""What pictures that define a word show: how the first of each pair differs from the second, and by how much a thing is turned."""

from __future__ import annotations

import numpy as np

from wonderful_team.contracts import ShownSlot
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import OPPOSITE
from wonderful_team.offline.vision import Example, NotSeen, see, study_example
from wonderful_team.offline.vision.turning import common_turn_deg

_FEW = 0.06
"""Least mean difference of a measure, as a share of it, that defines an adjective."""


def compared(pairs: list[tuple[ShownSlot, ShownSlot]], word: str) -> str:
    """The superlative that tells the first of each pair from the second: by height, lightness or size."""
    gaps: dict[str, list[float]] = {"tallest": [], "lightest": [], "largest": []}
    for more, less in pairs:
        one, other = _measures(more), _measures(less)
        for name in gaps:
            gaps[name].append(float(np.log(one[name] / other[name])))
    means = {name: float(np.mean(values)) for name, values in gaps.items()}
    name = max(means, key=lambda key: abs(means[key]))
    if name == "tallest" and abs(means["largest"]) > 0.7 * abs(means["tallest"]):
        name = "largest"
    agree = all(np.sign(value) == np.sign(means[name]) for value in gaps[name])
    if abs(means[name]) < _FEW or not agree:
        told = ", ".join(f"{key} {value:+.2f}" for key, value in means.items())
        raise NotUnderstoodError(f"I do not know: {word}. The pictures do not show what it means (log ratios: {told}).")
    return name if means[name] > 0 else OPPOSITE[name]


def _measures(slot: ShownSlot) -> dict[str, float]:
    """How tall, light and large the thing of a picture shows itself; the height from the other camera when there is one."""
    try:
        example = study_example(slot.pictures[0])
        side = study_example(slot.pictures[-1])
    except NotSeen as error:
        raise NotUnderstoodError(
            f"the picture {{{slot.name}}} shows nothing that could define a word: {error}"
        ) from error
    return {
        "tallest": side.box.height / slot.pictures[-1].frame.scale if len(slot.pictures) > 1 else 1.0,
        "lightest": _lightness(example) + 1.0,
        "largest": float(np.sqrt(example.area_view_px)),
    }


def _lightness(example: Example) -> float:
    shares = sum(colour.share for colour in example.look.colours)
    return sum(colour.lab[0] * colour.share for colour in example.look.colours) / max(shares, 1e-6)


def turn_shown_deg(pairs: list[tuple[ShownSlot, ShownSlot]]) -> float:
    """The clockwise turn [degrees] that all pairs show."""
    seen = []
    for before, after in pairs:
        first, second = see(before.pictures[0]), see(after.pictures[0])
        if first.objects and second.objects:
            was = max(first.things, key=lambda thing: thing.area_px)
            now = max(second.things, key=lambda thing: thing.area_px)
            seen.append((before.pictures[0], was, after.pictures[0], now))
    turn = common_turn_deg(seen) if seen else None
    if turn is None:
        raise NotUnderstoodError("the pictures before and after do not show by how much something is turned")
    return turn if turn <= 180.0 else turn - 360.0
