"""What makes metres of pixels: a camera file, the table's four corners, a depth file."""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from PIL import Image, UnidentifiedImageError
from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from wonderful_team.core.geometry import AffineCamera, Camera, PinholeCamera, PlanarCamera, Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import NO_WORKSPACE, Limits
from wonderful_team.errors import BadPictureError, ConfigError
from wonderful_team.images.load import GREY_16, bad_file, check_size, checked_file, open_picture, size_rule

NEAREST_DEPTH_M, FARTHEST_DEPTH_M = 0.02, 50.0
"""Depth whose middle value lies outside is in a wrong unit and refused; single values outside count as unknown."""
VALID_DEPTH = "a 16-bit grey PNG in millimetres, or a .npy file of floats in metres"
REACH_M = 0.5
"""How high above the marked table the workspace of `--corners` ends [m]: a tabletop arm's reach upward."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """A camera and the workspace that its metres are checked against."""

    camera: Camera
    limits: Limits


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", defer_build=True)


class _Workspace(_Strict):
    low: tuple[float, float, float]
    high: tuple[float, float, float]


class CameraFile(_Strict):
    """What a camera file (JSON) holds.

    Attributes:
        K, T_base_cam: A pinhole camera: intrinsics [px], 3 x 3, and its pose in the base frame, 4 x 4.
        matrix: Instead of both, an affine camera: 3 x 4, from (x, y, z, 1) [m] to (u [px], v [px], depth [m]).
        size_px: Width and height of the pictures it was calibrated for.
        workspace_m: Corners of the region that the gate admits, base frame; without it the gate cannot check that.
    """

    K: list[list[float]] | None = None
    T_base_cam: list[list[float]] | None = None
    matrix: list[list[float]] | None = None
    size_px: tuple[int, int]
    workspace_m: _Workspace | None = None

    @model_validator(mode="after")
    def _one_camera(self) -> CameraFile:
        pinhole = self.K is not None and self.T_base_cam is not None
        if pinhole == (self.matrix is not None) or (self.matrix is not None and (self.K or self.T_base_cam)):
            raise ValueError("give either K with T_base_cam (pinhole) or matrix (affine)")
        for name, value in self.model_dump(exclude_none=True).items():
            numbers = np.concatenate(
                [np.ravel(one) for one in (value.values() if isinstance(value, dict) else [value])]
            )
            if not (np.abs(numbers.astype(np.float64)) <= LARGEST_NUMBER).all():
                raise ValueError(f"{name} holds {numbers.tolist()}; every number lies within ±{LARGEST_NUMBER:g}")
        return self


LARGEST_NUMBER = 1e6
"""Largest number of a camera file [px or m]: no camera on a robot has larger, and products of such numbers stay numbers."""
CAMERA_FILE_FORM = (
    '{"K": 3x3 [px], "T_base_cam": 4x4, "size_px": [width, height], "workspace_m": {"low": [x, y, z], "high": [x, y, z]}}'
    ' or, for an affine camera, "matrix": 3x4 instead of K and T_base_cam'
)


def load_camera(path: str | os.PathLike[str], picture_size_px: tuple[int, int]) -> Calibration:
    """Read a camera file.

    Raises:
        ConfigError: The file is missing or malformed, or belongs to pictures of another size.
    """
    try:
        held = CameraFile.model_validate(json.loads(Path(path).read_text(encoding="utf-8")))
    except OSError as error:
        raise ConfigError(f"camera file {str(path)!r}: {error.strerror or error}") from error
    except json.JSONDecodeError as error:
        raise ConfigError(f"camera file {str(path)!r} is not JSON: {error}; valid: {CAMERA_FILE_FORM}") from error
    except RecursionError as error:
        raise ConfigError(f"camera file {str(path)!r} is nested too deeply; valid: {CAMERA_FILE_FORM}") from error
    except (ValidationError, UnicodeDecodeError) as error:
        raise ConfigError(f"camera file {str(path)!r}: {_first_problem(error)}; valid: {CAMERA_FILE_FORM}") from error
    if held.size_px != picture_size_px:
        raise ConfigError(
            f"camera file {str(path)!r} is for pictures of {held.size_px[0]} x {held.size_px[1]} px, but the picture has "
            f"{picture_size_px[0]} x {picture_size_px[1]} px"
        )
    try:
        camera: Camera = (
            AffineCamera(np.array(held.matrix))
            if held.matrix is not None
            else PinholeCamera(np.array(held.K), _pose(held.T_base_cam))
        )
        space = held.workspace_m
        return Calibration(camera, NO_WORKSPACE if space is None else Limits(space.low, space.high))
    except ValueError as error:
        raise ConfigError(f"camera file {str(path)!r}: {error}") from error


def corners_camera(text: str, picture_size_px: tuple[int, int]) -> Calibration:
    """A camera from the table's four corners in the picture.

    Two forms, corners clockwise from the picture's top left:
    "x,y x,y x,y x,y=WxH": pixels, then the table's width (along the first edge) and height [m]; the base frame then
    starts at the first corner with x down the picture, y to the right, z up.
    "x,y=X,Y x,y=X,Y x,y=X,Y x,y=X,Y": pixels with the point of the base frame [m] that each one shows.

    Raises:
        ConfigError: Another form, corners outside the picture, or three on one line.
    """
    pixels, metres = _read_corners(text)
    width, height = picture_size_px
    outside = [corner for corner in pixels if not (0 <= corner[0] <= width and 0 <= corner[1] <= height)]
    if outside:
        raise ConfigError(
            f"corners: {outside[0][0]:g},{outside[0][1]:g} lies outside the picture of {width} x {height} px"
        )
    camera = PlanarCamera.from_corners(pixels, metres)
    low, high = np.min(metres, axis=0), np.max(metres, axis=0)
    return Calibration(camera, Limits((float(low[0]), float(low[1]), -0.01), (float(high[0]), float(high[1]), REACH_M)))


_CORNER_FORMS = '"x,y x,y x,y x,y=WxH" (pixels clockwise from the top left; table in metres) or "x,y=X,Y …" four times'


def _read_corners(text: str) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    words = text.replace(";", " ").split()
    if len(words) != 4:
        raise ConfigError(f"corners {text!r}: four are needed, got {len(words)}; valid: {_CORNER_FORMS}")
    pixels: list[tuple[float, float]] = []
    metres: list[tuple[float, float]] = []
    for position, word in enumerate(words):
        pixel, _, metre = word.partition("=")
        pixels.append(_pair(pixel, ",", text))
        if "," in metre:
            metres.append(_pair(metre, ",", text))
        elif position == 3 and metre and not metres:
            width, height = _pair(metre, "x", text)
            if width <= 0 or height <= 0:
                raise ConfigError(f"corners {text!r}: the table's size {width:g} x {height:g} m must be positive")
            metres = [(0.0, 0.0), (0.0, width), (height, width), (height, 0.0)]
    if len(metres) != 4:
        raise ConfigError(f"corners {text!r}: metres are missing; valid: {_CORNER_FORMS}")
    return pixels, metres


def _pair(text: str, separator: str, whole: str) -> tuple[float, float]:
    try:
        first, second = (float(part) for part in text.split(separator))
    except ValueError:
        raise ConfigError(f"corners {whole!r}: {text!r} is not two numbers; valid: {_CORNER_FORMS}") from None
    if not (np.isfinite(first) and np.isfinite(second)):
        raise ConfigError(f"corners {whole!r}: {text!r} must be finite")
    return first, second


def load_depth(path: str | os.PathLike[str], size_px: tuple[int, int] | None = None) -> Array:
    """Depth along the optical axis from a file: 16-bit PNG [mm] or .npy [m].

    Args:
        path: The file.
        size_px: Width and height of the picture that it belongs to; None for any size.

    Returns:
        Read-only depth [m], shape (H, W), float32; NaN where the file says 0, NaN, infinity, less than 0, or a distance
        outside `NEAREST_DEPTH_M` to `FARTHEST_DEPTH_M`.

    Raises:
        BadPictureError: As for `load_picture`; also 8-bit pictures, other array types, another size than the picture's,
            depth known nowhere, and a middle value outside the range.
    """
    file = checked_file(Path(path), VALID_DEPTH, "depth file")
    depth_m = _depth_from_npy(file) if file.suffix.lower() == ".npy" else _depth_from_png(file)
    height, width = depth_m.shape
    if size_px is not None and (width, height) != size_px:
        raise _bad(
            file, f"its shape is {(height, width)} (height, width)", f"the picture's, {(size_px[1], size_px[0])}"
        )
    known = np.isfinite(depth_m) & (depth_m > 0)
    if not known.any():
        raise _bad(file, "it holds no depth: every value is 0, NaN or negative", VALID_DEPTH)
    middle = float(np.median(depth_m[known]))
    if middle > FARTHEST_DEPTH_M:
        raise _bad(
            file,
            f"its middle value would be {middle:.0f} m, more than {FARTHEST_DEPTH_M:.0f} m: a wrong unit",
            VALID_DEPTH,
        )
    if middle < NEAREST_DEPTH_M:
        raise _bad(
            file, f"its middle value would be {middle:.2g} m, less than {NEAREST_DEPTH_M} m: a wrong unit", VALID_DEPTH
        )
    near = known & (depth_m >= NEAREST_DEPTH_M) & (depth_m <= FARTHEST_DEPTH_M)
    depth = np.where(near, depth_m, np.nan).astype(np.float32)
    depth.setflags(write=False)
    return depth


def _depth_from_npy(file: Path) -> Array:
    try:
        depth = np.load(file, allow_pickle=False)
    except (OSError, ValueError, EOFError, MemoryError, OverflowError) as problem:
        raise _bad(file, f"it is not a .npy array ({problem})", VALID_DEPTH) from None
    if not isinstance(depth, np.ndarray) or not np.issubdtype(depth.dtype, np.floating):
        kind = getattr(depth, "dtype", type(depth).__name__)
        raise _bad(file, f"its values are {kind}, whose unit is not known", VALID_DEPTH)
    if depth.ndim == 3 and depth.shape[2] == 1:
        depth = depth[..., 0]
    if depth.ndim != 2 or depth.size == 0:
        raise _bad(file, f"its shape is {depth.shape}", "shape (height, width)")
    return np.asarray(depth, np.float64)


def _depth_from_png(file: Path) -> Array:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with open_picture(file, ("PNG", "TIFF")) as opened:
                check_size(file, opened.size)
                if opened.mode not in GREY_16:
                    raise _bad(file, f"it is a picture of mode {opened.mode}, not of depth", VALID_DEPTH)
                return np.asarray(np.asarray(opened).astype(np.float64) / 1000.0)
    except UnidentifiedImageError:
        raise _bad(file, "it is not a picture", VALID_DEPTH) from None
    except Image.DecompressionBombError:
        raise _bad(file, "it has far too many pixels", size_rule()) from None
    except (OSError, SyntaxError, ValueError, EOFError) as problem:
        raise _bad(file, f"it is damaged ({problem})", VALID_DEPTH) from None


def _bad(file: Path, reason: str, valid: str) -> BadPictureError:
    return bad_file(file, reason, valid, "depth file")


def _pose(matrix: Any) -> Pose:
    try:
        return Pose.from_matrix(matrix)
    except ValueError as error:
        raise ValueError(f"T_base_cam: {error}") from None


def _first_problem(error: ValidationError | UnicodeDecodeError) -> str:
    if isinstance(error, UnicodeDecodeError):
        return "not a text file"
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    return f"{where + ': ' if where else ''}{first['msg'].removeprefix('Value error, ')}"


PathLike: TypeAlias = str | Path
