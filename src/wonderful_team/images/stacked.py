"""Whether a later picture of a table shows something lying over where something else lay: then heights matter."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.values import View
from wonderful_team.images.apart import apart
from wonderful_team.images.colours import commonest

DIFFERS = 24
"""Levels (0 to 255) from which a pixel differs from the table, or from the same pixel of another picture."""
LEAST_SHARE = 0.0004
"""Smaller patches than this share of the picture are noise."""
HIDDEN_SHARE = 0.1
"""So much less of the things shows, as a share of what showed where the pictures differ: the rest is covered."""


def lies_over(before: View, after: View) -> bool:
    """Whether something in the later picture covers what the earlier one showed in its place.

    Judged from above, where both pictures differ: something lies where something lay, and less of all things shows than
    before. What was only shifted, turned or swapped shows as much as before. Pictures of different sizes cannot be
    compared: then True.
    """
    if before.size_px != after.size_px:
        return True
    changed = apart(before.rgb, after.rgb, DIFFERS)
    table = commonest(before.rgb)
    was, now = (apart(view.rgb, table, DIFFERS) for view in (before, after))
    over = cv2.morphologyEx((changed & was & now).astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    shown_before, shown_after = int((changed & was).sum()), int((changed & now).sum())
    hidden = shown_before - shown_after
    return bool(over.sum() > LEAST_SHARE * over.size and hidden > HIDDEN_SHARE * max(shown_before, 1))
