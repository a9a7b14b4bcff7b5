"""Pictures as a model is sent them: in the size it looks at, marks drawn with its own ticks, encoded; or all on one sheet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import KeptFor
from wonderful_team.core.pictures import (
    Axes,
    BoxMark,
    Candidates,
    Grid,
    LineMark,
    Mark,
    PathMark,
    Picture,
    Point,
    PointMark,
    RegionMark,
    Tiles,
    TurnMark,
)
from wonderful_team.core.values import LaterPicture
from wonderful_team.images import Ticks, draw
from wonderful_team.images.canvas import Canvas
from wonderful_team.images.drawn import drawn
from wonderful_team.images.resample import resampled
from wonderful_team.models.conventions import PIXELS, Convention, Size
from wonderful_team.models.wire.coding import Encoding, encoded

_TICKS = {"pixels": Ticks.PIXELS, "thousandths": Ticks.THOUSANDTHS, "percent": Ticks.PERCENT, "unit": Ticks.UNIT}
GAP_PX = 12
"""Grey space round each picture on a sheet."""
HEAD_PX = 30
"""Grey space above each picture, where its number stands."""
_NUMBER_PX = 18
SHEET_WIDTH_PX = 1600
LEAST_OF_ENLARGED = 0.7
"""An enlarged picture may be sent smaller by this share, never below its own pixels, where it fills fewer tiles then."""
_SHEET_GREY = 200


@dataclass(frozen=True, eq=False)
class Shown:
    """One picture as it is sent.

    Attributes:
        picture: At the size sent, marks at their places there.
        rgb: With the marks drawn, shape (H, W, 3), uint8.
        origin_px: Where its top-left corner lies on the sheet; (0, 0) when it is sent alone.
        scale: Pixels sent per pixel of our picture, along x and y.
    """

    picture: Picture
    rgb: Array
    origin_px: Point = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)

    def to_ours(self, sent_px: Array) -> Array:
        """Pixels of what was sent (the sheet, or the picture alone) to pixels of our picture, shape (N, 2)."""
        return np.asarray((sent_px - self.origin_px) / self.scale)


def ticks_of(convention: Convention) -> Ticks:
    """What the numbers on drawn axes mean to a model of this convention."""
    return _TICKS[convention.unit]


def sent_size(picture: Picture, convention: Convention, tile_px: int | None) -> Size:
    """Width and height in which a picture is sent: as the model looks at it, an enlarged one fitted to whole tiles."""
    size = convention.seen_size(picture.size_px)
    if tile_px is None or picture.frame.scale <= 1:
        return size
    return fewer_tiles(size, tile_px, least=max(LEAST_OF_ENLARGED, picture.size_px[0] / size[0] / picture.frame.scale))


def fewer_tiles(size: Size, tile_px: int, least: float) -> Size:
    """The size, or a smaller one of the same shape that is covered by fewer square tiles.

    Args:
        size: Width and height [px].
        tile_px: Side of a tile.
        least: Smallest share of the size that will do.
    """
    across, down = (-(-side // tile_px) for side in size)
    shares = [tile_px * count / size[0] for count in range(1, across)]
    shares += [tile_px * count / size[1] for count in range(1, down)]
    fitted = [size, *(_shrunk(size, share) for share in shares if least <= share < 1)]
    return min(fitted, key=lambda one: (-(-one[0] // tile_px) * -(-one[1] // tile_px), -one[0]))


def _shrunk(size: Size, share: float) -> Size:
    return max(1, int(size[0] * share + 1e-6)), max(1, int(size[1] * share + 1e-6))


def show(
    picture: Picture, convention: Convention = PIXELS, size_px: Size | None = None, reference: Frame | None = None
) -> Shown:
    """The picture in the size that is sent, its marks drawn with the model's ticks.

    Args:
        picture: What is shown.
        convention: Of the model.
        size_px: Width and height; default the size that the model looks at.
        reference: Whose pixels its axes name instead, where they name those of another picture.
    """
    sent = scaled(picture, size_px or convention.seen_size(picture.size_px))
    if reference is not None:
        sent = replace(sent, marks=tuple(Axes(reference) if isinstance(mark, Axes) else mark for mark in sent.marks))
    scale = (sent.size_px[0] / picture.size_px[0], sent.size_px[1] / picture.size_px[1])
    # At its own size it may have been drawn before: the cache looks at it too.
    rgb = drawn(sent, ticks_of(convention)) if sent is picture else draw(sent, ticks_of(convention))
    if isinstance(sent, LaterPicture):
        # What was shown is kept for a while; a view of many megapixels that it was cut from need not be.
        sent = Picture(sent.name, sent.rgb, sent.frame, None, sent.marks)
    return Shown(sent, rgb, scale=scale)


def paste(pictures: Sequence[Picture], convention: Convention = PIXELS) -> tuple[Array, list[Shown]]:
    """All pictures on one sheet, for servers that take one picture per request.

    Tick labels name the sheet's own numbers, so positions are positions on the sheet.

    Returns:
        The sheet, shape (H, W, 3), uint8, in the size that the model looks at; and where each picture lies on it.
    """
    places, size = _shelves([picture.size_px for picture in pictures])
    seen = convention.seen_size(size)
    zoom = (seen[0] / size[0], seen[1] / size[1])
    canvas = Canvas.over(np.full((seen[1], seen[0], 3), _SHEET_GREY, np.uint8))
    corners = [(round(left * zoom[0]), round(top * zoom[1])) for left, top in places]
    # Numbers first: where a sheet was shrunk they may reach into the picture above, which must stay whole.
    for number, (x0, y0) in enumerate(corners, start=1):
        high = canvas.plate_size(str(number), _NUMBER_PX)[1]
        canvas.plate(str(number), x0, max(0, y0 - high - 1), font_px=_NUMBER_PX)
    shown = []
    for picture, (x0, y0) in zip(pictures, corners, strict=True):
        width, height = (max(1, round(side * z)) for side, z in zip(picture.size_px, zoom, strict=True))
        width, height = min(width, seen[0] - x0), min(height, seen[1] - y0)
        sent = scaled(picture, (width, height))
        whole = Frame(
            sent.frame.view_id,
            sent.frame.T_view_picture @ np.array([[1.0, 0, -x0], [0, 1.0, -y0], [0, 0, 1.0]]),
            seen,
            Box(0, 0, *seen),
        )
        sent = replace(sent, marks=tuple(Axes(whole) if isinstance(mark, Axes) else mark for mark in sent.marks))
        rgb = draw(sent, ticks_of(convention))
        canvas.rgb[y0 : y0 + height, x0 : x0 + width] = rgb
        scale = (width / picture.size_px[0], height / picture.size_px[1])
        shown.append(Shown(sent, rgb, (float(x0), float(y0)), scale))
    return canvas.rgb, shown


KEPT_BYTES = 48_000_000
_shown: KeptFor[Picture, tuple[Convention, Encoding, Size | None, Size | None], tuple[Shown, bytes]] = KeptFor(
    KEPT_BYTES, lambda held: 3 * math.prod(held[0].picture.size_px) + held[0].rgb.nbytes + len(held[1])
)


def show_encoded(
    picture: Picture,
    convention: Convention = PIXELS,
    encoding: Encoding = "auto",
    size_px: Size | None = None,
    reference: Frame | None = None,
) -> tuple[Shown, bytes]:
    """`show` and its file; the last ones are kept, for samples and second tries that show the same again."""
    key = (convention, encoding, size_px, None if reference is None else reference.size_px)
    held = _shown.get(picture, key)
    if held is None:
        shown = show(picture, convention, size_px, reference)
        held = _shown.keep(picture, key, (shown, encoded(shown.rgb, (picture,), encoding)))
    return held


SCALED_BYTES = 24_000_000
_scaled: KeptFor[Array, Size, Array] = KeptFor(SCALED_BYTES, lambda made: made.nbytes)
"""The last ones: one question after the other shows the same view, with other marks."""


def scaled(picture: Picture, size_px: Size) -> Picture:
    """The same picture in another size, its marks moved along."""
    if size_px == picture.size_px:
        return picture
    sx, sy = (new / old for new, old in zip(size_px, picture.size_px, strict=True))
    frame = scaled_frame(picture.frame, size_px)
    if isinstance(picture, LaterPicture) and picture.source is not None:
        # Straight from the view: enlarged and then shrunk it would be blurred, and take three times as long.
        rgb = resampled(picture.source.rgb, frame)
    else:
        rgb = _resized(picture.rgb, size_px)
    return Picture(picture.name, rgb, frame, None, tuple(_scaled_mark(mark, sx, sy) for mark in picture.marks))


def _resized(rgb: Array, size_px: Size) -> Array:
    held = _scaled.get(rgb, size_px)
    if held is not None:
        return held
    smaller = size_px[0] * size_px[1] < rgb.shape[0] * rgb.shape[1]
    way = cv2.INTER_AREA if smaller else cv2.INTER_CUBIC
    made = np.asarray(cv2.resize(rgb, size_px, interpolation=way))
    made.setflags(write=False)
    return _scaled.keep(rgb, size_px, made)


def scaled_frame(frame: Frame, size_px: Size) -> Frame:
    """The frame of the same picture in another size."""
    sx, sy = (new / old for new, old in zip(size_px, frame.size_px, strict=True))
    matrix = frame.T_view_picture @ np.diag([1 / sx, 1 / sy, 1.0])
    return Frame(frame.view_id, matrix, size_px, _scaled_box(frame.valid, sx, sy))


def _scaled_box(box: Box, sx: float, sy: float) -> Box:
    return Box(box.x0 * sx, box.y0 * sy, box.x1 * sx, box.y1 * sy)


def _scaled_mark(mark: Mark, sx: float, sy: float) -> Mark:
    def at(point: Point) -> Point:
        return point[0] * sx, point[1] * sy

    match mark:
        case BoxMark():
            return replace(mark, box=_scaled_box(mark.box, sx, sy))
        case PointMark():
            return replace(mark, point=at(mark.point))
        case Candidates() | PathMark():
            return replace(mark, points=tuple(at(point) for point in mark.points))
        case Tiles():
            return Tiles(tuple(_scaled_box(box, sx, sy) for box in mark.boxes))
        case TurnMark():
            return replace(mark, centre=at(mark.centre), corners=tuple(at(corner) for corner in mark.corners))
        case LineMark():
            return LineMark(at(mark.start), at(mark.end))
        case RegionMark():
            return replace(mark, corners=tuple(at(point) for point in mark.corners))
        case Axes() | Grid():
            return mark


def _shelves(sizes: Sequence[Size]) -> tuple[list[tuple[int, int]], Size]:
    """Top-left corners of pictures set in rows, in order, and the size of the sheet that holds them."""
    limit = max(SHEET_WIDTH_PX, *(width + 2 * GAP_PX for width, _ in sizes))
    places, x, y, row, widest = [], GAP_PX, HEAD_PX, 0, 0
    for width, height in sizes:
        if x > GAP_PX and x + width + GAP_PX > limit:
            x, y, row = GAP_PX, y + row + HEAD_PX, 0
        places.append((x, y))
        x, row = x + width + GAP_PX, max(row, height)
        widest = max(widest, x)
    return places, (widest, y + row + GAP_PX)
