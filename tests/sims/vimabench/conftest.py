"""A stand-in for VIMA-Bench behind the real pipe, and the marker of tests that need the real one."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from wonderful_team.errors import ConfigError
from wonderful_team.sims.vimabench import VimaWorld, find_installation
from wonderful_team.sims.vimabench.finding import PATH_VARIABLE, PYTHON_VARIABLE

STAND_IN = Path(__file__).with_name("stand_in")
_REAL = {name: os.environ.get(name, "") for name in (PYTHON_VARIABLE, PATH_VARIABLE)}


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", f"vimabench: needs your own copy of VIMA-Bench ({', '.join(_REAL)})")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    try:
        find_installation()
    except ConfigError as error:
        reason = str(error).partition("\n")[0]
        for item in items:
            if "vimabench" in item.keywords and item.get_closest_marker("vimabench"):
                item.add_marker(pytest.mark.skip(reason=reason))


@pytest.fixture(autouse=True)
def _installation(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stand-in, unless a test asks for the real benchmark."""
    wanted = _REAL
    if request.node.get_closest_marker("vimabench") is None:
        wanted = {PYTHON_VARIABLE: sys.executable, PATH_VARIABLE: str(STAND_IN)}
    for name, value in wanted.items():
        monkeypatch.setenv(name, value) if value else monkeypatch.delenv(name, raising=False)


@pytest.fixture
def open_world() -> Iterator[Callable[..., VimaWorld]]:
    """Makes worlds that are closed when the test ends."""
    made: list[VimaWorld] = []

    def make(task: str, seed: int = 0, **more: Any) -> VimaWorld:
        made.append(VimaWorld(task, seed, **more))
        return made[-1]

    yield make
    for world in made:
        world.close()
