"""SECURITY.md names what exists: the tests that hold its promises, and the commands that attack them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "SECURITY.md").read_text(encoding="utf-8")


def test_every_file_that_it_names_exists() -> None:
    named = set(re.findall(r"`([\w./-]+\.(?:py|md|toml|lock))`", PAGE))
    assert len(named) > 10
    names = {str(path.relative_to(ROOT)) for folder in ("src", "tests") for path in (ROOT / folder).rglob("*.py")}
    names |= {path.name for path in ROOT.iterdir() if path.is_file()}
    assert [name for name in sorted(named) if not any(f"/{one}".endswith(f"/{name}") for one in names)] == []
    assert [name for name in re.findall(r"`(tests/[\w/]+/)`", PAGE) if not (ROOT / name).is_dir()] == []


COMMANDS = re.findall(r"python -m benchmarks\.(\w+)([^#\n]*)", PAGE)


@pytest.mark.parametrize(("name", "words"), COMMANDS)
def test_every_command_that_it_names_has_these_options(name: str, words: str) -> None:
    source = (ROOT / "benchmarks" / f"{name}.py").read_text(encoding="utf-8")
    for option in re.findall(r"--([\w-]+)", words):
        assert f'"--{option}"' in source or f'("{option}", ' in source
