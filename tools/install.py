"""Set up the environment that `make` uses: exactly what requirements.lock names, then the package itself.

The lock is complete, so nothing is resolved or built: every package comes at its locked version, as a wheel, with its hash checked, and no
index is asked about anything else. What has been published since cannot change or break a set-up. `uv` installs where it is on the PATH,
otherwise the pip that came with Python (22.3 or newer; 22.3 came with Python 3.11.0).

A folder is ready when its stamp says so, and the stamp is written last: a set-up that was interrupted, a changed lock or a moved checkout
is set up anew. Downloads are kept by pip and uv, so that the second try is short. A folder that this script did not make is left alone.
"""

from __future__ import annotations

import argparse
import contextlib
import fcntl
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "requirements.lock"
PROJECT = ROOT / "pyproject.toml"
READY, UNFINISHED = ".ready", ".unfinished"
LIMIT_S = 3600
"""For one command and for waiting on another set-up; a slow line takes minutes."""
REDIRECTING = (
    "PYTHONHOME PYTHONPATH PIP_CONSTRAINT PIP_NO_BINARY PIP_PREFIX PIP_REQUIREMENT PIP_ROOT PIP_TARGET".split()
)
REDIRECTING += "UV_BUILD_CONSTRAINT UV_CONSTRAINT UV_NO_BINARY UV_OVERRIDE UV_PREFIX UV_TARGET".split()
"""Settings that would install elsewhere, or something else. Indexes, proxies and certificates stay as the user set them."""


class SetupError(Exception):
    """The set-up cannot go on; says what to do."""


def main(arguments: list[str]) -> int:
    """Set up the folder unless it is ready. Exit code 0 when it is ready, 1 when it is not, 130 when interrupted."""
    parser = argparse.ArgumentParser(description="Install the lock, then this checkout, into an environment.")
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / ".venv", help="The environment. [.venv]")
    parser.add_argument(
        "--pip", type=Path, metavar="WHEEL", help="Install with the pip in this wheel. [uv, or Python's pip]"
    )
    options = parser.parse_args(arguments)
    folder = Path(os.path.abspath(options.folder))
    try:
        with _alone():
            set_up(folder, options.pip)
    except SetupError as error:
        print(f"{folder} is not ready: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"\ninterrupted: {folder} is not ready; the same command sets it up anew", file=sys.stderr)
        return 130
    return 0


def set_up(folder: Path, pip: Path | None) -> None:
    """Bring the folder to what the lock and the project say; nothing is done where it is there already."""
    lock = hashlib.sha256(LOCK.read_bytes() + Path(__file__).read_bytes()).hexdigest()
    wanted = {"folder": str(folder), "lock": lock, "project": hashlib.sha256(PROJECT.read_bytes()).hexdigest()}
    stamp = _stamp(folder)
    if stamp == wanted:
        return
    if {**stamp, "project": ""} == {**wanted, "project": ""}:
        (folder / READY).rename(folder / UNFINISHED)
        installer = _installer(folder, pip)
    else:
        _create(folder)
        installer = _installer(folder, pip)
        print(f"installing {LOCK.name} into {folder} with {installer.name}: a few minutes the first time", flush=True)
        _run(installer.install("--no-deps", "--require-hashes", "--only-binary", ":all:", "-r", str(LOCK)))
    _run(installer.install("--no-deps", "--no-build-isolation", "--no-index", "--editable", str(ROOT)))
    _run(installer.check())
    (folder / UNFINISHED).write_text(json.dumps(wanted), encoding="utf-8")
    (folder / UNFINISHED).rename(folder / READY)


def _stamp(folder: Path) -> dict[str, str]:
    """What the folder was set up for; empty when it was never finished or its Python is gone."""
    try:
        stamp = json.loads((folder / READY).read_text(encoding="utf-8"))
        subprocess.run([folder / "bin" / "python", "-I", "-c", ""], check=True, capture_output=True, timeout=60)
    except (OSError, ValueError, subprocess.SubprocessError):
        return {}
    return stamp if isinstance(stamp, dict) else {}


def _create(folder: Path) -> None:
    """An empty environment. Only a folder that this script made is removed for it."""
    ours = not folder.is_symlink() and any((folder / name).is_file() for name in (READY, UNFINISHED))
    if ours:
        (folder / READY).unlink(missing_ok=True)
        (folder / UNFINISHED).touch()
        for entry in folder.iterdir():
            if entry.is_dir() and not entry.is_symlink():
                shutil.rmtree(entry)
            elif entry.name != UNFINISHED:
                entry.unlink()
    elif os.path.lexists(folder) and (not folder.is_dir() or any(folder.iterdir())):
        raise SetupError(
            "it was not made by this set-up and is left alone; move it away, or name another: make VENV=DIR ..."
        )
    folder.mkdir(parents=True, exist_ok=True)
    (folder / UNFINISHED).touch()
    # The environment may be active while it is replaced: the Python that it was made from makes the new one.
    base = getattr(sys, "_base_executable", None) or sys.executable
    _run([base, "-I", "-m", "venv", str(folder)])


@dataclass(frozen=True)
class Installer:
    """A pip or a uv that installs into one environment."""

    command: list[str]
    options: list[str]
    name: str
    """With its version, which people need when they report that something went wrong."""

    def install(self, *words: str) -> list[str]:
        return [*self.command, "install", *self.options, *words]

    def check(self) -> list[str]:
        return [*self.command, "check", *(word for word in self.options if not word.startswith("-q"))]


def _installer(folder: Path, pip: Path | None) -> Installer:
    """The uv on the PATH, otherwise pip; the user's choice first."""
    chosen, uv = os.environ.get("WONDERFUL_TEAM_INSTALLER", ""), shutil.which("uv")
    if chosen not in ("", "pip", "uv"):
        raise SetupError(f"WONDERFUL_TEAM_INSTALLER is {chosen!r}; valid: pip, uv")
    if chosen == "uv" and uv is None:
        raise SetupError("WONDERFUL_TEAM_INSTALLER is uv, and no uv is on the PATH")
    python = str(folder / "bin" / "python")
    command: list[str] = [python, "-I", *(["-m", "pip"] if pip is None else [str(pip.resolve() / "pip")])]
    installer = Installer(command, ["-qq"], _version(command))
    if uv is not None and pip is None and chosen != "pip":
        installer = Installer([uv, "pip"], ["-q", "--python", python], _version([uv]))
    return installer


def _version(command: list[str]) -> str:
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=60, check=False)
    return f"{done.stdout.split(' from ')[0].strip()} and Python {sys.version.split()[0]}"


def _run(command: list[str]) -> None:
    """Run one command of the set-up and show what it says when it fails."""
    environment = {name: value for name, value in os.environ.items() if name not in REDIRECTING}
    environment |= {"PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_USER": "0"}
    try:
        subprocess.run(command, env=environment, timeout=LIMIT_S, check=True, stdout=subprocess.PIPE, text=True)
    except subprocess.TimeoutExpired as error:
        raise SetupError(f"{' '.join(command)} took longer than {LIMIT_S} s and was stopped") from error
    except subprocess.CalledProcessError as error:
        print(error.stdout, end="", file=sys.stderr)
        raise SetupError(
            f"exit code {error.returncode} from {' '.join(command)}; what it said stands above. "
            "Once that is solved, the same command sets it up anew (WONDERFUL_TEAM_INSTALLER=pip or uv chooses the installer)"
        ) from error


@contextlib.contextmanager
def _alone() -> Iterator[None]:
    """Two set-ups of one checkout wait for each other."""
    with LOCK.open("rb") as file:
        until = time.monotonic() + LIMIT_S
        said = False
        while True:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > until:
                    raise SetupError(f"another set-up has been at work for {LIMIT_S} s") from None
                if not said:
                    print("another set-up of this checkout is at work; waiting for it", file=sys.stderr, flush=True)
                said = True
                time.sleep(0.5)
            except OSError:
                break  # a file system without locks
        yield


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
