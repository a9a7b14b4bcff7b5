"""Photos and what makes metres of their pixels: a depth file, a camera file, or the table's four corners."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from pydantic import BaseModel, ConfigDict, ValidationError, model_validator

from wonderful_team.errors import BadPictureError, ConfigError
from wonderful_team.geometry import AffineCamera, Box, Camera, PinholeCamera, PlanarCamera, Pose
from wonderful_team.geometry.arrays import Array
from wonderful_team.types import NO_WORKSPACE, Instruction, KeepOut, Limits, Slot, SlotKind, View

PathLike: TypeAlias = str | Path
REACH_M = 0.5
"""How high above the marked table the workspace of `--corners` ends [m]: a tabletop arm's reach upward."""
SLOT_KINDS: tuple[SlotKind, ...] = ("object", "scene", "frame", "before", "after")


@dataclass(frozen=True, eq=False)
class Calibration:
    """A camera and the workspace that its metres are checked against."""

    camera: Camera
    limits: Limits


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid")


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
        return self


CAMERA_FILE_FORM = (
    '{"K": 3x3 [px], "T_base_cam": 4x4, "size_px": [width, height], "workspace_m": {"low": [x, y, z], "high": [x, y, z]}}'
    ' or, for an affine camera, "matrix": 3x4 instead of K and T_base_cam'
)


def load_camera(path: PathLike, picture_size_px: tuple[int, int]) -> Calibration:
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
            else PinholeCamera(np.array(held.K), _pose(np.array(held.T_base_cam)))
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


def load_depth(path: PathLike, size_px: tuple[int, int]) -> Array:
    """Distance along the optical axis, shape (H, W) [m]: a .npy file in metres, or a 16-bit PNG in millimetres (0 = unknown).

    Raises:
        BadPictureError: Missing or unreadable, of another size than the picture, or not one number a pixel.
    """
    import cv2

    file = Path(path)
    if not file.is_file():
        raise BadPictureError(f"depth file {str(path)!r} does not exist")
    try:
        if file.suffix == ".npy":
            depth = np.asarray(np.load(file, allow_pickle=False), dtype=np.float32)
        else:
            raw = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
            if raw is None or raw.dtype != np.uint16:
                kind = "unreadable" if raw is None else f"{raw.dtype}"
                raise BadPictureError(f"depth file {str(path)!r} is {kind}; valid: 16-bit PNG in mm, or .npy in metres")
            depth = raw.astype(np.float32) / 1000.0
    except (OSError, ValueError) as error:
        raise BadPictureError(f"depth file {str(path)!r}: {error}") from error
    if depth.shape != (size_px[1], size_px[0]):
        raise BadPictureError(
            f"depth file {str(path)!r} has shape {depth.shape}, but the picture needs {(size_px[1], size_px[0])}"
        )
    return np.where(np.isfinite(depth) & (depth > 0), depth, np.nan).astype(np.float32)


def load_view(path: PathLike, view_id: str, depth: PathLike | None = None, camera: Camera | None = None) -> View:
    """A photo as a view."""
    from wonderful_team.images import load_picture

    rgb = load_picture(Path(path))
    size_px = (int(rgb.shape[1]), int(rgb.shape[0]))
    return View(view_id, view_id, 0.0, rgb, load_depth(depth, size_px) if depth is not None else None, camera)


def instruction_with_pictures(text: str, pictures: Mapping[str, PathLike]) -> Instruction:
    """An instruction whose `{name}` marks stand for pictures.

    Args:
        text: The instruction's words.
        pictures: Name to file; the name may say what kind of picture it is, as in "goal:scene" (default: object).

    Raises:
        ConfigError: An unknown kind, or a mark without a picture, or a picture without a mark.
    """
    slots = {}
    for key, path in pictures.items():
        name, _, kind = key.partition(":")
        if kind and kind not in SLOT_KINDS:
            raise ConfigError(f"picture {key!r}: unknown kind {kind!r}; valid: {', '.join(SLOT_KINDS)}")
        view = load_view(path, f"slot:{name}:photo")
        slots[name] = Slot(name, kind or "object", {"photo": view})
    marks = _marks(text)
    missing = [mark for mark in marks if mark not in slots]
    if missing:
        raise ConfigError(
            f"the instruction says {{{missing[0]}}} but no picture has that name: --picture {missing[0]}=FILE"
        )
    return Instruction(text, slots)


def read_keep_out(texts: Sequence[str]) -> tuple[KeepOut, ...]:
    """Regions from "[NAME=]x0,y0,x1,y1[px|m]".

    Raises:
        ConfigError: Another form, or an empty region.
    """
    return tuple(_keep_out(text, number) for number, text in enumerate(texts, start=1))


def _keep_out(text: str, number: int) -> KeepOut:
    name, _, region = text.rpartition("=")
    unit: Literal["px", "m"] = "m" if region.endswith("m") else "px"
    numbers = region.removesuffix("px").removesuffix("m")
    try:
        x0, y0, x1, y1 = (float(part) for part in numbers.split(","))
        return KeepOut(name or f"region {number}", Box(x0, y0, x1, y1), unit)
    except ValueError as error:
        why = f": {error}" if "box" in str(error) else ""
        raise ConfigError(f"keep-out {text!r}{why}; valid: [NAME=]x0,y0,x1,y1[px|m] with x0 < x1 and y0 < y1") from None


def _marks(text: str) -> list[str]:
    import string

    try:
        return [name for _, name, _, _ in string.Formatter().parse(text) if name is not None]
    except ValueError as error:
        raise ConfigError(f"instruction {text!r}: {error}; a mark is a name in braces, as in {{cup}}") from error


def _pose(matrix: Array) -> Pose:
    if matrix.shape != (4, 4) or not np.allclose(matrix[3], (0, 0, 0, 1)):
        raise ValueError(f"T_base_cam: expected a 4 x 4 pose with last row 0 0 0 1, got shape {matrix.shape}")
    rotation = matrix[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-3) or np.linalg.det(rotation) < 0:
        raise ValueError("T_base_cam: its 3 x 3 part is not a rotation")
    # The quaternion is the eigenvector of the largest eigenvalue (Bar-Itzhack 2000): well conditioned everywhere.
    r = rotation
    profile = np.array(
        [
            [r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[0, 1] + r[1, 0], r[1, 1] - r[0, 0] - r[2, 2], r[1, 2] + r[2, 1]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], r[2, 2] - r[0, 0] - r[1, 1]],
        ]
    )
    return Pose(matrix[:3, 3], np.linalg.eigh(profile)[1][:, -1])


def _first_problem(error: ValidationError | UnicodeDecodeError) -> str:
    if isinstance(error, UnicodeDecodeError):
        return "not a text file"
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    return f"{where + ': ' if where else ''}{first['msg'].removeprefix('Value error, ')}"
