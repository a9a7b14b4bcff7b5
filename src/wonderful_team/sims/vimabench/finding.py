"""Where the user's own copy of VIMA-Bench is, and how to get one."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError

PYTHON_VARIABLE = "WONDERFUL_TEAM_VIMABENCH_PYTHON"
PATH_VARIABLE = "WONDERFUL_TEAM_VIMABENCH_PATH"
STEPS = f"""\
To get it (no GPU and no display are needed; its pins conflict with ours, so it has a Python environment of its own):
  git clone https://github.com/vimalabs/VIMABench
  python3 -m venv vimabench-env
  vimabench-env/bin/pip install pybullet gym==0.26.2 opencv-python-headless omegaconf importlib_resources transforms3d einops
  export {PATH_VARIABLE}="$PWD/VIMABench"
  export {PYTHON_VARIABLE}="$PWD/vimabench-env/bin/python"
Then `wonderful-team doctor` says whether it works. Without it, every task also stands on our own table, as in tabletop/rotate."""


@dataclass(frozen=True)
class Installation:
    """Which interpreter runs the simulator, and a source checkout it looks in first ("" for none)."""

    python: str
    path: str


def find_installation() -> Installation:
    """The user's copy, as the environment variables say, or in this interpreter.

    Raises:
        ConfigError: There is none, or a variable names what does not exist; says what to do.
    """
    python, path = os.environ.get(PYTHON_VARIABLE, "").strip(), os.environ.get(PATH_VARIABLE, "").strip()
    if path:
        folder = user_path(path).resolve()
        if not (folder / "vima_bench").is_dir():
            raise ConfigError(
                f"{PATH_VARIABLE}={path!r}: valid is a checkout of VIMA-Bench, a folder that holds vima_bench/.\n{STEPS}"
            )
        path = str(folder)
    if python:
        found = shutil.which(str(user_path(python)))
        if found is None:
            raise ConfigError(f"{PYTHON_VARIABLE}={python!r}: valid is a Python interpreter.\n{STEPS}")
        return Installation(str(Path(found).absolute()), path)
    if not path and importlib.util.find_spec("vima_bench") is None:
        raise ConfigError(
            "the world vimabench runs your own copy of VIMA-Bench, and none was found: neither "
            f"{PYTHON_VARIABLE} nor {PATH_VARIABLE} is set, and this Python cannot import vima_bench.\n{STEPS}"
        )
    return Installation(sys.executable, path)


def missing(installation: Installation, reason: str) -> ConfigError:
    """The error for a copy that cannot be imported."""
    where = f" with {PATH_VARIABLE}={installation.path!r}" if installation.path else ""
    return ConfigError(f"{installation.python}{where} cannot import vima_bench: {reason}.\n{STEPS}")
