"""Photos as views, the pictures of an instruction, and regions that are given as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.geometry import Box, Camera
from wonderful_team.core.values import Instruction, KeepOut, Slot, SlotKind, View
from wonderful_team.errors import ConfigError
from wonderful_team.images.calibration import (
    CAMERA_FILE_FORM,
    Calibration,
    CameraFile,
    PathLike,
    corners_camera,
    load_camera,
    load_depth,
)

__all__ = [
    "CAMERA_FILE_FORM",
    "Calibration",
    "CameraFile",
    "SLOT_KINDS",
    "corners_camera",
    "instruction_with_pictures",
    "load_camera",
    "load_depth",
    "load_view",
    "read_keep_out",
    "unknown_robot",
]

SLOT_KINDS: tuple[SlotKind, ...] = ("object", "scene", "frame", "before", "after")


def load_view(path: PathLike, view_id: str, depth: PathLike | None = None, camera: Camera | None = None) -> View:
    """A photo as a view."""
    from wonderful_team.images import load_picture

    rgb = load_picture(Path(path))
    size_px = (int(rgb.shape[1]), int(rgb.shape[0]))
    return View(view_id, view_id, 0.0, rgb, load_depth(depth, size_px) if depth is not None else None, camera)


def instruction_with_pictures(text: str, pictures: Mapping[str, PathLike]) -> Instruction:
    """An instruction whose `{name}` marks stand for pictures.

    Args:
        text: The instruction's words.
        pictures: Name to file; the name may say what kind of picture it is, as in "goal:scene" (default: object).

    Raises:
        ConfigError: An unknown kind, or a mark without a picture, or a picture without a mark.
    """
    slots = {}
    for key, path in pictures.items():
        name, _, kind = key.partition(":")
        if kind and kind not in SLOT_KINDS:
            raise ConfigError(f"picture {key!r}: unknown kind {kind!r}; valid: {', '.join(SLOT_KINDS)}")
        view = load_view(path, f"slot:{name}:photo")
        slots[name] = Slot(name, kind or "object", {"photo": view})
    marks = _marks(text)
    missing = [mark for mark in marks if mark not in slots]
    if missing:
        raise ConfigError(
            f"the instruction says {{{missing[0]}}} but no picture has that name: --picture {missing[0]}=FILE"
        )
    return Instruction(text, slots)


def read_keep_out(texts: Sequence[str]) -> tuple[KeepOut, ...]:
    """Regions from "[NAME=]x0,y0,x1,y1[px|m]".

    Raises:
        ConfigError: Another form, or an empty region.
    """
    return tuple(_keep_out(text, number) for number, text in enumerate(texts, start=1))


def _keep_out(text: str, number: int) -> KeepOut:
    name, _, region = text.rpartition("=")
    unit: Literal["px", "m"] = "m" if region.endswith("m") else "px"
    numbers = region.removesuffix("px").removesuffix("m")
    try:
        x0, y0, x1, y1 = (float(part) for part in numbers.split(","))
        return KeepOut(name or f"region {number}", Box(x0, y0, x1, y1), unit)
    except ValueError as error:
        why = f": {error}" if "box" in str(error) else ""
        raise ConfigError(f"keep-out {text!r}{why}; valid: [NAME=]x0,y0,x1,y1[px|m] with x0 < x1 and y0 < y1") from None


def unknown_robot(vocabulary: Vocabulary) -> str:
    """What planners are told where nobody says anything of the robot, one fact a line."""
    lines = [
        "Nothing is known of the robot's tool and reach, or of where the camera stands: take what the main view shows to be "
        "in reach.",
        "North is the upper edge of the main view, unless the instruction says otherwise.",
        "A turn without a direction is clockwise, seen from above.",
        "Where a picture shows a goal, things are turned there as they should be turned in the end.",
    ]
    if "pick_place" in vocabulary.kinds:
        lines.append("A thing that is picked up is carried over all others, never through them.")
    if "push" in vocabulary.kinds:
        lines.append("A thing that is pushed slides on its surface; how wide the tool is, is not known.")
    return "\n".join(lines)


def _marks(text: str) -> list[str]:
    import string

    try:
        return [name for _, name, _, _ in string.Formatter().parse(text) if name is not None]
    except ValueError as error:
        raise ConfigError(f"instruction {text!r}: {error}; a mark is a name in braces, as in {{cup}}") from error
