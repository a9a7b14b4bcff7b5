"""Workers: processes that take trials from a store, run them and write what came of them, until nothing is left."""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import os
import sqlite3
import sys
import time
import traceback
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wonderful_team.core.caps import Caps
from wonderful_team.core.deadline import GRACE_S
from wonderful_team.core.heap import Growth
from wonderful_team.core.interrupts import in_thread
from wonderful_team.errors import FileNotWrittenError, WonderfulTeamError
from wonderful_team.evals.leases import RENEW_EVERY_S, Owner
from wonderful_team.evals.processes import leave_to_parent
from wonderful_team.evals.spending import CapReached
from wonderful_team.evals.store import CUT, Store
from wonderful_team.evals.stored_rows import Claim
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialRunner, TrialSpec
from wonderful_team.redaction import redacted_streams

KEPT = "what ended before is kept; the same command goes on"
LATE = "cut by the limit on time"
"""Why an attempt was discarded that the command had no time left for."""
_GROWTH = Growth(own_process=multiprocessing.parent_process() is not None)
"""Of this worker, over its trials."""
POLL_S = 0.2
"""How long a worker waits before it looks again for a trial that another process holds [s]."""


@dataclass(frozen=True)
class Work:
    """What a worker is told.

    Attributes:
        store: Path of the store's file.
        study: Name of the study in the store.
        caps: Of the whole study.
        ends_s: When the time of the command is over, by the clock of this machine that never jumps; trials in flight are then cut. None
            for never.
        at_once: Trials in flight in one process: more than one helps only where models are waited for.
        parent: Process that started the worker; when it is gone the worker ends after its trial.
    """

    store: Path
    study: str
    runner: TrialRunner
    settings: RunSettings
    caps: Caps = Caps()
    ends_s: float | None = None
    at_once: int = 1
    parent: int | None = None

    @property
    def left_s(self) -> float | None:
        """Time that is left, never none at all [s]; None without a limit."""
        return None if self.ends_s is None else max(0.001, self.ends_s - time.monotonic())

    @property
    def late(self) -> bool:
        return self.ends_s is not None and time.monotonic() >= self.ends_s

    @property
    def overdue(self) -> bool:
        """Whether trials in flight had time enough to end by themselves."""
        return self.ends_s is not None and time.monotonic() >= self.ends_s + GRACE_S


def worker_main(work: Work, stopping: Any) -> None:
    """Entry of a worker process; an interrupt from the keyboard is the parent's to answer."""
    leave_to_parent("SIGINT")
    with redacted_streams():
        try:
            work_until_done(work, stopping.is_set)
        except WonderfulTeamError as error:
            sys.stderr.write(f"error: {error}\n")
            sys.exit(error.exit_code)


def work_until_done(work: Work, stopping: Callable[[], bool]) -> None:
    """Take trials and run them until none is left, a cap is reached, or one is told to stop.

    The study has opened the store and checked all of it: looking through a million trials once more in every worker takes minutes.
    """
    with Store(work.store, must_exist=True, checked=True) as store:
        asyncio.run(_work(work, store, stopping))


async def _work(work: Work, store: Store, stopping: Callable[[], bool]) -> None:
    owner = Owner.this_process(work.parent)
    slots = [asyncio.create_task(_slot(work, store, owner, stopping)) for _ in range(work.at_once)]
    try:
        await asyncio.gather(*slots)
    finally:
        for slot in slots:
            slot.cancel()


async def _slot(work: Work, store: Store, owner: Owner, stopping: Callable[[], bool]) -> None:
    while not (stopping() or _orphaned(work) or work.late):
        try:
            claim = store.claim(work.study, owner, work.caps)
        except CapReached:
            return
        if claim is None:
            if store.count(work.study, "done") == store.count_all(work.study):
                return
            await asyncio.sleep(POLL_S)
            continue
        await _run(work, store, owner, claim)


async def _run(work: Work, store: Store, owner: Owner, claim: Claim) -> None:
    left_s = work.left_s
    caps = tighter(work.settings.caps, replace(claim.left, seconds=left_s))
    try:
        async with _kept(store, claim, owner):
            trial = in_thread(run_safely, work.runner, claim.spec, replace(work.settings, caps=caps), name="trial")
            result = await asyncio.wait_for(trial, None if left_s is None else left_s + GRACE_S)
    except TimeoutError:
        # Its thread is left behind: what it still does counts for nothing.
        store.give_back(claim.trial, owner, LATE)
        return
    except BaseException:
        # Interrupted: nothing of it counts, and somebody else may take it at once.
        store.give_back(claim.trial, owner)
        raise
    _GROWTH.give_back()
    book(work, store, owner, claim, result)


def book(work: Work, store: Store, owner: Owner, claim: Claim, result: TrialRow) -> None:
    """Write what came of a trial, unless what was left of the study's time or caps cut it.

    Raises:
        FileNotWrittenError: It cannot be written; says what is lost.
    """
    if work.late and result.stage == "budget" and result.outcome != "success":
        store.give_back(claim.trial, owner, LATE, result)
        return
    try:
        settle(store, owner, claim, work.settings.caps, result)
    except sqlite3.Error as error:
        with contextlib.suppress(sqlite3.Error):  # somebody may run it again at once, if that much can be written
            store.give_back(claim.trial, owner, "its result could not be written", result)
        stage = f" at {result.stage}" if result.stage else ""
        ended = (
            f"{claim.spec.scene} of {claim.spec.condition.label} ended in {result.outcome}{stage}, which is not kept"
        )
        raise FileNotWrittenError(store.path, f"{error}; {ended}", KEPT) from error


def settle(store: Store, owner: Owner, claim: Claim, own: Caps, result: TrialRow) -> bool:
    """Write a result, unless the study's cap, and not one of its own, cut it short: then it did not happen.

    Returns:
        Whether it was written.
    """
    if result.stage == "budget" and result.outcome != "success" and cut_by_study(own, claim.left, result):
        store.give_back(claim.trial, owner, CUT, result)
        return False
    return store.finish(claim.trial, owner, result)


def cut_by_study(own: Caps, left: Caps, result: TrialRow) -> bool:
    """Whether the cap that a trial met was what the study had left, and not its own."""
    for name in ("calls", "tokens", "usd"):
        study, trial = getattr(left, name), getattr(own, name)
        if (
            study is not None
            and (trial is None or study < trial)
            and f" {name.replace('usd', 'USD')} " in result.reason
        ):
            return True
    return False


def tighter(one: Caps, other: Caps) -> Caps:
    """The smaller of each cap."""

    def least(name: str) -> Any:
        given = [value for caps in (one, other) if (value := getattr(caps, name)) is not None]
        return min(given) if given else None

    # What is left may be less than one call or token: the trial then starts with one and is cut at once.
    calls, tokens = least("calls"), least("tokens")
    return Caps(
        None if calls is None else max(1, calls),
        None if tokens is None else max(1, tokens),
        least("seconds"),
        least("usd"),
    )


def run_safely(runner: TrialRunner, spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Run a trial; whatever escapes it is an error of ours, never the method's failure."""
    started = time.monotonic()
    try:
        return runner(spec, settings)
    except Exception as error:  # noqa: BLE001  a sweep goes on; the trial says what happened and where
        where = traceback.extract_tb(error.__traceback__)[-1]
        reason = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
        stage = getattr(error, "stage", None) or "crash"
        return TrialRow("error", stage, reason, usd=None, seconds=time.monotonic() - started)


@contextlib.asynccontextmanager
async def _kept(store: Store, claim: Claim, owner: Owner) -> AsyncIterator[None]:
    """Renew a claim's lease while its trial runs."""

    async def renew() -> None:
        while True:
            await asyncio.sleep(RENEW_EVERY_S)
            store.renew(claim.trial, owner)

    renewing = asyncio.create_task(renew())
    try:
        yield
    finally:
        renewing.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await renewing


def _orphaned(work: Work) -> bool:
    return work.parent is not None and os.getppid() != work.parent
