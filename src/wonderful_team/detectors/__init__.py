"""Detectors: words and a picture in, boxes with scores and masks out. How any of them is asked, and those of `transformers`.

The protocol is `core.protocols.Detector`. The classical one, which needs no weights, is made of `offline`'s vision and stands
there; names are resolved in `registry`. Nothing heavy is imported before a detector that needs it is made.
"""

from wonderful_team.detectors.asking import WITHIN_S, checked_detections, detect, found_words, identity_of, name_of
from wonderful_team.detectors.looking import look
from wonderful_team.detectors.points import Extent, act_at, extent_of

__all__ = [
    "WITHIN_S",
    "Extent",
    "act_at",
    "checked_detections",
    "detect",
    "extent_of",
    "found_words",
    "identity_of",
    "look",
    "name_of",
]
