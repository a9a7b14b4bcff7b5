"""`make setup` on a small project whose index offers newer releases of everything that its lock names."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.tools.package_index import Index, serving

ROOT = Path(__file__).parents[2]
PYTHON = str(getattr(sys, "_base_executable", sys.executable))
BACKEND = """
import backend_helper
from tests_wheel import wheel

def build_editable(folder, config_settings=None, metadata_directory=None):
    assert backend_helper.VERSION == "1.0", "built with a release that is not in the lock"
    name = "project-1.0-py3-none-any.whl"
    with open(f"{folder}/{name}", "wb") as file:
        file.write(wheel("project", "1.0", ("plain>=1",)))
    return name
"""


@pytest.fixture
def index() -> Iterator[Index]:
    with serving(Index()) as served:
        yield served


class Project:
    """A checkout with our Makefile and tools, a lock of its own, and an in-tree build backend."""

    def __init__(self, folder: Path, index: Index) -> None:
        self.folder, self.index = folder, index
        shutil.copytree(ROOT / "tools", folder / "tools", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "Makefile", folder)
        (folder / "backend").mkdir()
        (folder / "backend" / "in_tree.py").write_text(BACKEND, encoding="utf-8")
        shutil.copy(Path(__file__).with_name("package_index.py"), folder / "backend" / "tests_wheel.py")
        build = 'requires = ["backend_helper>=1"]\nbuild-backend = "in_tree"\nbackend-path = ["backend"]\n'
        (folder / "pyproject.toml").write_text(
            f'[build-system]\n{build}[project]\nname = "project"\nversion = "1.0"\n', encoding="utf-8"
        )
        plain = index.add("plain", "1.0", ("with_extra[web]<3,>=1",))
        self.lock(plain + index.add("with_extra", "1.0", (), ("web",)) + index.add("backend_helper", "1.0"))
        for name in ("plain", "with_extra", "backend_helper"):
            index.add(name, "2.0", ("never_locked",) if name == "plain" else (), ("web",))

    def lock(self, text: str) -> None:
        (self.folder / "requirements.lock").write_text(text, encoding="utf-8")

    def make(self, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
        """Run make with no index but this one."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("PIP_", "UV_", "MAKE"))}
        own = {
            "PIP_CONFIG_FILE": os.devnull,
            "PIP_INDEX_URL": self.index.url,
            "PIP_NO_CACHE_DIR": "1",
            "PIP_RETRIES": "0",
            "UV_DEFAULT_INDEX": self.index.url,
            "UV_NO_CACHE": "1",
            "WONDERFUL_TEAM_PYTHON": PYTHON,
            "WONDERFUL_TEAM_INSTALLER": "pip",
        }
        command = ["make", "setup", *words]
        return subprocess.run(
            command,
            cwd=self.folder,
            env=kept | own | variables,
            capture_output=True,
            text=True,
            timeout=240,
            check=False,
        )

    def versions(self, folder: str = ".venv") -> dict[str, str]:
        """What is installed, without what Python itself puts into an environment."""
        code = "from importlib.metadata import distributions as d; print(*(f'{x.name}={x.version}' for x in d()))"
        done = subprocess.run(
            [self.folder / folder / "bin" / "python", "-I", "-c", code], capture_output=True, text=True, check=True
        )
        found = dict(item.split("=") for item in done.stdout.split())
        return {name: version for name, version in found.items() if name not in ("pip", "setuptools")}


LOCKED = {"plain": "1.0", "with_extra": "1.0", "backend_helper": "1.0", "project": "1.0"}


@pytest.fixture
def project(tmp_path: Path, index: Index) -> Project:
    return Project(tmp_path, index)


@pytest.mark.parametrize("installer", ["pip", "uv"])
def test_newer_releases_change_nothing_and_are_not_even_asked_for(project: Project, installer: str) -> None:
    scripts = str(Path(sys.executable).parent)
    path = os.pathsep.join([scripts, os.environ["PATH"]])
    done = project.make(WONDERFUL_TEAM_INSTALLER=installer, PATH=path, PYTHONPATH="/nowhere", PIP_TARGET="/nowhere")
    assert done.returncode == 0, done.stderr
    assert project.versions() == LOCKED
    pages = {path for path in project.index.asked if path.startswith("/simple/")}
    assert {page.strip("/").split("/")[-1].replace("-", "_") for page in pages} == set(LOCKED) - {"project"}
    assert {path for path in project.index.asked if "2.0" in path} == set()

    project.index.asked.clear()
    assert project.make(WONDERFUL_TEAM_INSTALLER=installer, PATH=path).stdout == ""
    assert project.index.asked == [], "an environment that is ready was set up again"


def test_a_setup_that_broke_off_or_has_a_former_lock_is_done_anew(project: Project) -> None:
    project.index.broken = {"with_extra-1.0-py3-none-any.whl"}
    done = project.make("VENV=other")
    assert done.returncode != 0
    assert "other is not ready" in done.stderr
    assert "same command" in done.stderr
    project.index.broken = set()
    assert project.make("VENV=other").returncode == 0
    assert project.versions("other") == LOCKED

    project.lock(project.index.add("plain", "1.5") + project.index.add("backend_helper", "1.0"))
    assert project.make("VENV=other").returncode == 0
    assert project.versions("other") == {"plain": "1.5", "backend_helper": "1.0", "project": "1.0"}


def test_a_file_that_is_not_the_locked_one_is_refused(project: Project) -> None:
    project.index.files["plain-1.0-py3-none-any.whl"] = project.index.files["plain-2.0-py3-none-any.whl"]
    done = project.make()
    assert done.returncode != 0
    assert "DO NOT MATCH THE HASHES" in done.stderr


def test_a_lock_that_lacks_a_package_is_refused(project: Project) -> None:
    project.lock(project.index.add("plain", "1.0", ("with_extra",)) + project.index.add("backend_helper", "1.0"))
    done = project.make()
    assert done.returncode != 0
    assert "requires with" in done.stderr
    assert "not installed" in done.stderr


def test_a_folder_of_somebody_else_is_left_alone(project: Project) -> None:
    kept = project.folder / ".venv" / "mine.txt"
    kept.parent.mkdir()
    kept.write_text("mine", encoding="utf-8")
    done = project.make()
    assert done.returncode != 0
    assert "make VENV=DIR" in done.stderr
    assert [path.name for path in kept.parent.iterdir()] == ["mine.txt"]


def test_no_usable_python_says_what_was_looked_for(tmp_path: Path) -> None:
    stand_in = tmp_path / "python3"
    stand_in.write_text("#!/bin/sh\necho 3.10\nexit 1\n", encoding="utf-8")
    stand_in.chmod(0o755)
    command = [str(shutil.which("bash")), str(ROOT / "tools" / "find_python.sh")]
    environment = {name: value for name, value in os.environ.items() if name != "WONDERFUL_TEAM_PYTHON"}
    done = subprocess.run(
        command, env=environment | {"PATH": str(tmp_path)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "3.11 to 3.14" in done.stderr
    assert "python3 (3.10), python3.13 (not on the PATH)" in done.stderr
    named = subprocess.run(
        command, env=environment | {"WONDERFUL_TEAM_PYTHON": PYTHON}, capture_output=True, text=True, check=True
    )
    assert named.stdout.strip() == PYTHON
