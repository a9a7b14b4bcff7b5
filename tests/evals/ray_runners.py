"""Stand-ins for the top's runner on a Ray cluster: they say where they ran, wait to be let go, and watch what is opened."""

from __future__ import annotations

import asyncio
import os
import sys
import time
from pathlib import Path

from tests.evals.runners import _hold, quick
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec

opened: list[str] = []
"""Every file and database that this process opened since this module was imported."""


def _watch(event: str, args: tuple[object, ...]) -> None:
    if event in ("open", "sqlite3.connect"):
        opened.append(str(args[0]))


sys.addaudithook(_watch)


def _log(settings: RunSettings, line: str) -> None:
    with open(settings.extra["log"], "a", encoding="utf-8") as file:
        file.write(f"{line}\n")


def gated(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Runs until the file named `go` is there, at most two minutes."""
    _log(settings, f"begin {os.getpid()} {spec.key}")
    until = time.monotonic() + 120
    while not Path(settings.extra["go"]).exists() and time.monotonic() < until:
        time.sleep(0.05)
    return quick(spec, settings)


def calling(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Says where it runs and, once trials run in two processes, makes a call through the shared limiter and says when."""
    os.environ["TOY_LOG"] = settings.extra["log"]
    _log(settings, f"by {os.getpid()}")
    until = time.monotonic() + 120
    while time.monotonic() < until:
        lines = Path(settings.extra["log"]).read_text(encoding="utf-8").splitlines()
        if len({line for line in lines if line.startswith("by")}) == 2:
            break
        time.sleep(0.05)
    asyncio.run(_hold(settings))
    return quick(spec, settings)


def watched(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Says which databases its process opened: one in memory that it opens itself, and nothing else."""
    import sqlite3

    sqlite3.connect(":memory:").close()
    held = [os.readlink(path) for path in Path("/proc/self/fd").iterdir() if path.is_symlink()]
    return TrialRow(
        "success",
        facts={
            "seen": float(":memory:" in opened),
            "opened": float(sum(".db" in name for name in opened)),
            "held": float(sum(".db" in name for name in held)),
        },
    )


def deadly(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Kills its own process on one trial."""
    if spec.seed == 1001 and spec.condition.method == "bad" and spec.task == "toy/a":
        os._exit(7)
    return quick(spec, settings)
