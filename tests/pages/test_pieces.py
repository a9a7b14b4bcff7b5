"""A page is put together in pieces, so that one of a long run needs little memory; its requests stay light."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from wonderful_team.pages import write, write_page

GOLDEN = Path(__file__).parents[1] / "golden" / "records" / "v1" / "trial"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "trial"
    shutil.copytree(GOLDEN, path)
    return path


def test_the_pieces_make_the_same_page(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = write_page(folder).read_bytes()
    for most in (1, 3000, 10**9):
        monkeypatch.setattr(write, "_PIECE", most)
        assert write_page(folder).read_bytes() == whole


def test_a_piece_ends_only_before_a_section_or_a_request() -> None:
    parts = ["<p>", "word " * 200_000, "word", "</p><section>", "x" * 600_000, '<details class="request" id="1">y']
    pieces = list(write._pieces(parts))
    assert "".join(pieces) == "".join(parts)
    assert len(pieces) == 3
    assert pieces[1].startswith("<section>")
    assert pieces[2].startswith('<details class="request"')


def test_a_key_is_hidden_wherever_the_pieces_end(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    key = "sk-ant-api03-" + "Zx9" * 20
    text = (folder / "record.json").read_text(encoding="utf-8")
    record = json.loads(text)
    for request in record["planner"]["requests"]:
        request["parts"].append({"words": f"the key is {key}, so it says"})
    (folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
    monkeypatch.setattr(write, "_PIECE", 1)
    page = write_page(folder).read_text(encoding="utf-8")
    assert page.count("so it says") >= len(record["planner"]["requests"])
    assert "Zx9Zx9" not in page


def test_words_that_follow_each_other_stand_in_one_block_and_a_picture_is_shown_where_it_is_named_first(
    folder: Path,
) -> None:
    page = write_page(folder).read_text(encoding="utf-8")
    shown = re.findall(r'<div class="parts">(.*?)</div>', page, re.S)
    assert shown
    for one in shown:
        assert "</pre><pre>" not in re.sub(r"\s*\n\s*", "", one)
        assert one.count('aria-label="picture 1"') <= 1
    named = [one for one in shown if one.count("[picture 1]") > 1]
    assert named
    assert all('class="picture inline"' in one for one in named)
