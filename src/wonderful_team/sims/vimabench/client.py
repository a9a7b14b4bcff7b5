"""The benchmark's process: which interpreter runs it, and whether it can."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

from wonderful_team.sims.process.client import Service, Simulator
from wonderful_team.sims.vimabench.finding import Installation, find_installation, missing

OPEN_TIMEOUT_S = 300.0
"""Import, make and reset take about 3 s on an idle machine."""
STEP_TIMEOUT_S = 600.0
"""An action takes 1 to 2 s of processor time; its own limit of 5 s a motion counts processor time too."""
NOISE = re.compile(r"text argument:[^\n]*\n|int args: \[")
"""What its physics engine prints at every picture of a scene, without an end of line."""


def start(installation: Installation) -> Simulator:
    """One process with one environment in it.

    Raises:
        ConfigError: The interpreter cannot be started.
    """
    folder = Path(__file__).with_name("remote")
    return Simulator(Service(installation.python, folder, partial(missing, installation), NOISE))


def check_ready() -> dict[str, str]:
    """Whether the user's copy is there and can be imported; takes as long as its import, about 2 s.

    Returns:
        Versions of what the simulator runs on.

    Raises:
        ConfigError: It is not; says how to get it.
        WorldUnavailableError: Its process failed in another way.
    """
    installation = find_installation()
    simulator = start(installation)
    try:
        said, _ = simulator.ask("hello", timeout_s=OPEN_TIMEOUT_S, path=installation.path)
        return {str(name): str(version) for name, version in said["versions"].items()}
    finally:
        simulator.close()
