"""A helper function that was accepted in a trial: what later steps of the same trial may call."""

from __future__ import annotations

import re
from dataclasses import dataclass

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import PathPoint

NAME = re.compile(r"path_[1-9]\d{0,3}")
"""What later code calls a kept function by: never a word of Python or the name of a shape."""
MAX_COORDINATE_PX = 1e6
"""Larger numbers are not pixels."""


@dataclass(frozen=True)
class FunctionBox:
    """A target that a function was written for: its id then, its words, and where it was [px of the picture that was shown]."""

    id: str
    words: str
    box: Box


@dataclass(frozen=True)
class HelperFunction:
    """Code that gave a path which was drawn and accepted.

    Attributes:
        name: path_1, path_2, ... in the order in which a trial accepted them.
        purpose: What it computes, in the words of the subgoal that asked for it.
        code: Python source that defines `path(boxes)`; it may call functions that were accepted before it, by their names.
        boxes: What it was accepted for.
        path: What it gave for these boxes, in pixels of the same picture.

    Raises:
        ValueError: The name is none that a function goes by, or the path is none that one can have given.
    """

    name: str
    purpose: str
    code: str
    boxes: tuple[FunctionBox, ...]
    path: tuple[PathPoint, ...]

    def __post_init__(self) -> None:
        if NAME.fullmatch(self.name) is None:
            raise ValueError(f"name of a helper function {self.name[:80]!r}: valid are path_1, path_2, ...")
        if len(self.path) < 2:
            raise ValueError(f"path of {self.name}: {len(self.path)} points; 2 or more are valid")
        placed = [value for point in self.path for value in point[:2]]
        placed += [value for item in self.boxes for value in item.box.as_tuple]
        if max(map(abs, placed)) > MAX_COORDINATE_PX:
            raise ValueError(f"path and boxes of {self.name}: up to {MAX_COORDINATE_PX:g} px from the corner are valid")

    @property
    def number(self) -> int:
        """How many a trial had accepted with it."""
        return int(self.name.removeprefix("path_"))
