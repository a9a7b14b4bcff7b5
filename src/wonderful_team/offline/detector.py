"""The classical detector: `offline`'s eyes behind the protocol of detectors. No key, no weights, no network.

It finds things by their kind, colours, pattern, shape, size and place among the others, from pixels alone, and nothing else: words
that its grammar does not know are refused by name, free places are not things, and what is not there is not found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Detection, View
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.images import whole
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import Eyes, eyes_of
from wonderful_team.offline.language import describe
from wonderful_team.offline.language.tokens import OTHERS_MAY
from wonderful_team.offline.vision import Match, Thing, in_plain_light


class ClassicalDetector:
    """Classical vision and a grammar for noun phrases (`wonderful-team list words`)."""

    name = "classical"
    setting: Mapping[str, str] = {"weights": "none"}

    def detect(self, rgb: Array, words: Sequence[str]) -> tuple[Detection, ...]:
        """Everything that fits each description, with its outline as a mask.

        A score is how well a thing fits the words, 0.4 to 1: products of how well its parts (kind, colours, pattern, shape) fit.

        Raises:
            NotUnderstoodError: The words hold something it does not know; says which.
        """
        asked = [(text, described(text)) for text in words]
        eyes = eyes_at(np.asarray(rgb))
        return tuple(
            _detection(text, match, match.thing, rgb.shape[:2])
            for text, description in asked
            for match in eyes.find(description)
            if match.thing is not None
        )


def described(words: str) -> Description:
    """What words say of a thing. Raises NotUnderstoodError for words that it does not know, or that point to a picture."""
    try:
        description = describe(words)
    except NotUnderstoodError as error:
        # Who reads it asked a detector: another model is not the way out.
        said = str(error).removesuffix(OTHERS_MAY).strip()
        raise NotUnderstoodError(f"detector 'classical', {words!r}: {said}", stage="grounding") from error
    if description.like is not None:
        raise NotUnderstoodError(
            f"detector 'classical' reads words alone; {words!r} points to a picture", stage="grounding"
        )
    return description


def eyes_at(rgb: Array, plain_light: bool = True) -> Eyes:
    """What is seen in a picture by its pixels alone, as in plain light or in the light that it has."""
    # In the picture's own pixels: nothing is enlarged or shrunk, so boxes need no conversion.
    height, width = rgb.shape[:2]
    picture = whole(View("picture", "picture", 0.0, rgb), "picture", min_side_px=1, max_side_px=max(width, height))
    return eyes_of(in_plain_light(picture) if plain_light else picture, ())


def _detection(words: str, match: Match, thing: Thing, size: tuple[int, int]) -> Detection:
    height, width = size
    box = match.box.intersection(Box(0, 0, width, height))
    assert box is not None, "a thing that is seen lies in the picture"
    return Detection(words, box, float(np.clip(match.score, 0.0, 1.0)), mask_at(thing, size))


def mask_at(thing: Thing, size: tuple[int, int]) -> Array:
    """What shows of a thing, in the picture's pixels, shape (H, W)."""
    height, width = size
    rows = (np.arange(height) + 0.5) / thing.zoom - thing.offset[1]
    columns = (np.arange(width) + 0.5) / thing.zoom - thing.offset[0]
    small_height, small_width = thing.mask.shape
    inside = ((rows >= 0) & (rows < small_height))[:, None] & ((columns >= 0) & (columns < small_width))[None, :]
    row, column = np.clip(rows, 0, small_height - 1).astype(int), np.clip(columns, 0, small_width - 1).astype(int)
    mask = inside & thing.mask[np.ix_(row, column)]
    return np.asarray(mask)
