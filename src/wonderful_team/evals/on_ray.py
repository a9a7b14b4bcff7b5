"""Trials on a Ray cluster: actors run them, this process keeps the store, and one limiter bounds model calls of all."""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wonderful_team.errors import ConfigError, MissingExtraError
from wonderful_team.evals.leases import RENEW_EVERY_S, Owner
from wonderful_team.evals.spending import CapReached
from wonderful_team.evals.store import Store
from wonderful_team.evals.stored_rows import Claim
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialRunner, TrialSpec
from wonderful_team.evals.workers import POLL_S, Work, run_safely, settle, tighter

if TYPE_CHECKING:
    from wonderful_team.evals.monitor import StudyMonitor

LOCAL = "local"
MAX_TRIES = 3
"""A trial that so many actors died over is an error, ours."""


class Places:
    """Runs as an actor: hands out the places of all workers' model calls."""

    def __init__(self, places: int) -> None:
        self._free = asyncio.Semaphore(places)
        self._taken = self._most = 0

    async def acquire(self) -> None:
        await self._free.acquire()
        self._taken += 1
        self._most = max(self._most, self._taken)

    async def release(self) -> None:
        self._taken -= 1
        self._free.release()

    async def most(self) -> int:
        """Most places that were ever taken at once."""
        return self._most


class RayLimiter:
    """The worker's side of `Places`."""

    def __init__(self, actor: Any) -> None:
        self._actor = actor

    async def acquire(self) -> None:
        await self._actor.acquire.remote()

    async def release(self) -> None:
        await self._actor.release.remote()


class TrialWorker:
    """Runs as an actor: one trial at a time."""

    def __init__(self, runner: TrialRunner) -> None:
        self._runner = runner

    def run(self, spec: TrialSpec, settings: RunSettings) -> TrialRow:
        return run_safely(self._runner, spec, settings)


def run_on_ray(
    work: Work, store: Store, monitor: StudyMonitor, address: str, jobs: int, calls_at_once: int | None
) -> int:
    """Run what is missing of a study on a cluster.

    Args:
        work: What is to be done.
        store: Kept by this process alone; workers never open it, so it needs no shared disk.
        monitor: Told how it goes.
        address: Of the cluster; "local" starts one here.
        jobs: Actors.
        calls_at_once: Most model calls in flight over all actors; None for each trial's own limit.

    Returns:
        Most model calls that were ever in flight at once; 0 without a limit.

    Raises:
        MissingExtraError: ray is not installed.
        ConfigError: No cluster answers at the address.
    """
    try:
        ray = importlib.import_module("ray")
    except ModuleNotFoundError as error:
        raise MissingExtraError("--ray", "ray") from error
    began = not ray.is_initialized()
    if began:
        where = {"num_cpus": jobs, "include_dashboard": False} if address == LOCAL else {"address": address}
        try:
            ray.init(log_to_driver=False, **where)
        except Exception as error:  # ray raises bare Exceptions when a node does not start in time
            raise ConfigError(f"--ray {address}: no cluster answers: {error}") from error
    try:
        places = ray.remote(num_cpus=0, max_concurrency=1000)(Places).remote(calls_at_once) if calls_at_once else None
        if places is not None:
            work = replace(work, settings=replace(work.settings, limiter=RayLimiter(places)))
        _Cluster(ray, work, store, monitor, jobs).run()
        return int(ray.get(places.most.remote())) if places is not None else 0
    finally:
        if began:
            ray.shutdown()


class _Cluster:
    """Keeps actors busy and books what they hand back."""

    def __init__(self, ray: Any, work: Work, store: Store, monitor: StudyMonitor, jobs: int) -> None:
        self._ray, self._work, self._store, self._watch = ray, work, store, monitor
        self._owner = Owner.this_process()
        self._make = ray.remote(num_cpus=1)(TrialWorker)
        self._idle = [self._make.remote(work.runner) for _ in range(jobs)]
        self._running: dict[Any, tuple[Any, Claim]] = {}
        self._tries: dict[int, int] = {}
        self._renewed_s = time.monotonic()

    def run(self) -> None:
        """Until nothing is left, a cap is reached, or it is interrupted: then claims are given back."""
        try:
            open_for_more = True
            while True:
                open_for_more = open_for_more and self._hand_out()
                if not self._running and (not open_for_more or not self._watch.missing):
                    return
                self._collect()
                self._renew()
                self._watch.look()
        finally:
            for _, claim in self._running.values():
                self._store.give_back(claim.trial, self._owner)

    def _hand_out(self) -> bool:
        """Give idle actors work; False when nothing more is to be begun."""
        if self._work.late:
            return False
        while self._idle:
            try:
                claim = self._store.claim(self._work.study, self._owner, self._work.caps)
            except CapReached:
                return False
            if claim is None:
                return True
            left = replace(claim.left, seconds=self._work.left_s)
            settings = replace(self._work.settings, caps=tighter(self._work.settings.caps, left))
            actor = self._idle.pop()
            self._running[actor.run.remote(claim.spec, settings)] = (actor, claim)
        return True

    def _collect(self) -> None:
        if not self._running:
            time.sleep(POLL_S)
            return
        ready, _ = self._ray.wait(list(self._running), timeout=POLL_S)
        for future in ready:
            actor, claim = self._running.pop(future)
            try:
                result = self._ray.get(future)
            except Exception as error:  # noqa: BLE001  an actor or its machine died: the trial is tried elsewhere
                self._died(claim, error)
                continue
            settle(self._store, self._owner, claim, self._work.settings.caps, result)
            self._idle.append(actor)

    def _died(self, claim: Claim, error: Exception) -> None:
        self._tries[claim.trial] = self._tries.get(claim.trial, 0) + 1
        why = f"{type(error).__name__}: {str(error).splitlines()[0] if str(error) else ''}"
        self._watch.report(f"warning: a Ray worker died at {claim.spec.scene}: {why}", None)
        if self._tries[claim.trial] >= MAX_TRIES:
            self._store.finish(claim.trial, self._owner, TrialRow("error", "crash", why, usd=None))
        else:
            self._store.give_back(claim.trial, self._owner)
        with contextlib.suppress(Exception):
            self._idle.append(self._make.remote(self._work.runner))

    def _renew(self) -> None:
        if time.monotonic() - self._renewed_s >= RENEW_EVERY_S:
            self._renewed_s = time.monotonic()
            for _, claim in self._running.values():
                self._store.renew(claim.trial, self._owner)
