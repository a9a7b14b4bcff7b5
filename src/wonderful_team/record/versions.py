"""What a record says of the software that made it."""

from __future__ import annotations

import platform
import subprocess
from functools import cache
from importlib import metadata
from pathlib import Path

PACKAGES = ("wonderful-team", "numpy", "opencv-python-headless", "scikit-image", "pillow", "pydantic", "mujoco")


def versions() -> dict[str, str | None]:
    """Versions of what took part, Python, the platform, and the commit when run from a git checkout: as first looked up.

    What is loaded stays loaded, whatever is installed or checked out meanwhile.
    """
    return dict(_found())


@cache
def _found() -> dict[str, str | None]:
    found: dict[str, str | None] = {}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = None
    found["python"] = platform.python_version()
    found["platform"] = f"{platform.system()} {platform.machine()}"
    found["commit"] = commit()
    return found


def commit() -> str | None:
    """The commit of our own checkout, with "+" when files were changed; None for an installed package."""
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists() or not (root / "pyproject.toml").is_file():
        return None
    head = _git(root, "rev-parse", "--short=12", "HEAD")
    if head is None:
        return None
    changed = _git(root, "status", "--porcelain", "--untracked-files=no")
    return head + ("+" if changed else "")


def _git(root: Path, *words: str) -> str | None:
    try:
        done = subprocess.run(["git", "-C", str(root), *words], capture_output=True, text=True, timeout=5, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
