"""Small made-up tables to cut and draw on; every pixel follows from the arguments."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, Picture
from wonderful_team.core.values import View
from wonderful_team.images import crop


def table(width: int = 640, height: int = 480, *, shift: tuple[float, float] = (0.0, 0.0), seed: int = 0) -> Array:
    """A wooden table with a bowl, a block and a star; `shift` moves the block [px]."""
    grain = np.random.default_rng(seed).normal(0, 4, (height, 1, 1)).repeat(width, axis=1)
    rgb = np.clip(np.array([176.0, 140.0, 104.0]) + grain, 0, 255).astype(np.uint8).copy()
    unit = min(width, height) / 480
    bowl = (round(width * 0.7), round(height * 0.42))
    cv2.circle(rgb, bowl, round(70 * unit), (52, 90, 160), -1, cv2.LINE_AA)
    cv2.circle(rgb, bowl, round(52 * unit), (96, 140, 210), -1, cv2.LINE_AA)
    x, y = width * 0.25 + shift[0], height * 0.55 + shift[1]
    half = 38 * unit
    corners = np.array([(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)])
    cv2.fillPoly(rgb, [np.rint(corners * 16).astype(np.int32)], (190, 40, 45), cv2.LINE_AA, 4)
    angles = np.arange(10) * np.pi / 5 - np.pi / 2
    reach = np.where(np.arange(10) % 2, 22, 54) * unit
    star = np.column_stack([width * 0.48 + reach * np.cos(angles), height * 0.8 + reach * np.sin(angles)])
    cv2.fillPoly(rgb, [np.rint(star * 16).astype(np.int32)], (238, 206, 60), cv2.LINE_AA, 4)
    return rgb


def view(width: int = 640, height: int = 480, *, depth: bool = False, view_id: str = "top") -> View:
    """A view of `table`, with a slanted depth when asked."""
    depth_m = np.linspace(0.5, 0.9, width * height, dtype=np.float32).reshape(height, width) if depth else None
    return View(view_id, "top", 0.0, table(width, height), depth_m)


def crop_pair(seen: View, before: Box, after: Box) -> tuple[Picture, Picture]:
    """Two pictures of the same window, large enough for both boxes; each carries its own box."""
    clean = crop(seen, before, "crop before", also=(after,))
    return (
        clean.marked(BoxMark(clean.frame.box_to_picture(before), "before")),
        replace(clean, name="crop after").marked(BoxMark(clean.frame.box_to_picture(after), "after")),
    )
