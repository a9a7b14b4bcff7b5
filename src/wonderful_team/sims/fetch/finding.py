"""Where gymnasium-robotics is, and how to get it."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys
from pathlib import Path

from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError
from wonderful_team.sims.process.client import Service, Simulator

PYTHON_VARIABLE = "WONDERFUL_TEAM_FETCH_PYTHON"
PACKAGE = "gymnasium_robotics"
REMOTE = Path(__file__).with_name("remote")
STEPS = f"""\
To get it (no GPU and no display are needed; it does not work with our MuJoCo, so it has a Python environment of its own):
  python3 -m venv fetch-env
  fetch-env/bin/pip install "gymnasium-robotics==1.4.2" "mujoco<3.12"
  export {PYTHON_VARIABLE}="$PWD/fetch-env/bin/python"
Then `wonderful-team doctor` says whether it works."""
OPEN_TIMEOUT_S = 120.0
"""Import and set-up take about 2 s on an idle machine."""


def find_python() -> str:
    """The interpreter that has gymnasium-robotics: the one that the environment variable names, else this one.

    Raises:
        ConfigError: There is none; says what to do.
    """
    named = os.environ.get(PYTHON_VARIABLE, "").strip()
    if named:
        found = shutil.which(str(user_path(named)))
        if found is None:
            raise ConfigError(f"{PYTHON_VARIABLE}={named!r}: valid is a Python interpreter.\n{STEPS}")
        return str(Path(found).absolute())
    if importlib.util.find_spec(PACKAGE) is None:
        raise ConfigError(
            f"the world fetch runs the Fetch of gymnasium-robotics, and none was found: {PYTHON_VARIABLE} is not set, and "
            f"this Python cannot import {PACKAGE}.\n{STEPS}"
        )
    return sys.executable


def start(python: str) -> Simulator:
    """Its process.

    Raises:
        ConfigError: The interpreter cannot be started.
    """

    def missing(reason: str) -> ConfigError:
        return ConfigError(f"{python} cannot run {PACKAGE}: {reason}.\n{STEPS}")

    return Simulator(Service(python, REMOTE, missing))


def check_ready() -> dict[str, str]:
    """Whether the simulator is there and can be imported; takes as long as its import, about 1 s.

    Returns:
        Versions of what it runs on.

    Raises:
        ConfigError: It is not; says how to get it.
        WorldUnavailableError: Its process failed in another way.
    """
    simulator = start(find_python())
    try:
        said, _ = simulator.ask("hello", timeout_s=OPEN_TIMEOUT_S)
        return {str(name): str(version) for name, version in said["versions"].items()}
    finally:
        simulator.close()
