"""A model that is shown other pixels than were drawn: to see whether answers really come from the pictures.

The frames, marks and words stay as they are; only what can be seen is wrong.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, with_pictures
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Request

SHIFT_SHARE = 0.05
"""How far a picture is shifted, as a share of its width."""
NOISE_LEVELS = 40.0
"""Standard deviation of the noise on each channel (0 to 255)."""

Change = Callable[[Array], Array]


def shifted(rgb: Array) -> Array:
    """The picture moved to the right by a twentieth of its width; its left edge is repeated."""
    step = max(1, round(SHIFT_SHARE * rgb.shape[1]))
    return np.concatenate([np.repeat(rgb[:, :1], step, axis=1), rgb[:, :-step]], axis=1)


def flipped(rgb: Array) -> Array:
    """The picture mirrored, left to right."""
    return np.ascontiguousarray(rgb[:, ::-1])


def noised(rgb: Array) -> Array:
    """The picture under noise; the same noise for the same picture."""
    rng = np.random.default_rng(int(rgb[::7, ::7].astype(np.int64).sum()))
    return np.clip(rgb + rng.normal(0.0, NOISE_LEVELS, rgb.shape), 0, 255).astype(np.uint8)


def blank(rgb: Array) -> Array:
    """One grey."""
    return np.full_like(rgb, 128)


CHANGES: Mapping[str, Change] = {"shifted": shifted, "flipped": flipped, "noised": noised, "blank": blank}


class ImageCorruption:
    """Passes requests to `model` with every picture changed.

    Args:
        model: Who answers.
        change: What happens to the pixels, shape (H, W, 3), uint8; the size must stay.
        only: Names of pictures' views (as in `frame.view_id`) must start with this; "" for all.
    """

    def __init__(self, model: Model, change: Change, only: str = "") -> None:
        self.model, self._change, self._only = model, change, only
        self.name = f"{getattr(model, 'name', type(model).__name__)}+image_corruption"
        self._made: dict[int, tuple[Array, Array]] = {}

    async def answer(self, request: Request) -> Any:
        """What the model answers to the changed pictures."""
        question = with_pictures(request.question, self._shown)
        parts = tuple(with_pictures(part, self._shown) for part in request.parts)
        result = self.model.answer(replace(request, question=question, parts=parts))
        return await result if inspect.isawaitable(result) else result

    def _shown(self, picture: Picture) -> Picture:
        if not picture.frame.view_id.startswith(self._only):
            return picture
        return replace(picture, rgb=self._pixels(picture.rgb))

    def _pixels(self, rgb: Array) -> Array:
        """The changed pixels; made once for as long as the original is kept."""
        known = self._made.get(id(rgb))
        if known is None or known[0] is not rgb:
            known = self._made[id(rgb)] = (rgb, self._change(rgb))
            known[1].setflags(write=False)
        return known[1]
