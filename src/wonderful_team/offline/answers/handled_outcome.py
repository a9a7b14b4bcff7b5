"""What became of a thing that something was done to where it is: what the pictures show of it, and else what the robot measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.images.colours import to_lab
from wonderful_team.offline.goals.aims import Aim

OTHER_LAB = 12.0
"""A pixel whose colour changed by more than this has changed (CIELAB)."""
DRAWN, WIPED = 0.004, 0.05
"""From these shares of changed pixels on, a figure was drawn on a surface, and a surface wiped."""


def judge_led(aim: Aim, before: Picture, after: Picture, box: Box, measured: Sequence[str]) -> tuple[str, str]:
    """Status and evidence of a path along a surface: a line shows there, or its look has changed.

    A surface that was clean looks the same when it is wiped: then what the robot measured counts.
    """
    name = aim.thing.words
    changed = _changed(before, after, box)
    wiping = aim.figure is not None and aim.figure.name == "area"
    if changed >= (WIPED if wiping else DRAWN):
        return "done", f"{changed:.0%} of the {name} look different now"
    if wiping and _followed(measured):
        return "unclear", f"the tool was led over the {name}, which looks as before"
    return "not_done", f"nothing new shows on the {name}"


def judge_shaken(name: str, away: tuple[str, str], measured: Sequence[str]) -> tuple[str, str]:
    """Status and evidence of shaking: no picture shows it, so the robot must have followed the whole path, and the thing stands again.

    Args:
        name: Of what was shaken.
        away: Status and evidence of where it stands now.
        measured: What the robot reported of it, one line per action.
    """
    if not _followed(measured):
        return "not_done", f"the {name} was not moved along the path in the air"
    return away


def _followed(measured: Sequence[str]) -> bool:
    return any("trajectory executed" in line and "fault:" not in line for line in measured)


def _changed(before: Picture, after: Picture, box: Box) -> float:
    """Share of a box's pixels whose colours differ between two pictures of the same view, 0 to 1."""
    there = after.frame.box_to_picture(before.frame.box_to_view(box))
    one, other = _cut(before, box), _cut(after, there)
    height, width = min(one.shape[0], other.shape[0]), min(one.shape[1], other.shape[1])
    if not height or not width:
        return 0.0
    off = np.linalg.norm(to_lab(one[:height, :width]) - to_lab(other[:height, :width]), axis=-1)
    return float((off > OTHER_LAB).mean())


def _cut(picture: Picture, box: Box) -> Array:
    inside = box.intersection(picture.frame.valid)
    if inside is None:
        return np.zeros((0, 0, 3), np.uint8)
    x0, y0, x1, y1 = (round(value) for value in inside.as_tuple)
    return np.ascontiguousarray(picture.rgb[y0:y1, x0:x1])
