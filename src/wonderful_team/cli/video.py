"""`--video`: an animation of a run: what was observed, and the motion between, where the world can show it."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from PIL import Image

from wonderful_team.core.filesystem import write_private
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Observation
from wonderful_team.errors import ConfigError

FORMATS = {".webp": "WEBP", ".gif": "GIF", ".png": "PNG"}
OBSERVED_MS, LAST_MS = 900, 2000
FRAME_S = 0.1
"""Time between two pictures of a motion, in the world and in the film [s]."""
HEIGHT_PX = 320


def check_video_name(path: Path) -> None:
    """Raise ConfigError when the file's ending is not one we can write, or its folder is missing."""
    if path.suffix.lower() not in FORMATS:
        raise ConfigError(f"--video {str(path)!r}: valid endings are {', '.join(FORMATS)} (an animation)")
    if not path.resolve().parent.is_dir():
        raise ConfigError(f"--video {str(path)!r}: there is no folder {str(path.resolve().parent)!r}")


class Film:
    """Keeps every new picture that is observed and those of a motion, all views side by side.

    Attributes:
        frames: The pictures so far, shape (H, W, 3), uint8.
        shown_ms: How long each is shown.
    """

    def __init__(self) -> None:
        self.frames: list[Array] = []
        self.shown_ms: list[int] = []
        self._last = ""

    def on_event(self, event: Event) -> None:
        """Keep the views of an observation that differs from the last."""
        if event.kind == "observe" and isinstance(event.content, Observation) and event.content.hash != self._last:
            self._last = event.content.hash
            self._keep({name: view.rgb for name, view in event.content.views.items()}, OBSERVED_MS)

    def motion(self, views: Mapping[str, Array]) -> None:
        """Keep a picture of a motion."""
        self._keep(views, round(1000 * FRAME_S))

    def write(self, path: Path) -> None:
        """Write the animation."""
        if not self.frames:
            raise ConfigError(f"--video {str(path)!r}: the run ended before anything was seen")
        pictures = [Image.fromarray(frame) for frame in self.frames]
        shown_ms = [*self.shown_ms[:-1], LAST_MS]
        kind = FORMATS[path.suffix.lower()]
        film = io.BytesIO()
        pictures[0].save(film, kind, save_all=True, append_images=pictures[1:], duration=shown_ms, loop=0)
        write_private(path, film.getvalue())

    def _keep(self, views: Mapping[str, Array], shown_ms: int) -> None:
        self.frames.append(_side_by_side(views))
        self.shown_ms.append(shown_ms)


def _side_by_side(views: Mapping[str, Array]) -> Array:
    scaled = []
    for rgb in views.values():
        width = round(rgb.shape[1] * HEIGHT_PX / rgb.shape[0])
        scaled.append(np.asarray(Image.fromarray(rgb).resize((width, HEIGHT_PX))))
    return np.hstack(scaled)
