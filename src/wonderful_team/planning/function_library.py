"""The helper functions that a trial has accepted: what is kept of them, and what of it is shown to whoever needs a path again."""

from __future__ import annotations

import asyncio
import math
import re
from collections.abc import Iterable, Sequence

import numpy as np

from wonderful_team.contracts import EarlierFunction
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import BoxMark, PathMark, PathPoint, Picture, rises_of
from wonderful_team.core.values import MAX_FUNCTIONS, HelperFunction, Subgoal
from wonderful_team.sandbox import SandboxError, called, run_path

MOST_SHOWN = 3
"""Functions that are shown to whoever writes another one."""
MOST_TOLD = 6
"""Functions that are named, without their code, to whoever writes a plan."""
MOST_CODE = 2_000
"""Characters of a function's code that are shown; by its name it can be called whole."""
MOST_WORDS = 300
"""Characters of what a function is for."""
SAME_PX = 0.5
"""Two paths are the same when no point of one lies farther from the other's [px]."""
_SKETCH_PX, _RIM = 320, 0.08
"""Longer side of the picture of what was drawn, and the margin round it as a share of that [px]."""


def purpose_key(purpose: str | None, targets: Iterable[str]) -> str:
    """The same for functions that are asked for in the same words, whatever targets they are for: a circle round T1, one round T2."""
    text = " ".join((purpose or "").split())
    for number, name in enumerate(targets, start=1):
        text = re.sub(rf"\b{re.escape(name)}\b", f"<{number}>", text)
    return text.casefold()


def _key(one: HelperFunction) -> str:
    return purpose_key(one.purpose, (item.id for item in one.boxes))


def code_by_name(kept: Sequence[HelperFunction]) -> dict[str, str]:
    """What the sandbox takes of them."""
    return {one.name: one.code for one in kept}


async def with_function(
    kept: tuple[HelperFunction, ...], new: HelperFunction
) -> tuple[tuple[HelperFunction, ...], str]:
    """Those that are kept once this one was accepted, and what became of it in words.

    Left out is one that adds nothing (an earlier one gives the same path for its boxes), and one that cannot be called by its name,
    such as one that counts its own calls in a global variable. At the limit the oldest one goes that no other one calls.
    """
    return await asyncio.to_thread(_with_function, kept, new)


def _with_function(kept: tuple[HelperFunction, ...], new: HelperFunction) -> tuple[tuple[HelperFunction, ...], str]:
    boxes = [item.box for item in new.boxes]
    same = next((one for one in reversed(kept) if _gives(one, kept, boxes, new.path)), None)
    if same is not None:
        return kept, f"the path of {same.name} again"
    if not _gives(new, (*kept, new), boxes, new.path):
        return kept, "not kept, it gives another path when it is called by a name"
    more = (*kept, new)
    while len(more) > MAX_FUNCTIONS:
        spare = next((one for one in more if not _is_called(one, more)), more[0])
        more = tuple(one for one in more if one is not spare)
    return more, f"kept as {new.name}"


def _is_called(one: HelperFunction, by: Sequence[HelperFunction]) -> bool:
    return any(called(other.code, {one.name: one.code}) for other in by if other is not one)


def _gives(
    one: HelperFunction, known: Sequence[HelperFunction], boxes: Sequence[Box], path: Sequence[PathPoint]
) -> bool:
    """Whether a function that is called by its name gives this path for these boxes, taken in the order of its own."""
    if len(boxes) != len(one.boxes):
        return False
    given = dict(zip((item.id for item in one.boxes), boxes, strict=True))
    try:
        found = run_path(f"def path(boxes):\n    return {one.name}(boxes)", given, earlier=code_by_name(known))
    except SandboxError:
        return False
    return len(found) == len(path) and all(
        len(a) == len(b) and math.dist(a[:2], b[:2]) <= SAME_PX and rises_of([a]) == rises_of([b])
        for a, b in zip(found, path, strict=True)
    )


def next_name(kept: Sequence[HelperFunction]) -> str:
    """What the next function will be called by."""
    return f"path_{max((one.number for one in kept), default=0) + 1}"


def shown(kept: Sequence[HelperFunction], subgoal: Subgoal) -> tuple[EarlierFunction, ...]:
    """What to show to whoever writes a function for this subgoal: those that it names or that had its purpose first, then the newest.

    Of several that were asked for in the same words only the newest is shown: it was written knowing the others.
    """
    newest: dict[str, HelperFunction] = {}
    for one in reversed(kept):
        newest.setdefault(_key(one), one)
    own = newest.get(purpose_key(subgoal.function, subgoal.targets))
    named = called(subgoal.function or "", code_by_name(kept))
    first = [one for one in reversed(kept) if one is own or one.name in named]
    rest = [one for one in newest.values() if one not in first]
    return tuple(_shown(one) for one in (*first, *rest)[:MOST_SHOWN])


def _shown(one: HelperFunction) -> EarlierFunction:
    code = one.code.strip("\n")
    if len(code) > MOST_CODE:
        code = f"{code[:MOST_CODE]}\n... ({len(code) - MOST_CODE} more characters)"
    return EarlierFunction(one.name, in_a_line(one.purpose), _takes(one), code, sketch(one), rises_of(one.path))


def told(kept: Sequence[HelperFunction]) -> tuple[str, ...]:
    """The newest functions in a line each, for whoever writes a plan."""
    lines = []
    for one in reversed(kept[-MOST_TOLD:]):
        were = "; ".join(f"{name} was {words}" for name, words in _takes(one).items())
        lines.append(f"{one.name}: {in_a_line(one.purpose)}" + (f" ({were})" if were else ""))
    return tuple(lines)


def _takes(one: HelperFunction) -> dict[str, str]:
    return {item.id: in_a_line(item.words) for item in one.boxes}


def in_a_line(text: str) -> str:
    """Words as they were written, in one line, cut where they are long."""
    line = " ".join(text.split())
    return line if len(line) <= MOST_WORDS else f"{line[:MOST_WORDS]} ..."


def sketch(one: HelperFunction) -> Picture:
    """What a function drew in its boxes, on white: the picture it was drawn on shows a scene that may be past."""
    flat = [(point[0], point[1]) for point in one.path]
    corners = [*flat, *(corner for item in one.boxes for corner in item.box.corners)]
    left, top = np.min(corners, axis=0)
    right, low = np.max(corners, axis=0)
    rim = max(_RIM * max(right - left, low - top), 1.0)
    scale = _SKETCH_PX / (max(right - left, low - top) + 2 * rim)
    size = (math.ceil((right - left + 2 * rim) * scale), math.ceil((low - top + 2 * rim) * scale))

    def at(point: tuple[float, float]) -> tuple[float, float]:
        return (float(point[0] - left + rim) * scale, float(point[1] - top + rim) * scale)

    marks = [
        BoxMark(Box.bounding([at(corner) for corner in item.box.corners]), "target", item.id) for item in one.boxes
    ]
    white = np.full((size[1], size[0], 3), 255, dtype=np.uint8)
    path = PathMark(tuple(at(point) for point in flat), one.name)
    return Picture(one.name, white, Frame.whole(one.name, size), marks=(*marks, path))
