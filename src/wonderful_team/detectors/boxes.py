"""What a network says of a picture, as detections: boxes cut to the picture, what lies outside of it left out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Detection
from wonderful_team.errors import ConfigError

LEAST_PX = 1.0
"""A box whose part in the picture is narrower or lower shows nothing [px]."""


def detections(
    words: Iterable[str], boxes: Iterable[Sequence[float]], scores: Iterable[float], size_px: tuple[int, int]
) -> list[Detection]:
    """Detections out of parallel lists; boxes are (x0, y0, x1, y1) [px] and may reach beyond the picture."""
    view = Box(0, 0, *size_px)
    found = []
    for text, (x0, y0, x1, y1), score in zip(words, boxes, scores, strict=True):
        if not (x0 < x1 and y0 < y1):
            continue
        inside = Box(x0, y0, x1, y1).intersection(view)
        if inside is not None and min(inside.width, inside.height) >= LEAST_PX:
            found.append(Detection(text, inside, min(1.0, max(0.0, float(score)))))
    return found


def checked_share(name: str, value: float) -> float:
    """A threshold.

    Raises:
        ConfigError: It is not within 0 to 1.
    """
    if not 0.0 <= value <= 1.0:
        raise ConfigError(f"{name} {value!r}: valid is 0 to 1")
    return float(value)
