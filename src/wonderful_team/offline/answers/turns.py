"""ReadTurn: the numbered cut-out that differs least from the goal, pixel by pixel."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.contracts import ReadTurn, TurnChoice
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, Tiles
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.images.turned import FIT_PX, SHIFT_SHARE, misfit

UNLIKE = 60.0
"""Grey levels: a goal that differs more from every cut-out shows another thing."""


def answer_read_turn(question: ReadTurn) -> TurnChoice:
    """Compare every cut-out with the goal, at the shift that fits best."""
    goal = next((mark.box for mark in question.strip.marks if isinstance(mark, BoxMark)), None)
    if goal is None:
        return TurnChoice(reasoning="no goal is marked", number=None)
    if not any(isinstance(mark, Tiles) for mark in question.strip.marks):
        raise UnsupportedQuestion(
            "offline", "ReadTurn", "it reads a turn from turned cut-outs alone, and none are shown"
        )
    inner = 1 - 2 * SHIFT_SHARE
    around = _patch(question.strip.rgb, goal, FIT_PX)
    patches = [_patch(question.strip.rgb, tile.scaled(inner), round(FIT_PX * inner)) for tile in question.tiles.boxes]
    off = [misfit(patch, around) for patch in patches]
    best = int(np.argmin(off))
    if off[best] > UNLIKE:
        return TurnChoice(reasoning=f"the nearest still differs by {off[best]:.0f} grey levels", number=None)
    return TurnChoice(reasoning=f"it differs least, by {off[best]:.0f} grey levels", number=best + 1)


def _patch(rgb: Array, box: Box, side: int) -> Array:
    x0, y0, x1, y1 = (round(value) for value in box.as_tuple)
    cut = np.ascontiguousarray(rgb[y0:y1, x0:x1])
    return np.asarray(cv2.resize(cut, (side, side), interpolation=cv2.INTER_AREA)).astype(np.float32)
