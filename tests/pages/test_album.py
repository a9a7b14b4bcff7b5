"""Pictures of a page: as they are or as JPEG while there is room, coarser where there are many; never fewer."""

from __future__ import annotations

import base64
import re

import numpy as np
import pytest

from wonderful_team.images.encode import to_jpeg
from wonderful_team.images.png import fast_png
from wonderful_team.pages import pictures
from wonderful_team.pages.pictures import Album


def album(folder, count: int) -> tuple[Album, dict[str, bytes]]:
    """Pictures of noise, which no format makes small; the first is a JPEG file, the second small."""
    rng, files, kept = np.random.default_rng(0), {}, {}
    for number in range(count):
        size = (40, 40, 3) if number == 1 else (240, 320, 3)
        rgb = rng.integers(0, 255, size, dtype=np.uint8)
        name = f"{number}.jpg" if number == 0 else f"{number}.png"
        kept[str(number)] = to_jpeg(rgb, 70) if number == 0 else fast_png(rgb)
        (folder / name).write_bytes(kept[str(number)])
        files[str(number)] = name
    made = Album(folder, files)
    for key in files:
        assert made.get(key) is not None
    return made, kept


def held(made: Album) -> list[tuple[str, bytes]]:
    found = re.findall(r"data:image/(\w+);base64,([^\"]+)", str(made.definitions()))
    return [(kind, base64.b64decode(code)) for kind, code in found]


def test_jpeg_files_and_small_pictures_go_in_as_they_are(tmp_path):
    made, kept = album(tmp_path, 3)
    first, second, third = held(made)
    assert first == ("jpeg", kept["0"])
    assert second == ("png", kept["1"])
    assert third[0] == "jpeg"


@pytest.mark.parametrize("count", [4, 60])
def test_many_pictures_get_coarser_and_none_is_left_out(tmp_path, monkeypatch, count):
    monkeypatch.setattr(pictures, "MOST_BYTES", 22_000 * count)
    coded = held(album(tmp_path, count)[0])
    assert len(coded) == count
    assert {kind for kind, _ in coded} == {"webp"}
    assert sum(len(code) for _, code in coded) <= 22_000 * count
