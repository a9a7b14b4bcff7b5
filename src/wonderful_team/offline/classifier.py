"""The classical classifier: how like a description, or like a picture of one thing, each of some regions is. No weights.

It stands in where a method of the literature asks CLIP. Words are read by the grammar and judged by what is seen of kind, colours, pattern and
shape; a picture by colours, pattern, outline and size.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.description import Description
from wonderful_team.offline.detector import described, eyes_at, mask_at
from wonderful_team.offline.eyes import Eyes
from wonderful_team.offline.vision import Match, NotSeen, in_plain_light, study_example

SAME_REGION = 0.5
"""A thing that is seen is a region from this intersection over union on."""


class ClassicalClassifier:
    """Offline's vision and its grammar as a classifier."""

    name = "classical classifier"

    def similar(self, rgb: Array, masks: Sequence[Array], query: str | Picture) -> list[float]:
        """Likeness of each region of a picture to the query, 0 to 1; 0 for a region that it does not see as a thing.

        Raises:
            NotUnderstoodError: The words hold something that it does not know; says which.
        """
        array = np.asarray(rgb)
        matches = _like(array, query) if isinstance(query, Picture) else eyes_at(array).find(described(query))
        scores = [0.0] * len(masks)
        for match in matches:
            if match.thing is None:
                continue
            seen = mask_at(match.thing, rgb.shape[:2])
            shares = [_overlap(seen, mask) for mask in masks]
            best = int(np.argmax(shares))
            if shares[best] >= SAME_REGION:
                scores[best] = max(scores[best], float(np.clip(match.score, 0.0, 1.0)))
        return scores


def _like(rgb: Array, picture: Picture) -> list[Match]:
    """As the pixels are, for a picture in the same light, and in plain light, for one from elsewhere."""
    asked, found = Description("object", "as shown", like="query", quantity="all"), list[Match]()
    for plain in (False, True):
        eyes = eyes_at(rgb, plain)
        try:
            example = study_example(in_plain_light(picture) if plain else picture)
        except NotSeen:
            continue
        found += Eyes(eyes.looked_at, {"query": example}).find(asked)
    return found


def _overlap(one: Array, other: Array) -> float:
    both = float((one & other).sum())
    return both / max(1.0, float((one | other).sum()))
