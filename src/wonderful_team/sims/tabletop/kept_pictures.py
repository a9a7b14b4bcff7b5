"""Pictures that this process has drawn before: nine settings on one scene draw its start and its instruction once."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.renderer import Drawn, Renderer

MOST_BYTES = 64_000_000
"""Some six scenes of 640 x 320 pixels: the trials of one scene follow each other."""
Kept = TypeVar("Kept", Array, Drawn)


class KeptPictures:
    """Read-only pictures by what they show, the longest unused given up first; safe to share between threads."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._most = most_bytes
        self._held: OrderedDict[Hashable, Any] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()

    def get(self, key: Hashable, draw: Callable[[], Kept]) -> Kept:
        """What is kept under a key, drawn if it is not."""
        with self._lock:
            if key in self._held:
                self._held.move_to_end(key)
                kept: Kept = self._held[key]
                return kept
        # Not under the lock: drawing takes milliseconds, and twice does no harm.
        drawn = draw()
        for array in _arrays(drawn):
            array.setflags(write=False)
        with self._lock:
            self._forget(key)
            self._held[key] = drawn
            self._bytes += _size(drawn)
            while self._bytes > self._most:
                self._forget(next(iter(self._held)))
        return drawn

    @property
    def held_bytes(self) -> int:
        """Memory of all pictures."""
        return self._bytes

    def _forget(self, key: Hashable) -> None:
        if key in self._held:
            self._bytes -= _size(self._held.pop(key))


_KEPT = KeptPictures()


class KeepingRenderer:
    """Draws what has not been drawn before; a picture depends on the model and on where its geoms stand.

    Args:
        renderer: Draws the rest.
        model: Says which model that is: two with the same words draw the same.
    """

    def __init__(self, renderer: Renderer, model: str, kept: KeptPictures = _KEPT) -> None:
        self._renderer, self._model, self._kept = renderer, model, kept
        self.name = renderer.name

    def draw(self, state: Any, camera: str, *, alone: bool = False) -> Drawn:
        key = self._key(state, camera, f"draw {alone}")
        return self._kept.get(key, lambda: self._renderer.draw(state, camera, alone=alone))

    def colours(self, state: Any, camera: str, *, alone: bool = False) -> Array:
        key = self._key(state, camera, f"colours {alone}")
        return self._kept.get(key, lambda: self._renderer.colours(state, camera, alone=alone))

    def bodies(self, state: Any, camera: str) -> Array:
        return self._kept.get(self._key(state, camera, "bodies"), lambda: self._renderer.bodies(state, camera))

    def close(self) -> None:
        self._renderer.close()

    def _key(self, state: Any, camera: str, what: str) -> Hashable:
        poses = hashlib.sha256(state.geom_xpos.tobytes() + state.geom_xmat.tobytes()).digest()
        return self._model, self.name, camera, what, poses


def _arrays(drawn: Array | Drawn) -> tuple[Array, ...]:
    return (drawn.rgb, drawn.depth_m) if isinstance(drawn, Drawn) else (drawn,)


def _size(drawn: Array | Drawn) -> int:
    return sum(array.nbytes for array in _arrays(drawn))
