"""The README and the docs are executed: Python blocks, command lines, and the demo that `make demo` runs."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from wonderful_team.cli.app import COMMANDS, run

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(path: Path, language: str) -> list[str]:
    """The fenced blocks of one language."""
    return re.findall(rf"```{language}\n(.*?)```", path.read_text(encoding="utf-8"), re.DOTALL)


PYTHON = [
    pytest.param(code, id=f"{path.name}-{number}")
    for path in PAGES
    for number, code in enumerate(blocks(path, "python"))
]
LINES = [
    line
    for code in blocks(ROOT / "README.md", "console")
    for line in code.splitlines()
    if line.startswith("wonderful-team")
]


@pytest.mark.parametrize("code", PYTHON)
def test_python_of_the_docs_runs(
    code: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    exec(compile(code, "docs", "exec"), {"__name__": "docs"})  # noqa: S102  that the docs run is the point
    said = capsys.readouterr().out
    assert "failure" not in said or "Waiting" in code
    if "wt.Team" in code and "print" in code:
        assert re.search(r"success|planned", said)


def test_command_lines_of_the_readme_run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    assert len(LINES) == 5
    for line in LINES:
        code = run(shlex.split(line)[1:])
        told = capsys.readouterr()
        assert code == 0, f"{line}\n{told.out}\n{told.err}"


def test_every_command_stands_in_the_readme() -> None:
    table = README[README.index("| command |") :]
    assert [command for command in COMMANDS if f"| `{command}" not in table] == []


def test_the_one_command_for_a_real_model_asks_for_the_key_that_is_missing(capsys: pytest.CaptureFixture[str]) -> None:
    found = re.search(r"`wonderful-team (run [^`]*--model [^`]*)`", README)
    assert found is not None
    assert run(shlex.split(found[1])) == 2
    assert "ANTHROPIC_API_KEY" in capsys.readouterr().err


def test_files_that_the_docs_name_exist() -> None:
    for path in PAGES:
        for link in re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8")):
            if not link.startswith("http"):
                assert (path.parent / link).exists(), f"{path.name}: {link}"


def test_make_demo_runs_the_demo_and_the_team_catches_both_mistakes(capsys: pytest.CaptureFixture[str]) -> None:
    recipe = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert re.search(r"^demo:.*\n\t@\$\(VENV\)/bin/wonderful-team demo$", recipe, re.MULTILINE)
    assert run(["demo"]) == 0
    told = capsys.readouterr()
    assert told.out.count("INJECTED") == 2
    assert "CAUGHT    Verification, G1: Should it not be 'put the red block into the blue bowl'" in told.out
    assert "CAUGHT    T1 red block: Checker: revise" in told.out
    assert "{" not in told.out + told.err
    assert "SUCCESS" in told.out
    assert "not a vision-language model" in told.err
    page = Path(told.out.splitlines()[-1].removeprefix("page: "))
    text = page.read_text(encoding="utf-8")
    assert "2 planted mistakes, both caught" in text
    cards = text[text.index('id="planted"') : text.index('id="picture"')]
    assert cards.count("card caught") == 2
    assert "<del>green</del> <ins>blue</ins>" in cards
    # Only the box that was replaced is called injected.
    assert text[text.index('id="targets"') : text.index('id="actions"')].count("badge injected") == 1
