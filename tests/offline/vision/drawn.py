"""Pictures of a table drawn for the tests: plain shapes with simple textures, no simulator."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Picture

Paint = Callable[[np.ndarray, np.ndarray], np.ndarray]

RED, GREEN, BLUE, YELLOW, PURPLE, ORANGE = (
    (200, 40, 45),
    (50, 150, 60),
    (50, 90, 190),
    (230, 200, 50),
    (120, 60, 150),
    (240, 140, 40),
)
WHITE, BLACK, NAVY = (250, 250, 250), (25, 25, 28), (22, 40, 90)


def plain(colour: tuple[int, int, int]) -> Paint:
    return lambda x, y: np.broadcast_to(np.array(colour, float), (*x.shape, 3))


def striped(one: tuple[int, int, int], other: tuple[int, int, int], period: float = 14) -> Paint:
    return lambda x, y: np.where((((x + y) / period) % 1 < 0.5)[..., None], one, other).astype(float)


def dotted(dots: tuple[int, int, int], ground: tuple[int, int, int], period: float = 14) -> Paint:
    def paint(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        inside = np.hypot(x % period - period / 2, y % period - period / 2) < 0.33 * period
        return np.where(inside[..., None], dots, ground).astype(float)

    return paint


def polygon(centre: tuple[float, float], corners: list[tuple[float, float]], turn_deg: float = 0.0) -> np.ndarray:
    t = np.radians(turn_deg)
    turned = np.array(corners) @ np.array([[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]])
    return turned + centre


def regular(
    centre: tuple[float, float], radius: float, sides: int, turn_deg: float = 0.0, inner: float = 0.0
) -> np.ndarray:
    count = sides * (2 if inner else 1)
    corners = []
    for k in range(count):
        r = radius * (inner if inner and k % 2 else 1.0)
        corners.append((r * np.sin(2 * np.pi * k / count), -r * np.cos(2 * np.pi * k / count)))
    return polygon(centre, corners, turn_deg)


def box_shape(centre: tuple[float, float], width: float, height: float, turn_deg: float = 0.0) -> np.ndarray:
    w, h = width / 2, height / 2
    return polygon(centre, [(-w, -h), (w, -h), (w, h), (-w, h)], turn_deg)


def round_shape(centre: tuple[float, float], rx: float, ry: float | None = None, turn_deg: float = 0.0) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    return polygon(centre, [(rx * np.cos(a), (ry or rx) * np.sin(a)) for a in t], turn_deg)


class Drawing:
    """A table on which things are painted; a table lit unevenly, with noise, from a seed."""

    def __init__(self, width: int = 640, height: int = 320, table: tuple[int, int, int] = (205, 198, 185), *, noise: float = 1.5,
                 slope: float = 12.0, seed: int = 0) -> None:  # fmt: skip
        self.rng = np.random.default_rng(seed)
        x = np.linspace(-1, 1, width)
        self.image = np.broadcast_to(np.array(table, float), (height, width, 3)) + (slope * x)[None, :, None]
        self.noise = noise
        self.height_m = np.zeros((height, width), np.float32)

    def add(
        self, outline: np.ndarray, paint: Paint, *, hole: np.ndarray | None = None, height_m: float = 0.03
    ) -> Drawing:
        big = np.zeros((self.image.shape[0] * 4, self.image.shape[1] * 4), np.uint8)
        cv2.fillPoly(big, [np.round(outline * 4).astype(np.int32)], 255)
        if hole is not None:
            cv2.fillPoly(big, [np.round(hole * 4).astype(np.int32)], 0)
        cover = cv2.resize(big, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)[..., None] / 255.0
        rows, columns = np.mgrid[0 : self.image.shape[0], 0 : self.image.shape[1]]
        self.image = self.image * (1 - cover) + paint(columns.astype(float), rows.astype(float)) * cover
        self.height_m[cover[..., 0] > 0.5] = height_m
        return self

    @property
    def rgb(self) -> np.ndarray:
        noisy = self.image + self.rng.normal(0, self.noise, self.image.shape)
        return np.clip(noisy, 0, 255).astype(np.uint8)

    def picture(self, name: str = "top view", *, depth: bool = False) -> Picture:
        height, width = self.image.shape[:2]
        depth_m = 1.0 - self.height_m if depth else None
        return Picture(name, self.rgb, Frame.whole("top", (width, height)), depth_m)


def alone(outline: np.ndarray, paint: Paint, name: str = "example") -> Picture:
    """A thing on plain white, without noise."""
    return Drawing(320, 240, WHITE, noise=0.0, slope=0.0).add(outline, paint).picture(name)
