"""How far a study is: read from its store, told at most once a second."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from wonderful_team.core.caps import Caps
from wonderful_team.core.text import counted
from wonderful_team.evals.spending import CapReached, Spending
from wonderful_team.evals.store import Store


@dataclass(frozen=True)
class StudyStatus:
    """Where a study stands.

    Attributes:
        total, done: Trials asked for and ended.
        here: Trials that ended since this command began.
        outcomes: How many ended with each outcome.
    """

    total: int
    done: int
    here: int
    outcomes: dict[str, int]
    spent: Spending
    seconds: float

    @property
    def seconds_left(self) -> float | None:
        """At the rate so far; None before anything ended."""
        return (self.total - self.done) * self.seconds / self.here if self.here else None

    def line(self) -> str:
        """For a terminal."""
        rate = f"{self.here / self.seconds:.2g} trials/s" if self.seconds else ""
        counts = "  ".join(f"{name} {count}" for name, count in sorted(self.outcomes.items(), reverse=True))
        money = f"{self.spent.usd:.2f} USD" if not self.spent.unpriced else f"{self.spent.usd:.2f} USD + unknown"
        left = "" if self.seconds_left is None else f"  {_duration(self.seconds_left)} left"
        return f"{self.done}/{self.total}  {counts}  {counted(self.spent.calls, 'call')}  {money}  {rate}{left}"


Report = Callable[[str, StudyStatus | None], None]
"""Told a message, or "" with where the study stands."""


class StudyMonitor:
    """Looks at a store and tells how far a study is."""

    def __init__(self, store: Store, study: str, report: Report) -> None:
        self.store, self.study, self.report = store, study, report
        self._began = time.monotonic()
        self._total = store.count_all(study)
        self._before = store.count(study, "done")
        self._told = self._began

    def status(self) -> StudyStatus:
        done = self.store.count(self.study, "done")
        return StudyStatus(
            self._total,
            done,
            done - self._before,
            self.store.outcomes(self.study),
            self.store.spending(self.study),
            time.monotonic() - self._began,
        )

    def restart_clock(self) -> None:
        """Count the rate from now on: what came before was setting up."""
        self._began = time.monotonic()

    def look(self) -> bool:
        """Report at most once a second."""
        if time.monotonic() - self._told >= 1.0:
            self._told = time.monotonic()
            self.report("", self.status())
        return True

    @property
    def missing(self) -> int:
        """Trials that have not ended."""
        return self._total - self.store.count(self.study, "done")

    def why(self, caps: Caps, late: bool) -> str:
        """Why trials are missing; "" when none is."""
        if not self.missing:
            return ""
        try:
            self.store.check_caps(self.study, caps)
        except CapReached as error:
            return str(error)
        if late:
            return f"the study's cap {'on time' if caps.seconds is None else f'of {caps.seconds:g} seconds'} is reached"
        return f"not ended yet: {counted(self.missing, 'trial')}; the same command goes on with them"


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
