"""Picture files become arrays, or a BadPictureError that says what is wrong and what would be valid."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import IO

import numpy as np
from PIL import Image, ImageOps, UnidentifiedImageError

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import BadPictureError

MIN_PICTURE_SIDE_PX = 16
"""Smaller pictures hold nothing that could be found."""
MAX_PICTURE_PIXELS = 64_000_000
"""Larger files are refused before they are unpacked: no camera on a robot makes them."""
MAX_PICTURE_ASPECT = 20
"""Longest side over shortest."""

_VALID_PICTURE = "a PNG, JPEG, WebP, BMP, TIFF or GIF picture"
FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TIFF", "GIF")
"""What is read; anything else that Pillow knows may start programs (EPS: Ghostscript), whatever the file is called."""
OWN_FORMATS = ("PNG", "JPEG")
"""What our own folders and files hold."""
GREY_16 = ("I;16", "I;16B", "I;16L", "I;16N", "I")


def open_picture(file: str | os.PathLike[str] | IO[bytes], formats: tuple[str, ...] = FORMATS) -> Image.Image:
    """Open a picture of one of these formats, told by its content; every picture is opened here.

    Raises:
        UnidentifiedImageError: It is none of them.
        OSError: It cannot be read.
    """
    return Image.open(file, formats=formats)


def load_picture(path: str | os.PathLike[str]) -> Array:
    """Colours of a picture file, upright as a viewer shows it.

    Honours the EXIF orientation; lays transparency over white; widens grey, palette and CMYK; brings 16 bits to 8.

    Returns:
        Read-only image, shape (H, W, 3), uint8.

    Raises:
        BadPictureError: Missing, a folder, empty, damaged, not a picture, too small or too large; names the path.
    """
    file = checked_file(Path(path), _VALID_PICTURE)
    try:
        with warnings.catch_warnings():
            # Pillow warns of large and slightly odd files; ours are bounded by MAX_PICTURE_PIXELS.
            warnings.simplefilter("ignore")
            with open_picture(file) as opened:
                check_size(file, opened.size)
                rgb = _as_rgb(ImageOps.exif_transpose(opened), file)
    except UnidentifiedImageError:
        raise bad_file(file, "it is not a picture", _VALID_PICTURE) from None
    except Image.DecompressionBombError:
        raise bad_file(file, "it has far too many pixels", size_rule()) from None
    except (OSError, SyntaxError, ValueError, EOFError, IndexError) as problem:
        raise bad_file(file, f"it is damaged ({problem})", f"a complete file: {_VALID_PICTURE}") from None
    rgb.setflags(write=False)
    return rgb


def _as_rgb(image: Image.Image, file: Path) -> Array:
    if image.mode in GREY_16:
        grey = np.asarray(image).astype(np.int64)
        if grey.min() < 0 or grey.max() > 65535:
            raise bad_file(file, f"its grey values reach {int(grey.max())}", "8 or 16 bits per colour")
        eight = ((grey * 255 + 32767) // 65535).astype(np.uint8)
        return np.repeat(eight[..., None], 3, axis=2)
    if image.mode == "F":
        raise bad_file(file, "its values are floating-point numbers", "8 or 16 bits per colour")
    if "A" in image.getbands() or "a" in image.getbands() or "transparency" in image.info:
        layer = image.convert("RGBA")
        ground = Image.new("RGBA", layer.size, (255, 255, 255, 255))
        image = Image.alpha_composite(ground, layer)
    return np.array(image.convert("RGB"), dtype=np.uint8)


def checked_file(file: Path, valid: str, what: str = "picture") -> Path:
    """The same path, once it is known to hold something.

    Raises:
        BadPictureError: Missing, a folder, not a regular file, empty, or unreadable.
    """
    try:
        if file.is_dir():
            raise bad_file(file, "it is a folder", valid, what)
        if not file.exists():
            raise bad_file(file, "there is no such file (it does not exist)", valid, what)
        if not file.is_file():
            raise bad_file(file, "it is not a regular file", valid, what)
        if file.stat().st_size == 0:
            raise bad_file(file, "the file is empty (0 bytes)", valid, what)
    except OSError as problem:
        raise bad_file(file, f"it cannot be read ({problem.strerror or problem})", valid, what) from None
    return file


def check_size(file: Path, size: tuple[int, int]) -> None:
    width, height = size
    if min(size) < MIN_PICTURE_SIDE_PX or width * height > MAX_PICTURE_PIXELS or _aspect(size) > MAX_PICTURE_ASPECT:
        raise bad_file(file, f"it is {width} x {height} px", size_rule())


def _aspect(size: tuple[int, int]) -> float:
    return max(size) / max(1, min(size))


def size_rule() -> str:
    return (
        f"at least {MIN_PICTURE_SIDE_PX} px on each side, at most {MAX_PICTURE_PIXELS // 1_000_000} million pixels, "
        f"sides no more than 1:{MAX_PICTURE_ASPECT}"
    )


def bad_file(file: Path, reason: str, valid: str, what: str = "picture") -> BadPictureError:
    """The error that says what is wrong with a file and what would be valid."""
    return BadPictureError(f"{what} {str(file)!r} cannot be used: {reason}; valid: {valid}")
