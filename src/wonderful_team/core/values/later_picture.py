"""Pictures whose pixels are made when they are first asked for."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

from wonderful_team.core.geometry import Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.heap import stay_low
from wonderful_team.core.kept import KeptFor
from wonderful_team.core.pictures import Mark, Panel, Picture
from wonderful_team.core.values.observation import View


class Pixels:
    """Colours and depth of a picture, made when they are asked for. The last ones are kept; others are made again.

    Args:
        make: Gives rgb and depth_m of `Picture`, read-only, of the frame's size, the same every time.
    """

    def __init__(self, make: Callable[[], tuple[Array, Array | None]]) -> None:
        self._make = make
        self._lock = threading.Lock()
        self.made = False

    def __call__(self) -> tuple[Array, Array | None]:
        with self._lock:
            held = _kept.get(self, None)
            if held is None:
                stay_low()
                held, self.made = _kept.keep(self, None, self._make()), True
            return held


KEPT_BYTES = 48_000_000
_kept: KeptFor[Pixels, None, tuple[Array, Array | None]] = KeptFor(
    KEPT_BYTES, lambda held: sum(array.nbytes for array in held if array is not None)
)


class LaterPicture(Picture):
    """A picture that is made when its pixels are first asked for: a simulated model knows what it shows without them.

    Args:
        pixels: Of the frame's size.
        source: The view that it shows through its frame; None for pictures side by side.
    """

    source: View | None
    _pixels: Pixels

    def __new__(cls, *args: Any, **fields: Any) -> Any:
        # `dataclasses.replace` hands over the fields of a picture: what it makes has its pixels.
        return Picture(**fields) if "rgb" in fields else super().__new__(cls)

    def __init__(
        self,
        name: str,
        frame: Frame,
        pixels: Pixels,
        *,
        source: View | None = None,
        marks: Sequence[Mark] = (),
        panels: Sequence[Panel] = (),
    ) -> None:
        given = {"name": name, "frame": frame, "marks": tuple(marks), "panels": tuple(panels), "source": source}
        self.__dict__.update(given, _pixels=pixels)

    @property
    def rgb(self) -> Array:
        return self._pixels()[0]

    @property
    def depth_m(self) -> Array | None:
        return self._pixels()[1]

    @cached_property
    def source_hash(self) -> str:
        if self.source is None:
            return self.hash
        frame = self.frame
        window = [*frame.T_view_picture.ravel().tolist(), *frame.size_px, *frame.valid.as_tuple]
        return hashlib.sha256(repr([self.source.hash, *map(float, window)]).encode()).hexdigest()[:16]

    @property
    def made(self) -> bool:
        """Whether its pixels were ever asked for."""
        return self._pixels.made

    def marked(self, *marks: Mark) -> Picture:
        return self._but(self.name, (*self.marks, *marks))

    def named(self, name: str) -> Picture:
        return self._but(name, self.marks)

    def _but(self, name: str, marks: Sequence[Mark]) -> Picture:
        return LaterPicture(name, self.frame, self._pixels, source=self.source, marks=marks, panels=self.panels)
