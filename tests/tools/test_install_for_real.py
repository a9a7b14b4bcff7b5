"""The whole lock, and the package as users install it, in empty environments. Needs the package index and ten minutes: `--runinstall`.

The same mechanism is tested on packages of a few bytes in `test_install.py`, on every change.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tomllib
from pathlib import Path

import pytest

from tests.tools.package_index import serving
from tests.tools.real_index import NEWER, UPSTREAM, Lock, RealIndex, normal

pytestmark = [pytest.mark.install, pytest.mark.enable_socket, pytest.mark.timeout(1200)]

ROOT = Path(__file__).parents[2]
PYTHON = str(getattr(sys, "_base_executable", sys.executable))
OLDEST_PIP = "22.3"
"""As tools/install.py says; it came with Python 3.11.0."""


def environment(**variables: str) -> dict[str, str]:
    """Ours without any setting of pip, uv or Python."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PIP_", "UV_", "PYTHON"))}
    certificate = {"PIP_CERT": os.environ["PIP_CERT"]} if "PIP_CERT" in os.environ else {}
    own = {"PIP_CONFIG_FILE": os.devnull, "PIP_INDEX_URL": UPSTREAM, "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    return kept | certificate | own | variables


def ran(command: list[str | Path], folder: Path, **variables: str) -> str:
    """What a command says; its whole output when it fails."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=folder,
        env=environment(**variables),
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def installed(python: Path) -> dict[str, str]:
    """Every distribution of an environment, without what venv itself puts there."""
    code = "from importlib.metadata import distributions as d; import json; print(json.dumps([[x.name, x.version] for x in d()]))"
    found = {normal(name): version for name, version in json.loads(ran([python, "-I", "-c", code], python.parent))}
    return {name: version for name, version in found.items() if name not in ("pip", "setuptools")}


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """The files of this checkout that an installation reads."""
    folder = tmp_path / "checkout"
    skip = shutil.ignore_patterns("__pycache__")
    for name in ("src", "tools", "tests", "docs", "examples", "benchmarks"):
        shutil.copytree(ROOT / name, folder / name, ignore=skip)
    for path in ROOT.iterdir():
        if path.is_file():
            shutil.copy(path, folder)
    return folder


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files that the index has handed out already."""
    return tmp_path_factory.mktemp("files")


@pytest.mark.parametrize("installer", [f"pip=={OLDEST_PIP}", "pip", "uv"])
def test_the_lock_is_installed_whole_and_nothing_else_is_asked_for(checkout: Path, kept: Path, installer: str) -> None:
    """With the oldest pip that is supported, the newest one and uv, before an index with newer releases of everything."""
    lock, folder = Lock(checkout / "requirements.lock"), checkout.parent / "environment"
    words: list[str | Path] = []
    if installer != "uv":
        ran([PYTHON, "-I", "-m", "pip", "download", "--no-deps", "-q", "-d", checkout.parent, installer], checkout)
        (wheel,) = checkout.parent.glob("pip-*.whl")
        words = ["--pip", wheel]
    with serving(RealIndex(lock, kept)) as index:
        variables = {
            "PIP_INDEX_URL": index.url,
            "PIP_NO_CACHE_DIR": "1",
            "UV_DEFAULT_INDEX": index.url,
            "UV_NO_CACHE": "1",
            "UV_PYTHON_DOWNLOADS": "never",
            "WONDERFUL_TEAM_INSTALLER": installer.split("=")[0],
            "PATH": os.pathsep.join([sysconfig.get_path("scripts"), os.environ["PATH"]]),
        }
        told = ran([PYTHON, "-I", "tools/install.py", folder, *words], checkout, **variables)
    assert f" with {'uv' if not words else ' '.join(wheel.name.split('-')[:2])} " in told
    python = folder / "bin" / "python"

    pages = {path.split("/")[2] for path in index.asked if path.startswith("/simple/")}
    assert pages - set(lock.versions) == set(), "asked for packages that the lock does not name"
    assert {name for name, digest in index.sent if digest not in lock.digests} == set(), "took files beside the lock"
    assert [path for path in index.asked if NEWER in path] == [], "took a newer release than the locked one"

    there = installed(python)
    own = tomllib.loads((checkout / "pyproject.toml").read_text(encoding="utf-8"))["project"]["name"]
    assert there.pop(own)
    assert {name: version for name, version in there.items() if version not in lock.versions.get(name, ())} == {}
    assert len(index.sent) == len(there)
    ran([*_pip(python, words), "check"], checkout)


def _pip(python: Path, words: list[str | Path]) -> list[str | Path]:
    return [python, "-I", *([Path(words[1]) / "pip"] if words else ["-m", "pip"])]


def _empty_environment(folder: Path) -> Path:
    ran([PYTHON, "-I", "-m", "venv", folder], folder.parent)
    return folder / "bin"


@pytest.mark.parametrize("what", [".", ".[vendors]", "wheel", "sdist"])
def test_what_users_install_runs_the_demo_out_of_the_source_tree(checkout: Path, what: str, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    wanted: str | Path = what
    if what in ("wheel", "sdist"):
        ran([sys.executable, "-m", "hatchling", "build", "-t", what, "-d", tmp_path / "built"], checkout)
        (wanted,) = (tmp_path / "built").iterdir()
    scripts = _empty_environment(tmp_path / "environment")
    ran([scripts / "pip", "install", "-q", wanted], checkout)
    ran([scripts / "pip", "check"], elsewhere)
    shutil.rmtree(checkout)

    told = ran([scripts / "wonderful-team", "demo"], elsewhere)
    assert told.count("INJECTED") == 2
    assert "SUCCESS" in told
    assert (elsewhere / told.splitlines()[-1].removeprefix("page: ")).is_file()
    code = "import wonderful_team, importlib.util; print(wonderful_team.__file__, importlib.util.find_spec('pydantic_ai') is not None)"
    place, vendors = ran([scripts / "python", "-I", "-c", code], elsewhere).split()
    assert Path(place).is_relative_to(tmp_path / "environment")
    assert (vendors == "True") == (what == ".[vendors]")
