"""A stand-in for gymnasium-robotics behind the real pipe, and the marker of tests that need the real one."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from wonderful_team.errors import ConfigError
from wonderful_team.sims.fetch import FetchWorld
from wonderful_team.sims.fetch.finding import PYTHON_VARIABLE, find_python

STAND_IN = Path(__file__).with_name("stand_in")
_REAL = os.environ.get(PYTHON_VARIABLE, "")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", f"fetch: needs gymnasium-robotics ({PYTHON_VARIABLE})")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    try:
        find_python()
    except ConfigError as error:
        reason = str(error).partition("\n")[0]
        for item in items:
            if item.get_closest_marker("fetch"):
                item.add_marker(pytest.mark.skip(reason=reason))


@pytest.fixture(autouse=True)
def remote(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stand-in, unless a test asks for the real simulator."""
    if request.node.get_closest_marker("fetch"):
        return
    monkeypatch.setenv(PYTHON_VARIABLE, sys.executable)
    monkeypatch.setattr("wonderful_team.sims.fetch.finding.REMOTE", STAND_IN)


@pytest.fixture
def open_world() -> Iterator[Callable[..., FetchWorld]]:
    """Makes worlds that are closed when the test ends."""
    made: list[FetchWorld] = []

    def make(task: str = "lid", seed: int = 0, **more: Any) -> FetchWorld:
        made.append(FetchWorld(task, seed, **more))
        return made[-1]

    yield make
    for world in made:
        world.close()
