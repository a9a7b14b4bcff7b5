"""What the documents and docstrings name exists: modules, names, files, commands and their options."""

from __future__ import annotations

import ast
import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import wonderful_team as wt
from wonderful_team.cli.app import COMMANDS, LazyGroup, group

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "wonderful_team"
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
CODE = [path for folder in ("src", "examples", "benchmarks", "tools") for path in sorted((ROOT / folder).rglob("*.py"))]
PARTS = sorted(path.name for path in PACKAGE.iterdir() if path.is_dir() and (path / "__init__.py").is_file())
NOT_OURS = {
    "--runslow", "--runinstall", "--runservers", "--rundetectors", "--revision", "--index-url", "--no-deps", "--dry-run", "--max-model-len", "--served-model-name", "--dtype",
    "--mmproj", "--alias", "--port", "--build", "--target", "--head", "--address",
}  # fmt: skip
"""Options of pytest, pip, uv, vLLM, llama.cpp, Ray and CMake that the documents name."""
OF_BENCHMARKS = {
    option for path in (ROOT / "benchmarks").glob("*.py") for option in re.findall(r"--[a-z][\w-]*", path.read_text())
}


def told(path: Path) -> Iterator[str]:
    """A page's text, or every text of a module: docstrings, messages, comments."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        yield text
        return
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
    yield from re.findall(r"#.*", text)


def exists(dotted: str) -> bool:
    """Whether a dotted name is a module, or a name within one."""
    words = dotted.split(".")
    for count in range(len(words), 0, -1):
        try:
            found: object = importlib.import_module(".".join(words[:count]))
        except ModuleNotFoundError:
            continue
        for word in words[count:]:
            if not hasattr(found, word) and word not in getattr(found, "__annotations__", {}):
                return False
            found = getattr(found, word, None)
        return True
    return False


def is_file(name: str, folders: tuple[Path, ...]) -> bool:
    """Whether a path, with or without its ending, is in one of the folders; `*` stands for anything."""
    return any(any(folder.glob(name)) or any(folder.glob(f"{name}.*")) for folder in folders)


@pytest.mark.filterwarnings("ignore:.* is called .* now:DeprecationWarning")  # old names are named too
@pytest.mark.parametrize("path", [*PAGES, *CODE], ids=lambda path: path.relative_to(ROOT).as_posix())
def test_modules_and_files_that_a_text_names_exist(path: Path) -> None:
    missing: set[str] = set()
    for text in told(path):
        missing |= {name for name in re.findall(r"\bwonderful_team(?:\.\w+)+", text) if not exists(name)}
        missing |= {f"wt.{name}" for name in re.findall(r"\bwt\.(\w+)", text) if not hasattr(wt, name)}
        named = re.findall(r"(?<![\w/.<-])((?:docs|tests|benchmarks|examples|tools)/[\w./*-]*\w)", text)
        missing |= {name for name in named if not is_file(name, (ROOT,))}
        if path.suffix == ".md":
            inside = re.findall(rf"(?<![\w/.-])((?:{'|'.join(PARTS)})/[\w/]+(?:\.py)?)", text)
            missing |= {name for name in inside if not is_file(name, (PACKAGE, ROOT))}
        # The package is on no index: whoever types that gets nothing, or somebody else's.
        missing |= set(re.findall(r"pip install [^`\n]*wonderful[-_]team\b[^`\n]*", text))
    assert missing == set()


def options(command: str) -> set[str]:
    """Every option of one command."""
    assert isinstance(group, LazyGroup)
    found = group.get_command(click.Context(group), command)
    assert found is not None
    return {word for parameter in found.params for word in (*parameter.opts, *parameter.secondary_opts)} | {"--help"}


def command_lines(text: str) -> Iterator[tuple[str, str]]:
    """Each command that a page shows: in backticks, or as a line of a block."""
    for line in re.findall(r"(?:^|`)[ $]*(?:\.venv/bin/)?wonderful-team ([^`\n]+)", text, re.MULTILINE):
        yield line.split()[0], line.split("  #")[0]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_commands_and_options_that_a_page_shows_exist(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    for command, line in command_lines(text):
        if command.startswith("--"):
            continue
        for one in command.split("|"):
            assert one in COMMANDS, line
        wrong = set(re.findall(r"(?<!\S)--[a-z][\w-]*", line)) - options(command.split("|")[0])
        assert wrong == set(), line
    known = (
        set().union(*(options(command) for command in COMMANDS)) | OF_BENCHMARKS | NOT_OURS | {"--version", "--debug"}
    )
    assert set(re.findall(r"(?<![\w-])--[a-z][\w-]*", text)) - known == set()
