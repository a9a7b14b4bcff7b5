"""Pictures of a run as files: numbered in the order of sending, exactly as drawn; the same picture is stored once."""

from __future__ import annotations

import hashlib
import io
import re

import numpy as np

from wonderful_team.core.deadline import for_record
from wonderful_team.core.filesystem import make_private_folder
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Observation, View
from wonderful_team.images import to_png
from wonderful_team.images.drawn import drawn, drawn_hash
from wonderful_team.record.run_files import RunFiles
from wonderful_team.redaction import redact

FOLDER = "pictures"
DRAWING = "drawing pictures for the record"
"""What the run's limit on time names."""


class PictureStore:
    """Writes pictures into a run folder.

    Attributes:
        files: From a picture's hash to its file, relative to the run folder.
    """

    def __init__(self, files: RunFiles) -> None:
        self._files = files
        self._sent: set[str] = set()
        self._views = 0
        self._depths: dict[str, str] = {}
        self.files: dict[str, str] = {}
        make_private_folder(files.folder / FOLDER)

    def keep_sent(self, picture: Picture) -> str:
        """Store a picture as it is sent, marks drawn; returns the hash of what was drawn."""
        key = drawn_hash(picture)
        if key not in self._sent:
            self._sent.add(key)
            rgb = for_record(DRAWING, drawn, picture)
            self._write(key, f"{len(self._sent):03d}_{_slug(picture.name)}.png", rgb)
        return key

    def keep_view(self, view: View, where: str) -> str:
        """Store a clean view; returns its hash."""
        key = view.hash
        if key not in self.files:
            self._views += 1
            self._write(key, f"view_{self._views:03d}_{_slug(where)}_{_slug(view.camera_name)}.png", view.rgb)
        return key

    def keep_observation(self, observation: Observation, where: str) -> dict[str, str]:
        """Store every view; returns hashes by name of the view."""
        return {name: self.keep_view(view, where) for name, view in observation.views.items()}

    def keep_depth(self, view: View, where: str) -> str:
        """Store a view's depth, every bit of it; returns the file, relative to the run folder."""
        assert view.depth_m is not None
        key = hashlib.sha256(view.depth_m.tobytes()).hexdigest()
        if key not in self._depths:
            name = f"depth_{len(self._depths) + 1:03d}_{_slug(where)}_{_slug(view.camera_name)}.npz"
            packed = io.BytesIO()
            np.savez_compressed(packed, depth_m=view.depth_m)
            self._files.write(f"{FOLDER}/{name}", packed.getvalue())
            self._depths[key] = f"{FOLDER}/{name}"
        return self._depths[key]

    def _write(self, key: str, name: str, rgb: Array) -> None:
        self._files.write(f"{FOLDER}/{name}", to_png(rgb))
        self.files[key] = f"{FOLDER}/{name}"


def _slug(words: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", redact(words).lower()).strip("-")[:32] or "picture"
