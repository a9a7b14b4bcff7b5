"""`--video`: an animation of what the world's cameras saw, one picture per observation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from wonderful_team.errors import ConfigError
from wonderful_team.geometry.arrays import Array
from wonderful_team.interfaces import Event
from wonderful_team.types import Observation

FORMATS = {".webp": "WEBP", ".gif": "GIF", ".png": "PNG"}
MS_PER_PICTURE = 900
HEIGHT_PX = 320


def check_video_name(path: Path) -> None:
    """Raise ConfigError when the file's ending is not one we can write, or its folder is missing."""
    if path.suffix.lower() not in FORMATS:
        raise ConfigError(f"--video {str(path)!r}: valid endings are {', '.join(FORMATS)} (an animation)")
    if not path.resolve().parent.is_dir():
        raise ConfigError(f"--video {str(path)!r}: there is no folder {str(path.resolve().parent)!r}")


class Film:
    """Keeps every new picture that is observed, all views side by side."""

    def __init__(self) -> None:
        self.frames: list[Array] = []
        self._last = ""

    def on_event(self, event: Event) -> None:
        """Keep the views of an observation that differs from the last."""
        if event.kind == "observe" and isinstance(event.content, Observation) and event.content.hash != self._last:
            self._last = event.content.hash
            self.frames.append(_side_by_side(event.content))

    def write(self, path: Path) -> None:
        """Write the animation."""
        pictures = [Image.fromarray(frame) for frame in self.frames]
        kind = FORMATS[path.suffix.lower()]
        pictures[0].save(path, kind, save_all=True, append_images=pictures[1:], duration=MS_PER_PICTURE, loop=0)


def _side_by_side(observation: Observation) -> Array:
    views = []
    for view in observation.views.values():
        width = round(view.size_px[0] * HEIGHT_PX / view.size_px[1])
        views.append(np.asarray(Image.fromarray(view.rgb).resize((width, HEIGHT_PX))))
    return np.hstack(views)
