"""What a thing offers to be pushed into: its inside, its walls and the side on which it is open, from its outline alone."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision import Thing

OPEN, CLOSED = 0.4, 0.5
"""A side of a frame is open when at most this share of it is walled, closed from the other share on (0 to 1)."""
WALL_DEEPEST = 0.2
"""A wall is at most this share of the frame's shorter side thick."""
SOLID = 0.6
"""From this share of its rectangle on a thing has no inside of its own: it is an area to be pushed onto."""
SAMPLES = 60


@dataclass(frozen=True, eq=False)
class Room:
    """The inside of a thing; coordinates are working pixels of the picture.

    Attributes:
        corner: Where the back wall meets one side wall, inside, shape (2,).
        across, out: Unit vectors along the back wall and from it to the open side, shape (2,).
        width, depth: Extent along them.
        walls: Where something cannot be pushed through, bool, shape of the picture; None for an area without walls.
        mouth: Whether it is open on one side only, at `depth`; else it can be entered from everywhere.
    """

    corner: Array
    across: Array
    out: Array
    width: float
    depth: float
    walls: Array | None
    mouth: bool

    def local(self, points: Array) -> Array:
        """Points (..., 2) as distances along the back wall and out of it."""
        return np.stack([(points - self.corner) @ self.across, (points - self.corner) @ self.out], axis=-1)

    def at(self, local: Array) -> Array:
        """The inverse of local()."""
        return np.asarray(self.corner + local[..., :1] * self.across + local[..., 1:] * self.out)


def study_room(thing: Thing, mask: Array) -> Room | None:
    """The room that a thing makes; None when it is closed on all sides.

    Args:
        thing: As seen.
        mask: Where it shows, in a full working image, bool.
    """
    points = np.argwhere(mask)[:, ::-1].astype(np.float32) + 0.5
    corners = cv2.boxPoints(cv2.minAreaRect(points)).astype(np.float64)
    sides = [(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    lengths = [float(np.linalg.norm(end - start)) for start, end in sides]
    shortest = min(lengths)
    if shortest < 2:  # noqa: PLR2004  a hair has no inside
        return None
    if mask.sum() >= SOLID * lengths[0] * lengths[1] or thing.flat:
        return _room(corners, 0, (0.0, 0.0, 0.0, 0.0), None, mouth=False)
    centre = corners.mean(axis=0)
    walled, thick = zip(*(_wall(mask, start, end, centre, shortest) for start, end in sides), strict=True)
    if min(walled) > OPEN:
        return None
    opening = int(np.argmin(walled))
    others = [share for k, share in enumerate(walled) if k != opening]
    if min(others) < CLOSED:
        return _room(corners, 0, (0.0, 0.0, 0.0, 0.0), mask, mouth=False)
    return _room(corners, opening, thick, mask, mouth=True)


def _wall(mask: Array, start: Array, end: Array, centre: Array, shortest: float) -> tuple[float, float]:
    """The share of a side that is walled, and how thick the wall is [px]."""
    deepest = max(2, int(round(WALL_DEEPEST * shortest)))
    middle = (start + end) / 2
    inwards = (centre - middle) / max(float(np.linalg.norm(centre - middle)), 1e-9)
    shares = np.linspace(WALL_DEEPEST, 1 - WALL_DEEPEST, SAMPLES)
    along = start + shares[:, None] * (end - start)
    depths = np.arange(0.5, deepest)
    at = (along[:, None] + depths[None, :, None] * inwards).astype(int)
    rows, columns = np.clip(at[..., 1], 0, mask.shape[0] - 1), np.clip(at[..., 0], 0, mask.shape[1] - 1)
    shown = mask[rows, columns]
    hit = shown.any(axis=1)
    if not hit.any():
        return 0.0, 0.0
    # The inner edge of the wall: the deepest pixel that still shows it.
    inner = (shown * (depths + 0.5)).max(axis=1)[hit]
    return float(hit.mean()), float(np.percentile(inner, 75))


def _room(corners: Array, opening: int, thick: tuple[float, ...], walls: Array | None, *, mouth: bool) -> Room:
    """The inside, seen from the back wall."""
    a, b, c, d = (corners[(opening + k) % 4] for k in range(4))
    # a-b is open, c-d the back, b-c and d-a the sides.
    across, out = (c - d) / np.linalg.norm(c - d), (a - d) / np.linalg.norm(a - d)
    right, back, left = thick[(opening + 1) % 4], thick[(opening + 2) % 4], thick[(opening + 3) % 4]
    corner = d + left * across + back * out
    width = float(np.linalg.norm(c - d)) - left - right
    depth = float(np.linalg.norm(a - d)) - back
    return Room(corner, across, out, width, depth, walls, mouth)
