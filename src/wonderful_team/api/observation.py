"""`Observation` as users meet it: the base type with a way to make one from files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from wonderful_team.api.photos import corners_camera, load_camera, load_depth, load_view
from wonderful_team.core.values import Limits, View
from wonderful_team.core.values import Observation as BaseObservation
from wonderful_team.errors import ConfigError, reading
from wonderful_team.images.calibration import PathLike

if TYPE_CHECKING:
    from PIL.Image import Image

    from wonderful_team.core.geometry.arrays import Array


@dataclass(frozen=True, eq=False)
class Observation(BaseObservation):
    """All views at one instant; the first is the one that targets are grounded in.

    Attributes:
        limits: The workspace that came with a camera file or corners; None without metres.
        photo: It came from files: its time says nothing of when it was taken.
    """

    limits: Limits | None = None
    photo: bool = False

    @classmethod
    def from_files(
        cls,
        *pictures: PathLike,
        depth: PathLike | None = None,
        camera: PathLike | None = None,
        corners: str | None = None,
    ) -> Observation:
        """Photos of one scene.

        Args:
            *pictures: Image files; the first is the main view.
            depth: Depth of the first: a .npy file in metres, or a 16-bit PNG in millimetres.
            camera: A camera file (JSON) for the first; `wonderful_team.api.photos.CameraFile` says what it holds.
            corners: Instead of it, the table's four corners in the first: "x,y x,y x,y x,y=WxH".

        Raises:
            ConfigError: No picture, or an unusable file; both camera and corners; depth without a camera file.
        """
        with reading("the pictures with their depth and camera"):
            return cls._read(pictures, depth, camera, corners)

    @classmethod
    def _read(
        cls,
        pictures: Sequence[PathLike],
        depth: PathLike | None,
        camera: PathLike | None,
        corners: str | None,
    ) -> Observation:
        if not pictures:
            raise ConfigError("at least one picture is needed")
        if camera is not None and corners is not None:
            raise ConfigError("give a camera file or corners, not both")
        if depth is not None and camera is None:
            raise ConfigError("a depth file gives metres only with a camera file (camera=, --camera FILE)")
        names = _view_names(pictures)
        main = load_view(pictures[0], names[0])
        limits = None
        if camera is not None or corners is not None:
            size_px = main.size_px
            found = load_camera(camera, size_px) if camera is not None else corners_camera(corners or "", size_px)
            depth_m = None if depth is None else load_depth(depth, size_px)
            main, limits = replace(main, camera=found.camera, depth_m=depth_m), found.limits
        others = {name: load_view(path, name) for name, path in zip(names[1:], pictures[1:], strict=True)}
        return cls({names[0]: main, **others}, None, limits, photo=True)


Seen: TypeAlias = "BaseObservation | View | PathLike | Sequence[PathLike] | Array | Image"
"""What can be planned for: an observation, a view, picture files, or pixels."""


def seen(what: Any) -> BaseObservation:
    """An observation of whatever shows a scene.

    Args:
        what: An observation; a view; the path of a picture, or several; pixels, shape (H, W, 3), uint8; or a PIL image.

    Raises:
        ConfigError: Anything else, or pictures that cannot be used.
    """
    if isinstance(what, BaseObservation):
        return what
    if isinstance(what, View):
        return Observation({what.camera_name: what})
    if isinstance(what, str | Path):
        return Observation.from_files(what)
    if isinstance(what, list | tuple) and what and all(isinstance(one, str | Path) for one in what):
        return Observation.from_files(*what)
    rgb = what.convert("RGB") if callable(getattr(what, "convert", None)) else what
    if isinstance(rgb, np.ndarray) or rgb is not what:
        with reading("the picture"):
            return Observation({"photo": View("photo", "photo", 0.0, np.asarray(rgb))})
    raise ConfigError(
        f"observation: {type(what).__name__} shows no scene; valid: a wt.Observation (Observation.from_files, world.observe()), a wt.View, "
        "the path of a picture or a list of them, pixels of shape (H, W, 3) and type uint8, a PIL image"
    )


def _view_names(pictures: Sequence[PathLike]) -> list[str]:
    stems = [Path(picture).stem or "photo" for picture in pictures]
    return [stem if stems.count(stem) == 1 else f"{stem}-{number}" for number, stem in enumerate(stems, start=1)]
