"""Pictures of a run as files: numbered in the order of sending, exactly as drawn; the same picture is stored once."""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Callable
from functools import partial

import numpy as np

from wonderful_team.core.deadline import for_record
from wonderful_team.core.filesystem import make_private_folder
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.kept import Kept
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Observation, SentPicture, View
from wonderful_team.images import Ticks, to_jpeg
from wonderful_team.images.drawn import drawn, drawn_hash, drawn_png
from wonderful_team.images.png import fast_png
from wonderful_team.record.run_files import RunFiles
from wonderful_team.redaction import redact

FOLDER = "pictures"
PAGE_BYTES = 3_600_000
"""Bytes of pictures that a page may hold before base64 (4.8 MB of text)."""
AS_IT_IS_BYTES = 12_000
"""Smaller files stand on a page as they are, larger PNG files as JPEG."""
PAGE_QUALITY = 88
PIXELS_BYTES = 48_000_000
"""So much of the pixels of large pictures stays at hand for the page."""
DRAWING = "drawing pictures for the record"
"""What the run's limit on time names."""


class AtHand:
    """What is at hand of a run's large pictures, by file, so that its page need not read them again; none of it has to be.

    Attributes:
        pixels: Of the last ones, shape (H, W, 3), uint8: what their files were made of, JPEG files too.
        coded: The PNG files among those before, as a page shows them (JPEG); as many as one page may hold.
    """

    def __init__(self) -> None:
        self.coded: dict[str, bytes] = {}
        self.pixels: Kept[str, Array] = Kept(PIXELS_BYTES, lambda rgb: rgb.nbytes, partial(_code, self.coded))

    def forget(self) -> None:
        """Let go of all of it: who made the run may hold it for longer than its pictures are needed."""
        self.pixels.clear()
        self.coded.clear()


def _code(coded: dict[str, bytes], file: str, rgb: Array) -> None:
    if file.endswith(".png") and sum(map(len, coded.values())) < PAGE_BYTES:
        coded[file] = to_jpeg(rgb, PAGE_QUALITY)


class PictureStore:
    """Writes pictures into a run folder.

    Args:
        files: Of the run folder.
        named: Told of every picture's key and file, relative to the run folder, once.

    Attributes:
        at_hand: What the page of the run can use.
    """

    def __init__(self, files: RunFiles, named: Callable[[str, str], None]) -> None:
        self._files, self._named = files, named
        self._known: set[str] = set()
        self._sent: set[str] = set()
        self._views = 0
        self._depths: dict[str, str] = {}
        self.at_hand = AtHand()
        make_private_folder(files.folder / FOLDER)

    def keep_file(self, sent: SentPicture, name: str) -> str:
        """Store a picture's file as it was sent; returns the hash of its bytes."""
        key = hashlib.sha256(sent.file).hexdigest()[:16]
        if key not in self._sent:
            ending = "jpg" if sent.media_type == "image/jpeg" else "png"
            self._write(key, self._numbered(key, name, ending), sent.file, sent.rgb)
        return key

    def keep_drawn(self, picture: Picture, ticks: Ticks = Ticks.PIXELS) -> str:
        """Store a picture that was sent nowhere, marks drawn; returns the hash of what was drawn."""
        key = for_record(DRAWING, drawn_hash, picture, ticks)
        if key not in self._sent:
            file = for_record(DRAWING, drawn_png, picture, ticks)
            self._write(key, self._numbered(key, picture.name, "png"), file, drawn(picture, ticks))
        return key

    def _numbered(self, key: str, name: str, ending: str) -> str:
        self._sent.add(key)
        return f"{len(self._sent):03d}_{_slug(name)}.{ending}"

    def keep_view(self, view: View, where: str) -> str:
        """Store a clean view; returns its hash."""
        key = view.hash
        if key not in self._known:
            self._views += 1
            name = f"view_{self._views:03d}_{_slug(where)}_{_slug(view.camera_name)}.png"
            self._write(key, name, fast_png(view.rgb), view.rgb)
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

    def _write(self, key: str, name: str, file: bytes, rgb: Array | None) -> None:
        self._files.write(f"{FOLDER}/{name}", file)
        if rgb is not None and len(file) > AS_IT_IS_BYTES:
            self.at_hand.pixels.keep(f"{FOLDER}/{name}", rgb)
        self._known.add(key)
        self._named(key, f"{FOLDER}/{name}")


def _slug(words: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", redact(words).lower()).strip("-")[:32] or "picture"
