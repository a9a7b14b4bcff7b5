"""Where words or pictures can stand, nobody reads the name of a placeholder; what was sent to the letter stays at hand."""

from __future__ import annotations

import html
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from wonderful_team.cli.app import run
from wonderful_team.pages import write_page

GOLDEN = Path(__file__).parents[1] / "golden" / "records" / "v1" / "trial"
NAME = "{dragged_obj}"
TO_THE_LETTER = re.compile(
    r"<details[^>]*><summary>(the words to the letter|as it came)[^<]*</summary><pre>.*?</pre>", re.S
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    path = tmp_path_factory.mktemp("run") / "trial"
    shutil.copytree(GOLDEN, path)
    return path


def test_requests_show_pictures_in_the_place_of_their_names(folder: Path) -> None:
    page = write_page(folder).read_text(encoding="utf-8")
    assert NAME not in TO_THE_LETTER.sub("", page)
    shown = html.unescape(re.sub(r"<title>.*?</title>|<[^>]+>", "", page))
    # What went out to the model, with the name that it was given: a click away.
    assert f"Rotate the {NAME} 120 degrees." in shown
    assert re.search(r"<pre>[^<]*Rotate the <svg class=\"picture inline\"", page)
    assert "[picture 1] top" in page
    assert '<span class="slot-name">picture 1</span>' in page


@pytest.mark.parametrize("words", [["--role", "supervisor"], ["--diff"], []])
def test_a_terminal_calls_pictures_by_their_number(
    words: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = [*words, str(folder)] if words == ["--diff"] else words
    assert run(["show", str(folder), *given]) == 0
    said = capsys.readouterr().out
    assert NAME not in said
    assert "[picture 1]" in said
