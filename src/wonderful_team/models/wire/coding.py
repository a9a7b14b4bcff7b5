"""The file that a picture is sent as: PNG where every pixel counts or costs nothing, JPEG for photos, which are noise for the most part."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias, get_args

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.images import to_jpeg
from wonderful_team.images.grain import is_photo
from wonderful_team.images.png import fast_png

Encoding: TypeAlias = Literal["auto", "png", "jpeg"]
ENCODINGS: tuple[Encoding, ...] = get_args(Encoding)
PHOTO_QUALITY = 90
"""Of JPEG files, with full colour (4:4:4): a fifth to a ninth of the bytes of a PNG of the same photo."""


def encoded(rgb: Array, shown: Sequence[Picture], encoding: Encoding = "auto") -> bytes:
    """A picture's file.

    Args:
        rgb: What is sent, marks drawn, shape (H, W, 3), uint8.
        shown: The pictures that it shows: one, or all those on a sheet.
        encoding: "auto": photos as JPEG, unless tick labels are drawn on them, which stay sharp to the pixel; all else as PNG.
    """
    if encoding == "auto":
        labelled = any(isinstance(mark, Axes) for picture in shown for mark in picture.marks)
        encoding = "jpeg" if not labelled and is_photo(rgb) else "png"
    return to_jpeg(rgb, PHOTO_QUALITY) if encoding == "jpeg" else fast_png(rgb)
