"""Pictures whose pixels are made when they are first asked for."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import cached_property
from typing import Any

from wonderful_team.core.geometry import Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.once import Once
from wonderful_team.core.pictures import Mark, Panel, Picture
from wonderful_team.core.values.observation import View


class LaterPicture(Picture):
    """A picture that is made when its pixels are first asked for: a simulated model knows what it shows without them.

    Args:
        pixels: rgb and depth_m of `Picture`, read-only, of the frame's size.
        source: The view that it shows through its frame; None for pictures side by side.
    """

    source: View | None
    _pixels: Once[tuple[Array, Array | None]]

    def __new__(cls, *args: Any, **fields: Any) -> Any:
        # `dataclasses.replace` hands over the fields of a picture: what it makes has its pixels.
        return Picture(**fields) if "rgb" in fields else super().__new__(cls)

    def __init__(
        self,
        name: str,
        frame: Frame,
        pixels: Once[tuple[Array, Array | None]],
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
        """Whether its pixels were asked for."""
        return self._pixels.made

    def marked(self, *marks: Mark) -> Picture:
        return self._but(self.name, (*self.marks, *marks))

    def named(self, name: str) -> Picture:
        return self._but(name, self.marks)

    def _but(self, name: str, marks: Sequence[Mark]) -> Picture:
        return LaterPicture(name, self.frame, self._pixels, source=self.source, marks=marks, panels=self.panels)
