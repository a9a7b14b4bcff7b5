"""The page of a run that just ended decodes no picture that is still at hand, and is the one that the folder gives later."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.core.values import SentPicture
from wonderful_team.images import OWN_FORMATS, open_picture, to_jpeg
from wonderful_team.images.png import fast_png
from wonderful_team.pages import PAGE_NAME, pictures, write_page
from wonderful_team.record import picture_store
from wonderful_team.record.picture_store import PictureStore
from wonderful_team.record.run_files import RunFiles


def noise(seed: int) -> wt.View:
    rgb = np.random.default_rng(seed).integers(0, 256, (240, 320, 3), np.uint8)
    return wt.View("top", "camera", 0.0, rgb)


def test_what_no_longer_stays_at_hand_was_coded_for_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_store, "PIXELS_BYTES", 1)
    monkeypatch.setattr(picture_store, "AS_IT_IS_BYTES", 1000)
    scene = noise(1).rgb.copy()
    scene[60:120, 60:120] = (200, 30, 30)
    coded: list[str] = []
    to_jpeg = pictures.to_jpeg
    monkeypatch.setattr(pictures, "to_jpeg", lambda rgb, quality: coded.append("page") or to_jpeg(rgb, quality))
    monkeypatch.setattr(pictures.Bases, "place", lambda *_: None)
    made = wt.Team(model="offline", out=tmp_path).plan(scene, "put the red block on the left")
    page = (made.folder / PAGE_NAME).read_bytes()
    at_once = len(coded)
    assert b"data:image/jpeg" in page
    write_page(made.folder)
    assert at_once == 1 < len(coded) - at_once, "only the last picture, whose pixels stayed, was coded for the page"
    assert (made.folder / PAGE_NAME).read_bytes() == page


def test_no_more_is_coded_than_a_page_may_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_store, "PAGE_BYTES", 100_000)
    monkeypatch.setattr(picture_store, "PIXELS_BYTES", 1)
    store = PictureStore(RunFiles(tmp_path), lambda key, file: None)
    for seed in range(12):
        store.keep_view(noise(seed), "start")
    kept = sum(map(len, store.at_hand.coded.values()))
    assert 100_000 <= kept < 250_000


def test_pixels_at_hand_are_bounded_and_those_of_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_store, "PIXELS_BYTES", 3 * 240 * 320 * 3)
    files: list[str] = []
    store = PictureStore(RunFiles(tmp_path), lambda key, file: files.append(file))
    views = [noise(seed) for seed in range(12)]
    for view in views:
        store.keep_view(view, "start")
    held = {file: store.at_hand.pixels.get(file) for file in files}
    assert [file for file, rgb in held.items() if rgb is not None] == files[-3:]
    for file, view in zip(files, views, strict=True):
        with open_picture(tmp_path / file, OWN_FORMATS) as image:
            assert np.array_equal(image.convert("RGB"), view.rgb)
        assert held[file] is None or np.array_equal(held[file], view.rgb)


def test_no_picture_that_is_at_hand_is_decoded_for_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two pictures of one scene differ in a few places: to find them their pixels are compared."""
    decoded: list[str] = []
    real = pictures.Album._pixels

    def pixels(album: pictures.Album, shown: pictures.Shown, *part: pictures.Patch) -> np.ndarray:
        if album._at_hand.pixels.get(shown.file) is None:
            decoded.append(shown.file)
        return real(album, shown, *part)

    monkeypatch.setattr(pictures.Album, "_pixels", pixels)
    scene = noise(1).rgb.copy()
    scene[60:120, 60:120] = (200, 30, 30)
    made = wt.Team(model="offline", out=tmp_path).plan(scene, "put the red block on the left")
    page = (made.folder / PAGE_NAME).read_bytes()
    assert decoded == []
    write_page(made.folder)
    assert decoded
    assert (made.folder / PAGE_NAME).read_bytes() == page


def test_photos_that_went_out_as_jpeg_are_compared_by_what_their_files_were_made_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files: dict[str, str] = {}
    store = PictureStore(RunFiles(tmp_path), files.__setitem__)
    plain = noise(1).rgb
    marked = plain.copy()
    marked[60:120, 60:120] = (200, 30, 30)
    for rgb, file in ((plain, to_jpeg(plain, 90)), (marked, fast_png(marked))):
        store.keep_file(SentPicture(file, (320, 240), rgb), "photo")
    album = pictures.Album(tmp_path, files, store.at_hand)
    assert all(album.get(key) is not None for key in files)
    with monkeypatch.context() as patched:
        patched.setattr(pictures, "open_picture", lambda *_: pytest.fail("a picture was read again"))
        text = str(album.definitions())
    assert text.count("<image") == 2, "the whole photo, and the place that was marked"
    assert '<use href="#p1"/>' in text
