"""A picture that is another with a few changes is held as these changes, and looks the same."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.images.png import fast_png
from wonderful_team.pages import pictures, variants
from wonderful_team.pages.pictures import Album
from wonderful_team.pages.variants import MOST_PATCHES, patches

SIZE = (250, 330)


def noise(seed: int = 0) -> Array:
    """A picture that no format makes small; smooth enough for JPEG to keep."""
    rng = np.random.default_rng(seed)
    small = Image.fromarray(rng.integers(40, 215, (SIZE[0] // 5, SIZE[1] // 5, 3), dtype=np.uint8))
    return np.asarray(small.resize(SIZE[::-1], Image.Resampling.BICUBIC)).copy()


def framed(rgb: Array, x0: int, y0: int, x1: int, y1: int) -> Array:
    """The same with a red frame."""
    marked = rgb.copy()
    for part in (
        np.s_[y0 : y0 + 3, x0:x1],
        np.s_[y1 - 3 : y1, x0:x1],
        np.s_[y0:y1, x0 : x0 + 3],
        np.s_[y0:y1, x1 - 3 : x1],
    ):
        marked[part] = (220, 20, 20)
    return marked


def page_of(folder: Path, *shown: Array) -> tuple[str, list[Array]]:
    """What a page holds of pictures, and each as a browser puts it together."""
    files = {}
    for number, rgb in enumerate(shown):
        (folder / f"{number}.png").write_bytes(fast_png(rgb))
        files[str(number)] = f"{number}.png"
    album = Album(folder, files)
    for key in files:
        assert album.get(key) is not None
    text = str(album.definitions())
    return text, [drawn(text, number + 1) for number in range(len(shown))]


def drawn(text: str, number: int) -> Array:
    whole = re.search(rf'<image id="p{number}" width="(\d+)" height="(\d+)"[^>]*base64,([^"]*)"', text)
    if whole is not None:
        size = (int(whole[1]), int(whole[2]))
        return np.asarray(coded(whole[3]).resize(size)).copy()
    group = re.search(rf'<g id="p{number}"><use href="#p(\d+)"/>(.*?)</g>', text)
    assert group is not None
    canvas = drawn(text, int(group[1]))
    for x, y, w, h, code in re.findall(
        r'<image x="(\d+)" y="(\d+)" width="(\d+)" height="(\d+)"[^>]*base64,([^"]*)"', group[2]
    ):
        x, y, w, h = (int(value) for value in (x, y, w, h))
        canvas[y : y + h, x : x + w] = np.asarray(coded(code).resize((w, h)))
    return canvas


def coded(text: str) -> Image.Image:
    return Image.open(io.BytesIO(base64.b64decode(text))).convert("RGB")


def test_a_view_with_other_marks_is_held_as_its_marks_and_looks_as_it_did(tmp_path: Path) -> None:
    view = noise()
    shown = [view, framed(view, 40, 50, 200, 190), framed(view, 250, 20, 320, 100)]
    text, seen = page_of(tmp_path, *shown)
    assert text.count('<use href="#p1"/>') == 2
    alone = [page_of(tmp_path, one)[0] for one in shown]
    assert len(text) < 0.7 * sum(map(len, alone))
    for number, one in enumerate(shown):
        assert np.abs(seen[number].astype(int) - drawn(alone[number], 1).astype(int)).max() <= 3
        assert np.abs(seen[number].astype(int) - one).mean() < 8


def test_pictures_that_only_have_their_size_in_common_stay_whole(tmp_path: Path) -> None:
    text, _ = page_of(tmp_path, noise(1), noise(2))
    assert "<use" not in text
    assert text.count("<image") == 2


def test_coarser_pictures_have_coarser_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    view = noise()
    monkeypatch.setattr(pictures, "MOST_BYTES", 6_000)
    text, seen = page_of(tmp_path, view, framed(view, 40, 50, 200, 190))
    assert '<use href="#p1"/>' in text
    assert "image/webp" in text
    assert seen[1][52, 100, 0] > seen[0][52, 100, 0] + 20 or seen[1][52, 100, 1] < seen[0][52, 100, 1] - 20


def test_a_hollow_frame_is_covered_by_its_sides() -> None:
    view = noise()
    places = patches(framed(view, 40, 50, 300, 240), view)
    assert places is not None
    area = sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in places)
    assert area < 0.75 * 260 * 190
    covered = np.zeros(SIZE, dtype=bool)
    for x0, y0, x1, y1 in places:
        assert 0 <= x0 < x1 <= SIZE[1]
        assert 0 <= y0 < y1 <= SIZE[0]
        covered[y0:y1, x0:x1] = True
    assert covered[(framed(view, 40, 50, 300, 240) != view).any(axis=2)].all()


def test_a_single_pixel_is_not_lost_and_no_change_is_none() -> None:
    view = noise()
    other = view.copy()
    other[249, 329] = 255 - other[249, 329]
    assert patches(other, view) == ((320, 240, 330, 250),)
    assert patches(view, view) == ()


def test_ticks_along_the_edges_are_few_places_and_the_base_of_what_has_them_too(tmp_path: Path) -> None:
    view = noise()
    ticked = view.copy()
    ticked[:6, 4::32] = ticked[-6:, 4::32] = ticked[4::32, :6] = ticked[4::32, -6:] = 0
    places = patches(ticked, view)
    assert places is not None
    assert len(places) <= 8
    changed = (ticked != view).any(axis=2)
    for x0, y0, x1, y1 in places:
        changed[y0:y1, x0:x1] = False
    assert not changed.any()
    shown = [view, ticked, framed(ticked, 100, 90, 200, 190)]
    text, seen = page_of(tmp_path, *shown)
    assert text.count('<use href="#p1"/>') == text.count('<use href="#p2"/>') == 1
    for number, one in enumerate(shown):
        assert np.abs(seen[number].astype(int) - one).mean() < 8


def test_changes_in_too_many_places_are_no_variant() -> None:
    view = noise()
    other = view.copy()
    other[8::48, 8::32] = 0
    assert len(other[8::48, 8::32].reshape(-1, 3)) > MOST_PATCHES
    assert patches(other, view) is None


def test_no_more_pictures_are_compared_with_than_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    rgb = noise()
    monkeypatch.setattr(variants, "MOST_BYTES", 2 * rgb.nbytes)
    bases = variants.Bases()
    assert bases.place(1, rgb) is None
    assert bases.place(2, noise(1)) is None
    assert bases.place(3, noise(2)) is None
    assert bases._held.bytes == 2 * rgb.nbytes
    for number, base in ((1, rgb), (3, noise(2))):
        found = bases.place(9, framed(base, 20, 20, 90, 80))
        assert found is not None
        assert found[0] == number
    assert bases.place(4, framed(noise(1), 20, 20, 90, 80)) is None, "what it is like had to go"
