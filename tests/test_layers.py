"""The arrows of the house: which package may import which. A package missing from the table fails."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "wonderful_team"
BASE = {"_version", "core", "errors"}
TOP = {"__init__", "__main__", "api", "cli", "interrupts", "registry"}
ARROWS: dict[str, set[str]] = {
    **dict.fromkeys(BASE, BASE),
    "contracts": BASE,
    "images": BASE,
    "sandbox": BASE,
    "motion": BASE,
    "sims": BASE | {"robots"},
    "robots": BASE,
    "detectors": BASE | {"images"},
    "agents": BASE | {"contracts", "images"},
    "models": BASE | {"contracts", "images", "detectors"},
    "offline": BASE | {"contracts", "images"},
    "simulated": BASE | {"contracts", "images", "models"},
    "planning": BASE | {"contracts", "images", "models", "agents", "motion", "sandbox", "detectors"},
    "baselines": BASE | {"contracts", "images", "models", "agents", "motion", "sandbox", "detectors"},
    "lab": BASE | {"contracts", "images", "agents", "models"},
    "record": BASE | {"images"},
    "pages": BASE | {"images", "record"},
    "runtime": BASE | {"images"},
    "evals": BASE | {"images", "runtime", "record"},
}
OUTSIDE_OF_BASE = {"numpy"}
"""Third-party packages that base may import."""


def _parts() -> list[str]:
    return sorted(
        {
            path.stem if path.is_file() else path.name
            for path in ROOT.iterdir()
            if path.suffix == ".py" or (path.is_dir() and path.name != "__pycache__")
        }
    )


def _files(part: str) -> list[Path]:
    return [ROOT / f"{part}.py"] if (ROOT / f"{part}.py").is_file() else sorted((ROOT / part).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """Every module that a file imports, wherever in the file, as dotted names from the top."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                package = path.relative_to(ROOT.parent).parent.parts
                stem = ".".join([*package[: len(package) - node.level + 1], *(node.module or "").split(".")]).strip(".")
            else:
                stem = node.module or ""
            names |= {f"{stem}.{alias.name}" for alias in node.names} if stem == "wonderful_team" else {stem}
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "import_module" and node.args:
            if isinstance(node.args[0], ast.Constant):
                names.add(str(node.args[0].value))
    return names


def ours(path: Path) -> set[str]:
    """The parts of our own package that a file imports."""
    return {name.split(".")[1] for name in imported(path) if name.startswith("wonderful_team.")} - {"__version__"}


def test_every_part_stands_in_the_table() -> None:
    assert set(_parts()) <= set(ARROWS) | TOP


@pytest.mark.parametrize("part", [part for part in _parts() if part in ARROWS])
def test_arrows(part: str) -> None:
    allowed = ARROWS[part] | {part}
    wrong = {str(path.relative_to(ROOT)): ours(path) - allowed for path in _files(part) if ours(path) - allowed}
    assert not wrong, f"{part} may import {sorted(allowed)}"


def test_the_base_needs_numpy_alone() -> None:
    import sys

    for part in BASE:
        for path in _files(part):
            outside = (
                {name.split(".")[0] for name in imported(path)} - set(sys.stdlib_module_names) - {"wonderful_team"}
            )
            assert outside <= OUTSIDE_OF_BASE, path


def test_simulators_and_the_team_never_meet() -> None:
    """The two arrows that the claims of the project rest on, said once more in words."""
    for part in ("agents", "planning", "models", "contracts"):
        assert all("sims" not in ours(path) for path in _files(part)), part
    for path in _files("sims"):
        assert not ours(path) & {"models", "agents", "planning", "contracts"}, path


def test_the_check_sees_a_forbidden_import(tmp_path: Path) -> None:
    file = ROOT / "agents" / "role.py"
    assert ours(file) <= ARROWS["agents"] | {"agents"}
    planted = tmp_path / "planted.py"
    planted.write_text(
        "def late():\n    from wonderful_team.sims import tabletop\n    return tabletop\n", encoding="utf-8"
    )
    assert ours(planted) == {"sims"}
