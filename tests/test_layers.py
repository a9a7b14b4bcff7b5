"""The arrows of the house: which package may import which. A package missing from the table fails, and so does an arrow that nobody uses."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1] / "src" / "wonderful_team"
BASE = {"errors", "core", "_version", "redaction"}
TOP = {"__init__", "__main__"}
"""The package's face, which looks names up when they are asked for, and `python -m wonderful_team`."""
ARROWS: dict[str, set[str]] = {
    "_version": set(),
    "redaction": set(),
    "errors": {"redaction"},
    "core": {"errors", "redaction"},
    "contracts": BASE,
    "images": BASE,
    "sandbox": BASE,
    "motion": BASE,
    "sims": BASE,
    "agents": BASE | {"contracts", "images"},
    "models": BASE | {"contracts", "images"},
    "offline": BASE | {"contracts", "images"},
    "simulated": BASE | {"contracts", "images", "models"},
    "detectors": BASE,
    "planning": BASE | {"contracts", "images", "motion", "sandbox", "agents", "models", "detectors"},
    "lab": BASE | {"contracts", "images", "agents", "models"},
    "record": BASE | {"images"},
    "pages": BASE | {"images", "record"},
    "runtime": BASE | {"images"},
    "evals": BASE | {"images"},
    "registry": BASE | {"agents", "contracts", "detectors", "models", "offline", "simulated", "planning", "sims"},
    "api": BASE
    | {"agents", "detectors", "images", "models", "planning", "sims", "record", "pages", "runtime", "lab", "evals"}
    | {"registry"},
    "cli": BASE
    | {
        "agents",
        "contracts",
        "images",
        "models",
        "offline",
        "sandbox",
        "sims",
        "record",
        "pages",
        "runtime",
        "evals",
        "registry",
        "api",
    },
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
            names |= {f"{stem}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "import_module" and node.args:
            if isinstance(node.args[0], ast.Constant):
                names.add(str(node.args[0].value))
    return names


def ours(path: Path) -> set[str]:
    """The parts of our own package that a file imports."""
    return {name.split(".")[1] for name in imported(path) if name.startswith("wonderful_team.")} - {"__version__"}


def test_every_part_stands_in_the_table() -> None:
    assert set(_parts()) == set(ARROWS) | TOP


@pytest.mark.parametrize("part", [part for part in _parts() if part in ARROWS])
def test_arrows(part: str) -> None:
    allowed = ARROWS[part] | {part}
    wrong = {str(path.relative_to(ROOT)): ours(path) - allowed for path in _files(part) if ours(path) - allowed}
    assert not wrong, f"{part} may import {sorted(allowed)}"


def test_no_arrow_is_unused() -> None:
    used = {part: set().union(*(ours(path) for path in _files(part))) for part in ARROWS}
    unused = {
        part: sorted(allowed - used[part] - BASE) for part, allowed in ARROWS.items() if allowed - used[part] - BASE
    }
    assert not unused


def test_the_table_has_no_circles() -> None:
    """Each part stands above all that it imports, so a floor can be told for every one."""
    left = {part: allowed - {part} for part, allowed in ARROWS.items()}
    while left:
        free = [part for part, needs in left.items() if not needs & set(left)]
        assert free, f"a circle among {sorted(left)}"
        for part in free:
            del left[part]


def _modules() -> dict[str, Path]:
    found = {}
    for path in ROOT.rglob("*.py"):
        name = ".".join(path.relative_to(ROOT.parent).with_suffix("").parts)
        found[name.removesuffix(".__init__")] = path
    return found


def _circles(needs: dict[str, set[str]]) -> Iterator[list[str]]:
    """Groups of files that reach each other, by Tarjan's algorithm without recursion."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    held: list[str] = []
    for start in needs:
        if start in order:
            continue
        work = [(start, iter(sorted(needs[start])))]
        order[start] = low[start] = len(order)
        held.append(start)
        while work:
            name, rest = work[-1]
            for other in rest:
                if other not in order:
                    order[other] = low[other] = len(order)
                    held.append(other)
                    work.append((other, iter(sorted(needs[other]))))
                    break
                if other in held:
                    low[name] = min(low[name], order[other])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[name])
                if low[name] == order[name]:
                    group = held[held.index(name) :]
                    del held[held.index(name) :]
                    if len(group) > 1:
                        yield sorted(group)


def needed(modules: dict[str, Path]) -> dict[str, set[str]]:
    """Module to the modules of ours that it imports: late imports and those for types count; a face that hands names on does not."""
    needs: dict[str, set[str]] = {}
    for module, path in modules.items():
        found = set()
        for name in imported(path):
            while name and name not in modules:
                name = name.rpartition(".")[0]
            if name and name != module and name != "wonderful_team":
                found.add(name)
        needs[module] = found
    # What a file imports from a package's face it imports from the file that defines it: the face itself is no step of a circle.
    faces = {name for name, path in modules.items() if path.name == "__init__.py"}
    return {
        name: {other for other in found if other not in faces} for name, found in needs.items() if name not in faces
    }


def test_no_circles_among_files_late_imports_and_imports_for_types_included() -> None:
    assert list(_circles(needed(_modules()))) == []


def test_the_search_finds_a_circle() -> None:
    assert list(_circles({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": set()})) == [["a", "b", "c"]]


def test_few_files_lie_loose_at_the_top() -> None:
    assert {path.stem for path in ROOT.glob("*.py")} == {"__init__", "__main__", "_version", "errors", "redaction"}


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
    for part in ("agents", "planning", "models", "offline", "contracts"):
        assert all("sims" not in ours(path) for path in _files(part)), part
    for path in _files("sims"):
        assert not ours(path) & {"models", "agents", "planning", "contracts"}, path


SHARED_BY_RIVALS = tuple(f"wonderful_team.planning.baselines.{name}" for name in ("open_loop", "programs"))
"""The files that rivals may share; they import no planner themselves."""


def planners_met(path: Path, rival: bool) -> set[str]:
    """What a planner's file imports of the other planners: a rival of all but what rivals share, the team of its rivals."""
    planners = {name for name in imported(path) if name.startswith("wonderful_team.planning")}
    if rival:
        return {name for name in planners if not name.startswith(tuple(f"{shared}." for shared in SHARED_BY_RIVALS))}
    return {name for name in planners if "baselines" in name.split(".")}


def test_the_team_and_its_rivals_never_meet(tmp_path: Path) -> None:
    """Comparisons are fair because neither can lean on the other."""
    rivals = [path for path in _files("planning") if path.parent.name == "baselines"]
    assert len(rivals) > 1
    for path in _files("planning"):
        assert not planners_met(path, path in rivals), path
    for name in SHARED_BY_RIVALS:
        shared = ROOT.joinpath(*name.split(".")[1:]).with_suffix(".py")
        assert not planners_met(shared, rival=True), shared
    planted = tmp_path / "planted.py"
    for line, of_rival, of_team in (
        ("from wonderful_team.planning.session import AgentSession", True, False),
        ("from wonderful_team.planning import baselines", True, True),
        ("from wonderful_team.planning.baselines import open_loop", True, True),
        ("from wonderful_team.planning.baselines.direct import Direct", True, True),
        ("import wonderful_team.planning.baselines.direct", True, True),
        (f"from {SHARED_BY_RIVALS[0]} import OpenLoop", False, True),
        (f"from {SHARED_BY_RIVALS[0]}er import OpenLoop", True, True),
        (f"from {SHARED_BY_RIVALS[1]} import ToolPath", False, True),
    ):
        planted.write_text(f"{line}\n", encoding="utf-8")
        assert (bool(planners_met(planted, rival=True)), bool(planners_met(planted, rival=False))) == (
            of_rival,
            of_team,
        )


def test_tests_do_not_lean_on_the_benchmarks() -> None:
    tests = Path(__file__).parent
    leaning = [
        str(path)
        for path in tests.rglob("*.py")
        if any(n.split(".")[0] == "benchmarks" for n in imported_of_test(path))
    ]
    assert leaning == []


def imported_of_test(path: Path) -> set[str]:
    """Modules that a file of the tests imports."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    return names


def test_the_check_sees_a_forbidden_import(tmp_path: Path) -> None:
    file = ROOT / "agents" / "role.py"
    assert ours(file) <= ARROWS["agents"] | {"agents"}
    planted = tmp_path / "planted.py"
    planted.write_text(
        "def late():\n    from wonderful_team.sims import tabletop\n    return tabletop\n", encoding="utf-8"
    )
    assert ours(planted) == {"sims"}
