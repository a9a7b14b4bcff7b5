"""Pictures that this process has drawn before: nine settings on one scene draw its start and its instruction once."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable
from typing import Any, TypeAlias

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import Kept
from wonderful_team.sims.tabletop.renderer import Drawn, Renderer

MOST_BYTES = 64_000_000
"""Some six scenes of 640 x 320 pixels: the trials of one scene follow each other."""
Drawing: TypeAlias = tuple[Array, ...]
"""Read-only."""


def kept_pictures(most_bytes: int = MOST_BYTES) -> Kept[Hashable, Drawing]:
    """Room for pictures, by what they show."""
    return Kept(most_bytes, lambda drawing: sum(array.nbytes for array in drawing))


_KEPT = kept_pictures()


class KeepingRenderer:
    """Draws what has not been drawn before; a picture depends on the model and on where its geoms stand.

    Args:
        renderer: Draws the rest.
        model: Says which model that is: two with the same words draw the same.
    """

    def __init__(self, renderer: Renderer, model: str, kept: Kept[Hashable, Drawing] = _KEPT) -> None:
        self._renderer, self._model, self._kept = renderer, model, kept
        self.name = renderer.name

    def draw(self, state: Any, camera: str, *, alone: bool = False) -> Drawn:
        def work() -> Drawing:
            drawn = self._renderer.draw(state, camera, alone=alone)
            return drawn.rgb, drawn.depth_m

        return Drawn(*self._get(state, camera, f"draw {alone}", work))

    def colours(self, state: Any, camera: str, *, alone: bool = False) -> Array:
        return self._get(
            state, camera, f"colours {alone}", lambda: (self._renderer.colours(state, camera, alone=alone),)
        )[0]

    def bodies(self, state: Any, camera: str) -> Array:
        return self._get(state, camera, "bodies", lambda: (self._renderer.bodies(state, camera),))[0]

    def close(self) -> None:
        self._renderer.close()

    def _get(self, state: Any, camera: str, what: str, draw: Callable[[], Drawing]) -> Drawing:
        poses = hashlib.sha256(state.geom_xpos.tobytes() + state.geom_xmat.tobytes()).digest()
        key = (self._model, self.name, camera, what, poses)
        drawn = self._kept.get(key)
        if drawn is None:
            drawn = draw()
            for array in drawn:
                array.setflags(write=False)
            drawn = self._kept.keep(key, drawn)
        return drawn
