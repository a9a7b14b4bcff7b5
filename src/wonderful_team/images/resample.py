"""Pixels of a window of an image, enlarged or shrunk by whole amounts, padded where the window leaves the image."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import KeptFor
from wonderful_team.core.pictures import Picture, checked_depth, checked_rgb
from wonderful_team.core.values import LaterPicture, Pixels, View

_PAD_LIGHT, _PAD_DARK = 150, 118  # the two greys of the padding's stripes
_ROUNDS = 2  # of giving a pixel its colour back that enlarging took
_BAND_PX = 60_000
"""So many pixels of the enlarged picture are worked on at once: they stay in the processor's cache, and below 65,536 OpenCV wakes no
other thread, which would use up more time waiting than it saves."""
_DOUBLED_BAND_PX = 100_000
"""The same where whole numbers do."""
_EVEN_FROM = (
    0.5  # share of a picture's pixels that equal all their neighbours, from which those are left out of the work
)
_PAD_PERIOD_PX = 16  # width of a light and a dark stripe together

_KEPT_BYTES = 32_000_000
_kept: KeptFor[Array, tuple[bytes, tuple[int, int], tuple[float, ...]], Array] = KeptFor(
    _KEPT_BYTES, lambda made: made.nbytes
)
"""The last windows of views: one question after the other shows the same one, with other marks."""


def picture_of(view: View, frame: Frame, name: str) -> Picture:
    """The picture that shows `frame` of a view, without marks; its pixels are made when they are first asked for.

    Args:
        view: Where the pixels come from.
        frame: An upright frame (no turn, no mirror) whose window has whole view pixels as its edges.
        name: What the words call the picture.

    Raises:
        ValueError: The frame is turned, mirrored or not on whole pixels.
    """
    _edges(frame)

    def make() -> tuple[Array, Array | None]:
        rgb = resampled(view.rgb, frame)
        depth_m = None if view.depth_m is None else resampled_depth(view.depth_m, frame)
        return checked_rgb(rgb), checked_depth(depth_m, rgb.shape[:2])

    return LaterPicture(name, frame, Pixels(make), source=view)


def same_pixels(one: Picture, other: Picture) -> bool:
    """Whether two pictures show the same. Of cuts of views alike in size, zoom and padding the views' own pixels tell, before they are enlarged."""
    if one.size_px != other.size_px:
        return False
    first, second = (item.source if isinstance(item, LaterPicture) else None for item in (one, other))
    if first is None or second is None or not _alike(one.frame, other.frame):
        return one.hash == other.hash
    same_window = np.array_equal(one.frame.T_view_picture, other.frame.T_view_picture)
    if same_window and first.has_the_pixels_of(second):
        return True
    return np.array_equal(_cut(first.rgb, one.frame)[0], _cut(second.rgb, other.frame)[0])


def _alike(one: Frame, other: Frame) -> bool:
    """Whether two frames enlarge as much, and show padding at the same pixels."""
    zoom = np.array_equal(one.T_view_picture[:2, :2], other.T_view_picture[:2, :2])
    return zoom and one.valid.as_tuple == other.valid.as_tuple


def resampled(rgb: Array, frame: Frame) -> Array:
    """Colours of the frame's window, shape (height, width, 3), uint8, read-only; padding is striped grey."""
    if rgb.flags.writeable:
        return _colours(rgb, frame)
    key = (frame.T_view_picture.tobytes(), frame.size_px, frame.valid.as_tuple)
    held = _kept.get(rgb, key)
    return held if held is not None else _kept.keep(rgb, key, _colours(rgb, frame))


def _colours(rgb: Array, frame: Frame) -> Array:
    cut, zoom_x, zoom_y = _cut(rgb, frame)
    size = frame.size_px
    if zoom_x >= 1 and zoom_y >= 1:
        image = _enlarged(cut, size)
    else:
        image = np.asarray(cv2.resize(cut, size, interpolation=cv2.INTER_AREA))
    real = valid_mask(frame)
    if not real.all():
        image = np.where(real[..., None], image, _padding(size))
    image.setflags(write=False)
    return image


def resampled_depth(depth_m: Array, frame: Frame) -> Array:
    """Depth of the frame's window [m], shape (height, width), nearest pixel; NaN in the padding."""
    cut, _, _ = _cut(depth_m, frame)
    image = np.asarray(cv2.resize(cut, frame.size_px, interpolation=cv2.INTER_NEAREST_EXACT))
    return np.where(valid_mask(frame), image, np.float32(np.nan))


def valid_mask(frame: Frame) -> Array:
    """Which picture pixels show the view (their centre lies in `frame.valid`), shape (height, width), bool."""
    width, height = frame.size_px
    across, down = np.arange(width) + 0.5, np.arange(height) + 0.5
    valid = frame.valid
    columns = (across >= valid.x0 - 1e-6) & (across <= valid.x1 + 1e-6)
    rows = (down >= valid.y0 - 1e-6) & (down <= valid.y1 + 1e-6)
    return np.asarray(rows[:, None] & columns[None, :])


def _edges(frame: Frame) -> list[int]:
    """The frame's window in whole view pixels: x0, y0, x1, y1.

    Raises:
        ValueError: It is turned, mirrored or not on whole pixels.
    """
    matrix = frame.T_view_picture
    if matrix[0, 1] or matrix[1, 0] or matrix[0, 0] <= 0 or matrix[1, 1] <= 0:
        raise ValueError("picture frames must be upright: neither turned nor mirrored")
    window = frame.box_to_view(frame.whole_box)
    edges = [round(value) for value in window.as_tuple]
    if any(abs(edge - value) > 1e-3 for edge, value in zip(edges, window.as_tuple, strict=True)):
        raise ValueError(f"window {window.as_tuple} must have whole view pixels as its edges")
    return edges


def _cut(image: Array, frame: Frame) -> tuple[Array, float, float]:
    """The window's own pixels, the image's border repeated outside, and the zoom along x and y."""
    x0, y0, x1, y1 = _edges(frame)
    matrix = frame.T_view_picture
    height, width = image.shape[:2]
    columns = np.clip(np.arange(x0, x1), 0, width - 1)
    rows = np.clip(np.arange(y0, y1), 0, height - 1)
    if x0 >= 0 and y0 >= 0 and x1 <= width and y1 <= height:
        cut = np.ascontiguousarray(image[y0:y1, x0:x1])
    else:
        cut = np.ascontiguousarray(image[np.ix_(rows, columns)])
    return cut, 1 / matrix[0, 0], 1 / matrix[1, 1]


def _enlarged(cut: Array, size: tuple[int, int]) -> Array:
    """Cubic enlargement held between the darkest and lightest neighbour, so that edges get no false halo.

    By a whole factor, what becomes of a pixel keeps its colour on average: shrunk again, the picture is the cut.
    """
    height, width = cut.shape[:2]
    if (width, height) == size:
        return cut
    image = np.asarray(cv2.resize(cut, size, interpolation=cv2.INTER_CUBIC))
    around = np.ones((3, 3), np.uint8)
    low, high = cv2.erode(cut, around), cv2.dilate(cut, around)
    if size[0] % width or size[1] % height:
        _hold_inplace(image, *(cv2.resize(part, size, interpolation=cv2.INTER_NEAREST_EXACT) for part in (low, high)))
        return image
    uneven = _most_of_colours(cv2.absdiff(high, low))
    if cv2.countNonZero(uneven) > (1 - _EVEN_FROM) * height * width:
        doubled = size == (2 * width, 2 * height)
        (_keep_doubled_inplace if doubled else _keep_bands_inplace)(image, cut, low, high)
        return image
    # A pixel that equals all its neighbours stays as it is, all over.
    rows, columns = np.nonzero(uneven)
    even = np.asarray(cv2.resize(cut, size, interpolation=cv2.INTER_NEAREST_EXACT))
    at_once = max(1, _BAND_PX // ((size[0] // width) * (size[1] // height)))
    for first in range(0, len(rows), at_once):
        own = rows[first : first + at_once], columns[first : first + at_once]
        _keep_pixels(image, cut, low, high, own, even)
    return even


def _most_of_colours(rgb: Array) -> Array:
    red, green, blue = cv2.split(rgb)
    return np.asarray(cv2.max(cv2.max(red, green), blue))


def _keep_pixels(image: Array, cut: Array, low: Array, high: Array, own: tuple[Array, Array], into: Array) -> None:
    """`_keep_colours_inplace` for some pixels of `cut`, rows and columns, laid side by side; what becomes of them goes `into` a picture."""
    height, width = cut.shape[:2]
    down, across = image.shape[0] // height, image.shape[1] // width
    rows, columns = own
    blocks = image.reshape(height, down, width, across * 3)[rows, :, columns].transpose(1, 0, 2)
    packed = np.ascontiguousarray(blocks).reshape(down, -1, 3)
    _keep_colours_inplace(packed, cut[own][None], low[own][None], high[own][None])
    into.reshape(height, down, width, across * 3)[rows, :, columns] = packed.reshape(blocks.shape).transpose(1, 0, 2)


def _keep_bands_inplace(image: Array, cut: Array, low: Array, high: Array) -> None:
    """`_keep_colours_inplace` for a whole picture, a band of it at a time."""
    height = cut.shape[0]
    zoom = image.shape[0] // height
    rows = max(1, _BAND_PX // (image.shape[1] * zoom))
    for first in range(0, height, rows):
        own = slice(first, first + rows)
        _keep_colours_inplace(image[first * zoom : (first + rows) * zoom], cut[own], low[own], high[own])


def _keep_doubled_inplace(image: Array, cut: Array, low: Array, high: Array) -> None:
    """`_keep_bands_inplace` for a picture of twice the size: the same to the bit, in little more than half the time.

    A quarter of a sum is then an exact number in so many bits below the point, so whole numbers do, and half as wide ones. Two pixels
    side by side are one 16-bit number; apart from each other and from the other colours, all that is added stands side by side.
    """
    height, width = cut.shape[:2]
    bits = 2 * _ROUNDS
    rows = min(height, max(1, _DOUBLED_BAND_PX // (4 * width)))
    # Side, row, above or below, column.
    all_values = np.empty((2, rows, 2, width), np.int16)
    room = np.empty_like(all_values)
    small = np.empty((4, rows, 1, width), np.int16)
    for first in range(0, height, rows):
        band = image[2 * first : 2 * (first + rows)]
        planes = cv2.split(band)
        values, odd = all_values[:, : len(band) // 2], room[:, : len(band) // 2]
        known, least, most, gap = small[:, : len(band) // 2]
        for plane, *parts in zip(
            planes, *(cv2.split(part[first : first + rows]) for part in (cut, low, high)), strict=True
        ):
            pairs = plane.view(np.uint16).reshape(-1, 2, width)
            for part, place in zip(parts, (known, least, most), strict=True):
                np.left_shift(part[:, None], bits, out=place, dtype=np.int16)
            np.bitwise_and(pairs, 255, out=values[0].view(np.uint16))
            np.right_shift(pairs, 8, out=values[1].view(np.uint16))
            np.left_shift(values, bits, out=values)
            np.minimum(np.maximum(values, least, out=values), most, out=values)
            for _ in range(_ROUNDS):
                np.add(values[0, :, :1], values[0, :, 1:], out=gap)
                np.add(gap, values[1, :, :1], out=gap)
                np.add(gap, values[1, :, 1:], out=gap)
                np.subtract(known, np.right_shift(gap, 2, out=gap), out=gap)
                np.add(values, gap, out=values)
                np.minimum(np.maximum(values, least, out=values), most, out=values)
            # To the nearest whole number, and from the middle to the even one.
            np.bitwise_and(np.right_shift(values, bits, out=odd), 1, out=odd)
            np.add(values, np.add(odd, (1 << (bits - 1)) - 1, out=odd), out=values)
            left, right = np.right_shift(values, bits, out=values).view(np.uint16)
            np.bitwise_or(left, np.left_shift(right, 8, out=right), out=pairs)
        cv2.merge(planes, dst=band)


def _keep_colours_inplace(enlarged: Array, cut: Array, low: Array, high: Array) -> None:
    """Hold an enlargement by a whole factor between `low` and `high`, and give each pixel of `cut` its colour on average."""
    size, own_size = (enlarged.shape[1], enlarged.shape[0]), (cut.shape[1], cut.shape[0])
    least, most = (
        cv2.resize(part, size, interpolation=cv2.INTER_NEAREST_EXACT).astype(np.float32) for part in (low, high)
    )
    image = enlarged.astype(np.float32)
    _hold_inplace(image, least, most)
    for _ in range(_ROUNDS):
        gap = cut - cv2.resize(image, own_size, interpolation=cv2.INTER_AREA)
        np.add(image, cv2.resize(gap, size, interpolation=cv2.INTER_NEAREST_EXACT), out=image)
        _hold_inplace(image, least, most)
    enlarged[:] = np.rint(image, out=image)


def _hold_inplace(image: Array, low: Array, high: Array) -> None:
    # Several times as fast as numpy's clip.
    cv2.min(cv2.max(image, low, dst=image), high, dst=image)


def _padding(size: tuple[int, int]) -> Array:
    across, down = np.arange(size[0])[None, :, None], np.arange(size[1])[:, None, None]
    dark = (across + down) % _PAD_PERIOD_PX < _PAD_PERIOD_PX // 2
    return np.where(dark, np.uint8(_PAD_DARK), np.uint8(_PAD_LIGHT)).repeat(3, axis=2)


def whole_pixels(box: Box) -> Box:
    """The smallest box with whole-pixel edges that holds `box`; tiny excesses are rounded off."""
    low_x, low_y = np.floor(box.x0 + 1e-6), np.floor(box.y0 + 1e-6)
    high_x, high_y = np.ceil(box.x1 - 1e-6), np.ceil(box.y1 - 1e-6)
    return Box(low_x, low_y, max(high_x, low_x + 1), max(high_y, low_y + 1))
