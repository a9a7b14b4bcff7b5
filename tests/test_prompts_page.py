"""docs/prompts.md shows what is sent: it is made again and compared."""

from __future__ import annotations

from pathlib import Path

from docs.make_prompts import HERE, PICTURES, page, runs, stale


def test_the_page_shows_what_is_sent_today(tmp_path: Path) -> None:
    images = tmp_path / "images"
    images.mkdir()
    text = page(list(runs(tmp_path)), images)
    assert stale(text, images) == []
    # The comparison sees a changed word and a lost picture.
    assert stale(text.replace("the main view", "the principal view"), images)
    next(images.iterdir()).unlink()
    assert stale(text, images)
    assert (HERE / PICTURES).is_dir()
