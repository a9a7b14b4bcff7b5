"""Every test runs without a network, without keys, and with run folders in a place of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from wonderful_team.models.cache_store import FILE_VARIABLE
from wonderful_team.record.run_folders import OUT_VARIABLE

SECRET_ENDINGS = ("_KEY", "_TOKEN", "_SECRET")


OPT_IN = {
    "slow": "takes more than ten seconds",
    "install": "installs packages: takes minutes and needs the package index",
    "detectors": "loads torch and transformers: takes a minute and needs the optional part detectors (docs/detectors.md)",
    "servers": "starts real model servers: takes minutes and needs one installed (docs/models.md)",
}


def pytest_addoption(parser: pytest.Parser) -> None:
    for marker, why in OPT_IN.items():
        parser.addoption(
            f"--run{marker}", action="store_true", default=False, help=f"run what is marked {marker}: {why}"
        )


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for marker, why in OPT_IN.items():
        if config.getoption(f"--run{marker}"):
            continue
        for item in items:
            if item.get_closest_marker(marker) is not None:
                item.add_marker(pytest.mark.skip(reason=f"{marker}: {why}; use --run{marker}"))


@pytest.fixture(autouse=True)
def _no_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    """A key that happens to be set must never be spent by a test."""
    import os

    for name in list(os.environ):
        if name.endswith(SECRET_ENDINGS):
            monkeypatch.delenv(name)


@pytest.fixture(autouse=True)
def runs_folder(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where this test's run folders go."""
    folder = tmp_path_factory.mktemp("runs")
    monkeypatch.setenv(OUT_VARIABLE, str(folder))
    # Neither a profile that the user saved nor one that another test saved may decide how this test asks.
    monkeypatch.setenv("WONDERFUL_TEAM_CONFIG", str(folder.with_name(f"{folder.name}-config")))
    # Kept answers of one test must never answer for another.
    monkeypatch.setenv(FILE_VARIABLE, str(folder.with_name(f"{folder.name}-answers.sqlite")))
    return folder


@pytest.fixture(autouse=True)
def _records_fit_their_schema(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every record that any test writes is what the published schema says."""
    from wonderful_team.record.record_schema import read_record
    from wonderful_team.record.recorder import Recorder

    close = Recorder.close

    def checked(recorder: Recorder) -> None:
        close(recorder)
        read_record(recorder.folder)

    monkeypatch.setattr(Recorder, "close", checked)
