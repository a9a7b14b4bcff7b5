"""Picture and depth files become arrays, or a BadPictureError that says what is wrong and what would be valid."""

from __future__ import annotations

import os
import warnings
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps, UnidentifiedImageError

from wonderful_team.errors import BadPictureError
from wonderful_team.geometry.arrays import Array

MIN_PICTURE_SIDE_PX = 16
"""Smaller pictures hold nothing that could be found."""
MAX_PICTURE_PIXELS = 64_000_000
"""Larger files are refused before they are unpacked: no camera on a robot makes them."""
MAX_PICTURE_ASPECT = 20
"""Longest side over shortest."""
FARTHEST_DEPTH_M = 50.0
"""Depth whose middle value is larger is taken for millimetres and refused."""

_VALID_PICTURE = "a PNG, JPEG, WebP, BMP, TIFF or GIF picture"
_VALID_DEPTH = "a 16-bit grey PNG in millimetres, or a .npy file of floats in metres"
_GREY_16 = ("I;16", "I;16B", "I;16L", "I;16N", "I")


def load_picture(path: str | os.PathLike[str]) -> Array:
    """Colours of a picture file, upright as a viewer shows it.

    Honours the EXIF orientation; lays transparency over white; widens grey, palette and CMYK; brings 16 bits to 8.

    Returns:
        Read-only image, shape (H, W, 3), uint8.

    Raises:
        BadPictureError: Missing, a folder, empty, damaged, not a picture, too small or too large; names the path.
    """
    file = _checked_file(Path(path), _VALID_PICTURE)
    try:
        with warnings.catch_warnings():
            # Pillow warns of large and slightly odd files; ours are bounded by MAX_PICTURE_PIXELS.
            warnings.simplefilter("ignore")
            with Image.open(file) as opened:
                _check_size(file, opened.size)
                rgb = _as_rgb(ImageOps.exif_transpose(opened), file)
    except UnidentifiedImageError:
        raise _bad(file, "it is not a picture", _VALID_PICTURE) from None
    except Image.DecompressionBombError:
        raise _bad(file, "it has far too many pixels", _size_rule()) from None
    except (OSError, SyntaxError, ValueError, EOFError, IndexError) as problem:
        raise _bad(file, f"it is damaged ({problem})", f"a complete file: {_VALID_PICTURE}") from None
    rgb.setflags(write=False)
    return rgb


def load_depth(path: str | os.PathLike[str]) -> Array:
    """Depth along the optical axis from a file: 16-bit PNG [mm] or .npy [m].

    Returns:
        Read-only depth [m], shape (H, W), float32; NaN where the file says 0, NaN, infinity or less than 0.

    Raises:
        BadPictureError: As for `load_picture`; also 8-bit pictures, other array types, and depth known nowhere.
    """
    file = _checked_file(Path(path), _VALID_DEPTH)
    depth_m = _depth_from_npy(file) if file.suffix.lower() == ".npy" else _depth_from_png(file)
    known = np.isfinite(depth_m) & (depth_m > 0)
    if not known.any():
        raise _bad(file, "it holds no depth: every value is 0, NaN or negative", _VALID_DEPTH)
    middle = float(np.median(depth_m[known]))
    if middle > FARTHEST_DEPTH_M:
        raise _bad(
            file, f"its middle value would be {middle:.0f} m, more than {FARTHEST_DEPTH_M:.0f} m: a wrong unit",
            _VALID_DEPTH,
        )  # fmt: skip
    depth = np.where(known, depth_m, np.nan).astype(np.float32)
    depth.setflags(write=False)
    return depth


def _as_rgb(image: Image.Image, file: Path) -> Array:
    if image.mode in _GREY_16:
        grey = np.asarray(image).astype(np.int64)
        if grey.min() < 0 or grey.max() > 65535:
            raise _bad(file, f"its grey values reach {int(grey.max())}", "8 or 16 bits per colour")
        eight = ((grey * 255 + 32767) // 65535).astype(np.uint8)
        return np.repeat(eight[..., None], 3, axis=2)
    if image.mode == "F":
        raise _bad(file, "its values are floating-point numbers", "8 or 16 bits per colour")
    if "A" in image.getbands() or "a" in image.getbands() or "transparency" in image.info:
        layer = image.convert("RGBA")
        ground = Image.new("RGBA", layer.size, (255, 255, 255, 255))
        image = Image.alpha_composite(ground, layer)
    return np.array(image.convert("RGB"), dtype=np.uint8)


def _depth_from_npy(file: Path) -> Array:
    try:
        depth = np.load(file, allow_pickle=False)
    except (OSError, ValueError, EOFError) as problem:
        raise _bad(file, f"it is not a .npy array ({problem})", _VALID_DEPTH) from None
    if not isinstance(depth, np.ndarray) or not np.issubdtype(depth.dtype, np.floating):
        kind = getattr(depth, "dtype", type(depth).__name__)
        raise _bad(file, f"its values are {kind}, whose unit is not known", _VALID_DEPTH)
    if depth.ndim == 3 and depth.shape[2] == 1:
        depth = depth[..., 0]
    if depth.ndim != 2 or depth.size == 0:
        raise _bad(file, f"its shape is {depth.shape}", "shape (height, width)")
    return np.asarray(depth, np.float64)


def _depth_from_png(file: Path) -> Array:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(file) as opened:
                _check_size(file, opened.size)
                if opened.mode not in _GREY_16:
                    raise _bad(file, f"it is a picture of mode {opened.mode}, not of depth", _VALID_DEPTH)
                return np.asarray(np.asarray(opened).astype(np.float64) / 1000.0)
    except UnidentifiedImageError:
        raise _bad(file, "it is not a picture", _VALID_DEPTH) from None
    except Image.DecompressionBombError:
        raise _bad(file, "it has far too many pixels", _size_rule()) from None
    except (OSError, SyntaxError, ValueError, EOFError) as problem:
        raise _bad(file, f"it is damaged ({problem})", _VALID_DEPTH) from None


def _checked_file(file: Path, valid: str) -> Path:
    try:
        if file.is_dir():
            raise _bad(file, "it is a folder", valid)
        if not file.exists():
            raise _bad(file, "there is no such file", valid)
        if not file.is_file():
            raise _bad(file, "it is not a regular file", valid)
        if file.stat().st_size == 0:
            raise _bad(file, "the file is empty (0 bytes)", valid)
    except OSError as problem:
        raise _bad(file, f"it cannot be read ({problem.strerror or problem})", valid) from None
    return file


def _check_size(file: Path, size: tuple[int, int]) -> None:
    width, height = size
    if min(size) < MIN_PICTURE_SIDE_PX or width * height > MAX_PICTURE_PIXELS or _aspect(size) > MAX_PICTURE_ASPECT:
        raise _bad(file, f"it is {width} x {height} px", _size_rule())


def _aspect(size: tuple[int, int]) -> float:
    return max(size) / max(1, min(size))


def _size_rule() -> str:
    return (
        f"at least {MIN_PICTURE_SIDE_PX} px on each side, at most {MAX_PICTURE_PIXELS // 1_000_000} million pixels, "
        f"sides no more than 1:{MAX_PICTURE_ASPECT}"
    )


def _bad(file: Path, reason: str, valid: str) -> BadPictureError:
    return BadPictureError(f"picture {str(file)!r} cannot be used: {reason}; valid: {valid}")
