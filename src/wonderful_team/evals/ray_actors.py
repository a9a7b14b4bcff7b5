"""What runs on a Ray cluster: workers that run trials, and the one place that bounds model calls of them all.

None of it opens a store: a worker is handed a trial and hands back what came of it.
"""

from __future__ import annotations

import asyncio
import importlib
import os
import platform
import socket
import tempfile
import uuid
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from typing import Any

from wonderful_team.core.deadline import GRACE_S
from wonderful_team.core.heap import Growth
from wonderful_team.core.interrupts import in_thread
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.evals.shipment import Parcel, zipped
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialRunner, TrialSpec
from wonderful_team.evals.workers import run_safely
from wonderful_team.redaction import redact_streams

DECIDING = ("numpy", "mujoco", "opencv-python-headless", "scikit-image", "shapely")
"""Packages on whose version the last bit of a result depends."""
_GROWTH = Growth(own_process=True)
"""Of this worker, over its trials."""


class Places:
    """Runs as an actor: hands out the places of all workers' model calls."""

    def __init__(self, places: int) -> None:
        self._free, self._most = places, 0
        self._held: dict[str, str] = {}
        self._waiting: OrderedDict[str, tuple[str, asyncio.Future[None]]] = OrderedDict()
        self._gone: set[str] = set()

    async def acquire(self, worker: str, ticket: str) -> None:
        """Wait for a place; whoever waits longest gets the next one."""
        if worker in self._gone:
            return
        if not self._free:
            self._waiting[ticket] = (worker, asyncio.get_running_loop().create_future())
            await self._waiting[ticket][1]
            return
        self._free -= 1
        self._give(worker, ticket)

    async def release(self, *tickets: str) -> None:
        """Give places back, held or only waited for."""
        for ticket in tickets:
            waited = self._waiting.pop(ticket, None)
            if waited is not None:
                waited[1].set_result(None)
            elif self._held.pop(ticket, None) is not None:
                self._next()

    async def lost(self, worker: str) -> None:
        """Free what a worker held that is gone, and forget what it waited for."""
        self._gone.add(worker)
        mine = [ticket for ticket, holder in self._held.items() if holder == worker]
        mine += [ticket for ticket, (waiter, _) in self._waiting.items() if waiter == worker]
        await self.release(*mine)

    async def most(self) -> int:
        """Most places that were ever taken at once."""
        return self._most

    def _give(self, worker: str, ticket: str) -> None:
        self._held[ticket] = worker
        self._most = max(self._most, len(self._held))

    def _next(self) -> None:
        if not self._waiting:
            self._free += 1
            return
        ticket, (worker, future) = self._waiting.popitem(last=False)
        self._give(worker, ticket)
        future.set_result(None)


class RayLimiter:
    """A trial's side of `Places`."""

    def __init__(self, places: Any, worker: str) -> None:
        self._places, self._worker = places, worker
        self._mine: list[str] = []

    async def acquire(self) -> None:
        ticket = uuid.uuid4().hex
        try:
            await self._places.acquire.remote(self._worker, ticket)
        except BaseException:
            self._places.release.remote(ticket)  # given up while it waited: a deadline, an interrupt
            raise
        self._mine.append(ticket)

    async def release(self) -> None:
        if self._mine:
            self._places.release.remote(self._mine.pop())

    def release_all(self) -> None:
        """What a trial left behind."""
        left, self._mine = self._mine, []
        if left:
            self._places.release.remote(*left)


@dataclass(frozen=True)
class Hello:
    """What a worker says of itself before its first trial.

    Attributes:
        fault: Why it cannot run the study; "" when it can.
        niceness: How far it steps back behind other processes; Ray's default for workers is 15.
        versions: Of Python and the packages that decide the last bit of a result; None where one is missing.
    """

    host: str
    node: str
    niceness: int
    versions: Mapping[str, str | None]
    fault: str = ""


def versions_here() -> dict[str, str | None]:
    """As `Hello` has them."""
    found: dict[str, str | None] = {"Python": platform.python_version()}
    for name in DECIDING:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = None
    return found


class TrialWorker:
    """Runs as an actor: trials of one study, as many at once as it is asked to."""

    def __init__(self, runner: TrialRunner, parcel: Parcel, places: Any, name: str) -> None:
        redact_streams()  # what the user's code prints lands in Ray's logs
        self._runner, self._parcel, self._places, self._name = runner, parcel, places, name
        parcel.unpack()

    async def hello(self) -> Hello:
        """Whether the study can be run here."""
        fault = ""
        try:
            await in_thread(self._parcel.ready, name="ready")
        except WonderfulTeamError as error:
            fault = str(error)
        node = str(importlib.import_module("ray").get_runtime_context().get_node_id())[:8]
        niceness = os.getpriority(os.PRIO_PROCESS, 0) if hasattr(os, "getpriority") else 0
        return Hello(socket.gethostname(), node, niceness, versions_here(), fault)

    async def run(self, spec: TrialSpec, settings: RunSettings) -> tuple[TrialRow, bytes]:
        """What came of a trial, and its run folder, if it keeps one; the row's page is then a name in there."""
        limiter = None if self._places is None else RayLimiter(self._places, self._name)
        limit_s = settings.caps.seconds
        # In a folder that Ray removes, should this process be killed.
        with tempfile.TemporaryDirectory(dir=os.getcwd(), ignore_cleanup_errors=True) as name:
            here = replace(settings, limiter=limiter, out=Path(name))
            trial = in_thread(run_safely, self._runner, spec, here, name="trial")
            try:
                row: TrialRow = await asyncio.wait_for(trial, None if limit_s is None else limit_s + GRACE_S)
            except TimeoutError:
                # Its thread is left behind: what it still does counts for nothing.
                why = f"the cap of {limit_s:g} s is reached and the trial did not come back"
                row = TrialRow("failure", "budget", why, usd=None, seconds=limit_s or 0.0)
            finally:
                if limiter is not None:
                    limiter.release_all()
            page = str(Path(row.page).relative_to(name)) if row.page else ""
            folder = zipped(Path(name)) if settings.out is not None else b""
        _GROWTH.give_back()
        return replace(row, page=page), folder
