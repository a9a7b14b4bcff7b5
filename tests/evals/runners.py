"""Stand-ins for the top's runner, importable by worker processes: the study's machinery is tested, not a planner."""

from __future__ import annotations

import asyncio
import hashlib
import os
import time

from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.suites import Protocol, Suite
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec

TOY = Suite("toy", ("toy/a", "toy/b"), Protocol("toy", 10, 0))


def toy_plan(seeds: int = 10, **more: object) -> StudyPlan:
    """A plan whose trials only the runners here can run."""
    settings = {"methods": ("good", "bad"), "models": ("m",), "controls": (), "seeds": tuple(range(1000, 1000 + seeds))}
    return StudyPlan((TOY,), **{**settings, **more})  # type: ignore[arg-type]


def wins(spec: TrialSpec) -> bool:
    """What a stand-in trial comes to: decided by the trial alone, so that it can be recomputed by hand."""
    digest = hashlib.sha256(f"{spec.key}".encode()).digest()[0]
    return digest < (200 if spec.condition.method == "good" else 60)


def quick(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """A trial that takes no time."""
    if wins(spec):
        return TrialRow("success", calls=3, tokens=100, usd=0.01, rounds=2, seconds=1.0)
    return TrialRow("failure", "grounding", "missed", calls=5, tokens=150, usd=0.02, rounds=4, seconds=2.0)


def slow(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """A trial that takes a moment, and leaves a line in a log file: one per time that it is really run."""
    log = os.environ["TOY_LOG"]
    with open(log, "a", encoding="utf-8") as file:
        file.write(f"begin {spec.key}\n")
    time.sleep(0.02)
    with open(log, "a", encoding="utf-8") as file:
        file.write(f"end {spec.key}\n")
    return quick(spec, settings)


def capped_slow(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Spends ten calls as `capped` does, and takes a moment."""
    slow(spec, settings)
    return capped(spec, settings)


def free_slow(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Asks a model that costs nothing, and takes a moment."""
    slow(spec, settings)
    return TrialRow("success", calls=5, usd=0.0)


def breaking(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Raises on some seeds, as long as the file named by TOY_BROKEN exists."""
    if spec.seed % 5 == 0 and os.path.exists(os.environ.get("TOY_BROKEN", "")):
        raise ConnectionError("the provider hung up")
    return quick(spec, settings)


def dying(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Kills its own process on one trial."""
    if spec.seed == 1001 and spec.condition.method == "bad" and spec.task == "toy/a":
        os._exit(7)
    return quick(spec, settings)


def capped(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Spends ten calls, or as many as it may and then fails at stage budget, as the real runner does."""
    allowed = settings.caps.calls
    if allowed is not None and allowed < 10:
        return TrialRow("failure", "budget", f"the cap of {allowed} calls is reached ({allowed} made)", calls=allowed)
    return TrialRow("success", calls=10, usd=None)


async def _hold(settings: RunSettings) -> None:
    assert settings.limiter is not None
    await settings.limiter.acquire()
    began = time.monotonic()
    await asyncio.sleep(0.1)
    ended = time.monotonic()
    await settings.limiter.release()
    if "TOY_LOG" in os.environ:
        with open(os.environ["TOY_LOG"], "a", encoding="utf-8") as file:
            file.write(f"{began} {ended}\n")


def limited(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Makes one call through the shared limiter."""
    asyncio.run(_hold(settings))
    return quick(spec, settings)
