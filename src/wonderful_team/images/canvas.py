"""A copy of a picture's pixels to paint on: lines with halos, plates with text, and what space is taken.

Coordinates are continuous picture pixels (the centre of the first pixel is (0.5, 0.5)). Every stroke has a light or
coloured core and a dark halo, so that it shows on any background.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TypeAlias

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.images.lettering import text_mask

Colour: TypeAlias = tuple[int, int, int]
Rectangle: TypeAlias = tuple[float, float, float, float]

# Okabe and Ito's palette ("Color Universal Design", 2008), told apart with every common colour blindness.
ORANGE: Colour = (230, 159, 0)
SKY: Colour = (86, 180, 233)
GREEN: Colour = (0, 158, 115)
YELLOW: Colour = (240, 228, 66)
BLUE: Colour = (0, 114, 178)
VERMILLION: Colour = (213, 94, 0)
PURPLE: Colour = (204, 121, 167)
WHITE: Colour = (255, 255, 255)
INK: Colour = (16, 18, 22)

_SHIFT = 4  # cv2 draws with this many fractional bits
_PLATE_ALPHA = 0.78


@dataclass
class Canvas:
    """Pixels being painted.

    Attributes:
        rgb: Shape (H, W, 3), uint8; owned by the canvas.
        taken: Plates and marks placed so far (x0, y0, x1, y1), which later plates keep clear of.
        named: Points that plates stand for; a plate should be nearest to its own.
        things: Where the things that are looked at lie; plates that can stand elsewhere keep off them.
    """

    rgb: Array
    taken: list[Rectangle] = field(default_factory=list)
    named: list[Point] = field(default_factory=list)
    things: list[Rectangle] = field(default_factory=list)

    @classmethod
    def over(cls, rgb: Array) -> Canvas:
        """A canvas with a copy of these pixels."""
        return cls(np.array(rgb, dtype=np.uint8, order="C"))

    @property
    def size_px(self) -> tuple[int, int]:
        return self.rgb.shape[1], self.rgb.shape[0]

    @property
    def unit(self) -> float:
        """How much larger to draw than on a 640 x 480 picture."""
        area = self.rgb.shape[0] * self.rgb.shape[1]
        return float(min(max((area / (640 * 480)) ** 0.4, 0.8), 3.0))

    @property
    def font_px(self) -> int:
        return round(14 * self.unit)

    @property
    def stroke_px(self) -> int:
        return max(2, round(2 * self.unit))

    def polyline(
        self,
        points: Sequence[Point],
        colour: Colour,
        *,
        width_px: int | None = None,
        halo: Colour = INK,
    ) -> None:
        """A coloured stroke with a halo through the points."""
        self.lines([points], colour, width_px=width_px, halo=halo)

    def lines(
        self,
        lines: Sequence[Sequence[Point]],
        colour: Colour,
        *,
        width_px: int | None = None,
        halo: Colour = INK,
    ) -> None:
        """Several strokes at once; no halo lies over another stroke."""
        width = width_px or self.stroke_px
        fixed = _fixed_lines(lines)
        for colour_now, width_now in ((halo, width + 2 + width // 3), (colour, width)):
            cv2.polylines(self.rgb, fixed, False, colour_now, width_now, cv2.LINE_AA, _SHIFT)

    def outline(self, corners: Sequence[Point], colour: Colour) -> None:
        """A closed stroke that shows on every ground, its own colour too: dark outside, light within, colour in the middle."""
        fixed = _fixed_lines([corners])
        even = self.stroke_px + self.stroke_px % 2  # cv2 draws odd widths a pixel wider
        for colour_now, width in ((INK, even + 5), (WHITE, even + 3), (colour, self.stroke_px)):
            cv2.polylines(self.rgb, fixed, True, colour_now, width, cv2.LINE_AA, _SHIFT)

    def dashes(
        self, points: Sequence[Point], colour: Colour, *, width_px: int | None = None, halo: Colour = INK
    ) -> None:
        """A closed dashed stroke; its gaps show the halo."""
        width = width_px or self.stroke_px
        margin = 4.0 * width
        seen = (-margin, self.size_px[0] + margin, self.size_px[1] + margin)
        sides, pieces = _dash_pieces([*points, points[0]], 5.0 * self.stroke_px, 3.5 * self.stroke_px, seen)
        if sides:
            cv2.polylines(self.rgb, _fixed_lines(sides), False, halo, width + 1, cv2.LINE_AA, _SHIFT)
        if pieces:
            cv2.polylines(self.rgb, _fixed_lines(pieces), False, colour, width, cv2.LINE_AA, _SHIFT)

    def polygon(self, points: Sequence[Point], colour: Colour, alpha: float) -> None:
        """A translucent area."""
        corners = np.asarray(points)
        x0, y0 = np.clip(np.floor(corners.min(axis=0)), 0, self.size_px).astype(int)
        x1, y1 = np.clip(np.ceil(corners.max(axis=0)) + 1, 0, self.size_px).astype(int)
        if x0 >= x1 or y0 >= y1:
            return
        part = self.rgb[y0:y1, x0:x1]
        filled = part.copy()
        cv2.fillPoly(filled, _fixed_lines([[(x - x0, y - y0) for x, y in points]]), colour, cv2.LINE_AA, _SHIFT)
        part[:] = cv2.addWeighted(filled, alpha, part, 1 - alpha, 0)

    def disc(self, centre: Point, radius: float, colour: Colour, ring: Colour | None = None) -> None:
        """A filled circle, in a ring of another colour and a dark halo."""
        for colour_now, radius_now in ((INK, radius + 1.5), (ring or colour, radius), (colour, radius * 0.62)):
            self._circle(centre, radius_now, colour_now)

    def cross(self, centre: Point, reach: float, colour: Colour) -> None:
        """An upright cross with an open middle, so that the point itself stays to be seen."""
        gap = reach * 0.5
        x, y = centre
        arms = [
            [(x - reach, y), (x - gap, y)],
            [(x + gap, y), (x + reach, y)],
            [(x, y - reach), (x, y - gap)],
            [(x, y + gap), (x, y + reach)],
        ]
        self.lines(arms, colour)

    def arrow_head(self, before: Point, tip: Point, colour: Colour, length: float) -> None:
        """A filled triangle whose point lies at `tip`, coming from `before`."""
        dx, dy = tip[0] - before[0], tip[1] - before[1]
        size = math.hypot(dx, dy)
        if size < 1e-6:
            return
        dx, dy = dx / size, dy / size
        base = (tip[0] - dx * length, tip[1] - dy * length)
        half = length * 0.48
        corners = [tip, (base[0] - dy * half, base[1] + dx * half), (base[0] + dy * half, base[1] - dx * half)]
        fixed = _fixed_lines([corners])
        cv2.polylines(self.rgb, fixed, True, WHITE, 3, cv2.LINE_AA, _SHIFT)
        cv2.fillPoly(self.rgb, fixed, colour, cv2.LINE_AA, _SHIFT)

    def plate_size(self, text: str, font_px: int | None = None) -> tuple[int, int]:
        """Width and height [px] of the plate that `plate` paints for a text."""
        size = font_px or self.font_px
        height, width = text_mask(text, size).shape
        pad_x, pad_y = _padding_px(size)
        return width + 2 * pad_x, height + 2 * pad_y

    def plate(
        self,
        text: str,
        x0: int,
        y0: int,
        *,
        colour: Colour = WHITE,
        back: Colour = INK,
        font_px: int | None = None,
        alpha: float = _PLATE_ALPHA,
    ) -> None:
        """Text on a translucent plate whose top-left corner is (x0, y0); remembers the space as taken."""
        keep, add = _plate(text, font_px or self.font_px, colour, back, alpha)
        height, width = keep.shape[:2]
        self.taken.append((x0, y0, x0 + width, y0 + height))
        left, top = max(x0, 0), max(y0, 0)
        right, bottom = min(x0 + width, self.rgb.shape[1]), min(y0 + height, self.rgb.shape[0])
        if left >= right or top >= bottom:
            return
        part = self.rgb[top:bottom, left:right]
        inside = np.s_[top - y0 : bottom - y0, left - x0 : right - x0]
        part[:] = part * keep[inside] + add[inside]

    def keep_clear(self, point: Point, radius: float) -> None:
        """Ask later plates to stay off a point."""
        self.taken.append((point[0] - radius, point[1] - radius, point[0] + radius, point[1] + radius))

    def _circle(self, centre: Point, radius: float, colour: Colour) -> None:
        point = _fixed_lines([[centre]])[0][0]
        middle = (int(point[0]), int(point[1]))
        cv2.circle(self.rgb, middle, round(radius * (1 << _SHIFT)), colour, -1, cv2.LINE_AA, _SHIFT)


def _fixed_lines(lines: Sequence[Sequence[Point]]) -> list[Array]:
    """Points as cv2 wants them: fixed point, pixel centres at whole numbers."""
    flat = np.asarray([point for line in lines for point in line], dtype=np.float64).reshape(-1, 2)
    most = 2**24 / (1 << _SHIFT)
    fixed = np.rint(np.clip(flat - 0.5, -most, most) * (1 << _SHIFT)).astype(np.int32)
    ends = np.cumsum([len(line) for line in lines])[:-1]
    return np.split(fixed, ends)


@lru_cache(maxsize=512)
def _plate(text: str, font_px: int, colour: Colour, back: Colour, alpha: float) -> tuple[Array, Array]:
    """What share of the ground a plate keeps, shape (h, w, 1), and what it adds, shape (h, w, 3), float32."""
    pad_x, pad_y = _padding_px(font_px)
    ink = np.pad(text_mask(text, font_px), ((pad_y, pad_y), (pad_x, pad_x)))[..., None].astype(np.float32) / 255
    keep = (1 - alpha) * (1 - ink)
    add = alpha * (1 - ink) * np.asarray(back, np.float32) + ink * np.asarray(colour, np.float32) + 0.5
    return keep, np.minimum(add, 255.0 - 255.0 * keep + 0.5)


def _padding_px(font_px: int) -> tuple[int, int]:
    return max(3, round(font_px * 0.28)), max(2, round(font_px * 0.2))


def _dash_pieces(
    points: Sequence[Point], dash: float, gap: float, seen: tuple[float, float, float]
) -> tuple[list[list[Point]], list[list[Point]]]:
    """The sides as far as they are seen, and their pieces of length `dash`, `gap` apart, starting anew at each corner.

    Args:
        points: Corners, which may lie as far away as numbers go.
        dash: Length of a piece [px].
        gap: Between two pieces [px].
        seen: Least coordinate that is seen, largest x, largest y [px].
    """
    sides: list[list[Point]] = []
    pieces: list[list[Point]] = []
    for (xa, ya), (xb, yb) in zip(points, points[1:], strict=False):
        length = math.hypot(xb - xa, yb - ya)
        shown = _seen_share((xa, ya), (xb, yb), seen)
        if not 1e-6 <= length < math.inf or shown is None:
            continue

        count = max(1, round((length + gap) / (dash + gap)))
        # Stretch dash and gap so that each side ends with a full dash at its corner.
        stretch = length / (count * dash + (count - 1) * gap)
        period = (dash + gap) * stretch
        begin, end = (_clipped(xa + (xb - xa) * share, ya + (yb - ya) * share, seen) for share in shown)
        reach = math.hypot(end[0] - begin[0], end[1] - begin[1])
        way = ((end[0] - begin[0]) / max(reach, 1e-9), (end[1] - begin[1]) / max(reach, 1e-9))
        sides.append([begin, end])
        # Laid along what is seen, which is short, however long the side is.
        first = -((shown[0] * length) % period)
        for k in range(math.ceil((reach - first) / period)):
            low, high = max(0.0, first + k * period), min(reach, first + k * period + dash * stretch)
            if low < high:
                pieces.append([(begin[0] + way[0] * t, begin[1] + way[1] * t) for t in (low, high)])
    return sides, pieces


def _clipped(x: float, y: float, seen: tuple[float, float, float]) -> Point:
    least, most_x, most_y = seen
    return min(max(x, least), most_x), min(max(y, least), most_y)


def _seen_share(start: Point, end: Point, seen: tuple[float, float, float]) -> tuple[float, float] | None:
    """From where to where a line is seen, as shares of it from 0 to 1; None when it is not (Liang and Barsky 1984)."""
    low, high = 0.0, 1.0
    least, *largest = seen
    for a, b, most in zip(start, end, largest, strict=True):
        for distance, way in ((a - least, a - b), (most - a, b - a)):
            if way == 0.0:
                if not distance >= 0.0:
                    return None
            elif way > 0.0:
                high = min(high, distance / way)
            else:
                low = max(low, distance / way)
    return (low, high) if low < high else None
