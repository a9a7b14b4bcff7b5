"""The page of a run that just ended reads no picture that the recorder has coded, and is the one that the folder gives later."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.pages import PAGE_NAME, pictures, write_page
from wonderful_team.record import picture_store
from wonderful_team.record.picture_store import PictureStore
from wonderful_team.record.run_files import RunFiles


def noise(seed: int) -> wt.View:
    rgb = np.random.default_rng(seed).integers(0, 256, (240, 320, 3), np.uint8)
    return wt.View("top", "camera", 0.0, rgb)


def test_the_page_is_the_same_with_and_without_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:

    coded: list[str] = []
    to_jpeg = pictures.to_jpeg
    monkeypatch.setattr(pictures, "to_jpeg", lambda rgb, quality: coded.append("page") or to_jpeg(rgb, quality))
    scene = noise(1).rgb.copy()
    scene[60:120, 60:120] = (200, 30, 30)
    made = wt.Team(model="offline", out=tmp_path).plan(scene, "put the red block on the left")
    page = (made.folder / PAGE_NAME).read_bytes()
    assert coded == []
    assert b"data:image/jpeg" in page
    write_page(made.folder)
    assert coded
    assert (made.folder / PAGE_NAME).read_bytes() == page


def test_no_more_is_kept_than_a_page_may_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(picture_store, "PAGE_BYTES", 100_000)
    store = PictureStore(RunFiles(tmp_path), lambda key, file: None)
    for seed in range(12):
        store.keep_view(noise(seed), "start")
    kept = sum(map(len, store.coded.values()))
    assert 100_000 <= kept < 250_000
