"""`Observation` as users meet it: the base type with a way to make one from files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from wonderful_team import types
from wonderful_team.errors import ConfigError, reading
from wonderful_team.photos import PathLike, corners_camera, load_camera, load_depth, load_view
from wonderful_team.types import Limits


@dataclass(frozen=True, eq=False)
class Observation(types.Observation):
    """All views at one instant; the first is the one that targets are grounded in.

    Attributes:
        limits: The workspace that came with a camera file or corners; None without metres.
    """

    limits: Limits | None = None

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
            camera: A camera file (JSON) for the first; `wonderful_team.photos.CameraFile` says what it holds.
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
        return cls({names[0]: main, **others}, None, limits)


def _view_names(pictures: Sequence[PathLike]) -> list[str]:
    stems = [Path(picture).stem or "photo" for picture in pictures]
    return [stem if stems.count(stem) == 1 else f"{stem}-{number}" for number, stem in enumerate(stems, start=1)]
