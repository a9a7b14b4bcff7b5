"""Trials on a Ray cluster: its workers run them, and this process alone keeps the store.

Another process talks to Ray (`ray_side`), workers run trials (`ray_actors`), and what they need travels (`shipment`).
"""

from __future__ import annotations

import contextlib
import importlib.util
import multiprocessing
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from wonderful_team.core.caps import Caps
from wonderful_team.core.text import counted
from wonderful_team.errors import ClusterLostError, ConfigError, MissingExtraError
from wonderful_team.evals.leases import RENEW_EVERY_S, Owner
from wonderful_team.evals.monitor import StudyMonitor
from wonderful_team.evals.processes import interrupts_held, without_main
from wonderful_team.evals.ray_actors import Hello, versions_here
from wonderful_team.evals.ray_messages import (
    Cause,
    Connected,
    Ended,
    Failed,
    Lost,
    Order,
    Ready,
    Result,
    Run,
    Stop,
    Unfit,
)
from wonderful_team.evals.ray_side import LOCAL, answers, talk_to_ray
from wonderful_team.evals.shipment import Shipment, unzip
from wonderful_team.evals.spending import CapReached
from wonderful_team.evals.store import Store
from wonderful_team.evals.stored_rows import Claim
from wonderful_team.evals.trials import TrialRow
from wonderful_team.evals.workers import KEPT, LATE, POLL_S, Work, book, tighter
from wonderful_team.redaction import redact

AUTO = "auto"
MAX_TRIES = 3
"""A trial over which so many workers died, and not their nodes, is an error, ours."""
ANSWER_S = 5.0
"""How long a cluster's head has to take a connection [s]."""
CONNECT_S = 90.0
"""How long Ray has to connect, or to start a cluster here [s]."""
READY_S = 180.0
"""How long a study waits for a worker when it has none [s]."""
END_S = 15.0
"""How long the process that talks to Ray has to end [s]."""


def run_on_ray(
    work: Work,
    store: Store,
    monitor: StudyMonitor,
    address: str,
    jobs: int | None,
    calls_at_once: int | None,
    shipment: Shipment | None = None,
) -> int:
    """Run what is missing of a study on a cluster.

    Args:
        work: What is to be done.
        store: Kept by this process alone; workers never open it, so it needs no shared disk.
        monitor: Told how it goes.
        address: Of the cluster's head, HOST:PORT; "auto" is the cluster that this machine is part of, "local" starts one here.
        jobs: Workers; None for one per core of the cluster.
        calls_at_once: Most model calls in flight over all workers; None for each trial's own limit.
        shipment: What workers need.

    Returns:
        Most model calls that were ever in flight at once; 0 without a limit.

    Raises:
        MissingExtraError: ray is not installed.
        ConfigError: No cluster answers at the address, or none of its workers can run the study.
        ClusterLostError: The cluster is gone; what ended stands in the store.
        KeyboardInterrupt: Passed on after the trials in flight ended, or were given back.
    """
    if importlib.util.find_spec("ray") is None:
        raise MissingExtraError("--ray", "ray")
    check_address(address)
    shipment = shipment or Shipment()
    with tempfile.TemporaryDirectory(prefix="wt-ray-") as scratch:
        folder = Path(scratch) / "shipment"
        parcel = shipment.pack(folder)
        said, most = Path(scratch) / "ray.txt", -(-monitor.missing // work.at_once)
        order = Order(address, jobs, most, work.at_once, calls_at_once, work.runner, parcel, folder, said)
        with _talking(order) as link:
            cluster = _Cluster(work, store, monitor, link, order, dict(shipment.versions))
            cluster.run()
            return cluster.end()


def check_address(address: str) -> None:
    """Whether an address has a form that we can use, and somebody takes connections there.

    Raises:
        ConfigError: It does not; says what would be valid.
    """
    if address in (LOCAL, AUTO):
        return
    host, colon, port = address.rpartition(":")
    if "://" in address or not (colon and host and port.isdecimal() and 0 < int(port) < 65536):
        raise ConfigError(
            f"--ray {address}: valid are HOST:PORT of the cluster's head as `ray start --head` printed it, auto (the cluster that "
            "this machine is part of) and local (start one here); the command runs on a machine of the cluster"
        )
    if not answers(host, int(port), ANSWER_S):
        raise ConfigError(
            f"--ray {address}: nothing answers there within {ANSWER_S:g} s. Start a cluster with "
            f"`ray start --head --port {port}`, or take --ray local"
        )


@contextmanager
def _talking(order: Order) -> Iterator[Any]:
    """The link to a process that talks to Ray; it is ended in any case."""
    context = multiprocessing.get_context("spawn")
    link, far = context.Pipe()
    process = context.Process(target=talk_to_ray, args=(order, far), name="ray", daemon=False)
    with interrupts_held(), without_main():
        process.start()
    far.close()
    try:
        yield link
    finally:
        with contextlib.suppress(OSError):
            link.send(Stop())
        process.join(END_S)
        if process.is_alive():
            process.kill()
            process.join()
        link.close()


class _Cluster:
    """Claims trials for the workers that are ready, and books what they hand back."""

    def __init__(
        self,
        work: Work,
        store: Store,
        monitor: StudyMonitor,
        link: Any,
        order: Order,
        versions: dict[str, str],
    ) -> None:
        self._work, self._store, self._watch = work, store, monitor
        self._link, self._order, self._versions = link, order, versions
        self._owner = Owner.this_process()
        self._running: dict[int, Claim] = {}
        self._ended: list[tuple[Claim, TrialRow, bytes]] = []
        self._lost: dict[str, list[Claim]] = {}
        self._tries: dict[int, int] = {}
        self._slots = self._number = 0
        self._most_calls: int | None = None
        self._open, self._connected = True, False
        self._told: set[str] = set()
        self._renewed_s = self._ready_s = time.monotonic()

    # -- its course ----------------------------------------------------------------------------------------------------

    def run(self) -> None:
        """Until nothing is left, a cap is reached, or it is interrupted: trials in flight then end, unless one is impatient."""
        try:
            try:
                self._work_off()
            except KeyboardInterrupt:
                self._open = False
                self._say("interrupted: waiting for the trials in flight; press again to drop them")
                self._work_off()
                raise
        finally:
            lost = (claim for claims in self._lost.values() for claim in claims)
            for claim in (*self._running.values(), *lost):
                self._store.give_back(claim.trial, self._owner, LATE if self._work.overdue else "interrupted")
            self._book()

    def _work_off(self) -> None:
        # A worker waits until it is given its next trial: that comes before its last one is written, but where what is left of a
        # cap hangs on what that one has cost.
        book_first = self._work.caps != Caps()
        while True:
            if book_first:
                self._book()
            if self._open:
                self._open = self._hand_out()
            self._book()
            if not (self._running or self._lost) and (not self._open or not self._watch.missing):
                return
            if self._work.overdue:
                return
            self._hear(POLL_S)
            self._check_bounds()
            self._renew()
            self._watch.look()

    def _hand_out(self) -> bool:
        """Give workers that wait something to do; False when nothing more is to be begun."""
        if self._work.late:
            return False
        while len(self._running) < self._slots:
            try:
                claim = self._store.claim(self._work.study, self._owner, self._work.caps)
            except CapReached:
                return False
            if claim is None:
                return True
            left = replace(claim.left, seconds=self._work.left_s)
            settings = replace(self._work.settings, caps=tighter(self._work.settings.caps, left))
            self._number += 1
            self._running[self._number] = claim
            with contextlib.suppress(OSError):  # that the process is gone is noticed where it is listened to
                self._link.send(Run(self._number, claim.spec, settings))
        return True

    def _hear(self, within_s: float) -> None:
        """What the cluster says, if it says anything within so many seconds."""
        if not self._link.poll(within_s):
            return
        try:
            while self._link.poll():
                self._answer(self._link.recv())
        except (EOFError, OSError):
            # What it said before is read to the end: nothing of it is lost.
            raise ClusterLostError(
                f"{self._where}: the connection to Ray ended: {self._last_words() or 'it said nothing'}; {KEPT}"
            ) from None

    def _answer(self, message: object) -> None:
        match message:
            case Connected(nodes, cpus, workers):
                self._connected, self._ready_s = True, time.monotonic()
                room = f" (room for {cpus} of {workers})" if cpus < workers else ""
                self._say(f"{self._where}: {counted(nodes, 'node')}, starting {counted(workers, 'worker')}{room}")
            case Ready(hello, slots):
                if not self._slots and not self._number:
                    self._watch.restart_clock()
                self._slots = slots
                self._compare(hello)
            case Result(number, row, folder):
                self._ended.append((self._running.pop(number), row, folder))
            case Lost(numbers, node, slots):
                self._slots, self._ready_s = slots, time.monotonic()
                self._lost.setdefault(node, []).extend(self._running.pop(number) for number in numbers)
            case Cause(node, node_died, why):
                self._give_back_lost(node, node_died, why)
            case Unfit(why):
                self._say(f"warning: a Ray worker cannot run this study: {why}")
            case Ended(most_calls):
                self._most_calls = most_calls
            case Failed(text, wrong_use):
                said = self._last_words() if not self._connected else ""
                if wrong_use and not self._number:
                    raise ConfigError(f"{text} ({said})" if said else text)
                raise ClusterLostError(f"{text}; {KEPT}, also without --ray")

    def _check_bounds(self) -> None:
        if not self._connected and time.monotonic() - self._ready_s > CONNECT_S:
            raise ConfigError(
                f"{self._where}: Ray did not connect within {CONNECT_S:g} s: {self._last_words() or 'it said nothing'}"
            )
        if self._slots or not self._connected:
            return
        if time.monotonic() - self._ready_s > READY_S:
            raise ClusterLostError(
                f"{self._where}: no worker is ready after {READY_S:g} s; each needs a free core (`ray status` shows them); {KEPT}"
            )

    # -- results and losses --------------------------------------------------------------------------------------------

    def _book(self) -> None:
        """Write what came of the trials that ended."""
        while self._ended:
            self._finish(*self._ended.pop(0))

    def _finish(self, claim: Claim, row: TrialRow, folder: bytes) -> None:
        page = ""
        if folder and self._work.settings.out is not None:
            try:
                unzip(folder, self._work.settings.out)
                page = str(self._work.settings.out / row.page) if row.page else ""
            except OSError as error:
                self._say(f"warning: the run folder of {claim.spec.scene} could not be written: {error}")
        row = replace(row, page=page, versions={**row.versions, **self._versions} if row.versions else row.versions)
        book(self._work, self._store, self._owner, claim, row)

    def _give_back_lost(self, node: str, node_died: bool, why: str) -> None:
        """Let the trials of lost workers run elsewhere, and say so; one that keeps killing its worker is an error."""
        claims, given_up = self._lost.pop(node, []), []
        for claim in claims:
            tries = self._tries[claim.trial] = self._tries.get(claim.trial, 0) + (not node_died)
            if tries >= MAX_TRIES:
                reason = f"the worker process died {tries} times while it ran this trial: {why}"
                self._store.finish(claim.trial, self._owner, TrialRow("error", "crash", reason, usd=None))
                given_up.append(claim.spec.scene)
            else:
                self._store.give_back(claim.trial, self._owner, "its node died" if node_died else "its process died")
        again = [claim.spec.scene for claim in claims if claim.spec.scene not in given_up]
        said = [f"node {node} died" if node_died else f"a worker on {node} died ({why})"]
        said += [f"run again elsewhere: {', '.join(again)}"] if again else []
        said += [f"given up after {MAX_TRIES} tries: {', '.join(given_up)}"] if given_up else []
        self._say("; ".join(["warning: " + said[0], *said[1:]]))

    def _renew(self) -> None:
        if time.monotonic() - self._renewed_s >= RENEW_EVERY_S:
            self._renewed_s = time.monotonic()
            for claim in self._running.values():
                self._store.renew(claim.trial, self._owner)

    def end(self) -> int:
        """Take leave of the cluster; most model calls that were ever in flight at once."""
        self._link.send(Stop())
        until = time.monotonic() + END_S
        with contextlib.suppress(ClusterLostError):  # all that was asked for is done
            while self._most_calls is None and time.monotonic() < until:
                self._hear(POLL_S)
        return self._most_calls or 0

    # -- what is said --------------------------------------------------------------------------------------------------

    @property
    def _where(self) -> str:
        return f"Ray at {self._order.address}"

    def _say(self, text: str) -> None:
        self._watch.report(redact(text), None)

    def _last_words(self) -> str:
        """The last line that Ray printed of what went wrong; "" where there is none."""
        try:
            lines = self._order.said.read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:
            lines = []
        wrong = [line.strip() for line in lines if any(word in line for word in ("rror", "ailed", "nvalid"))]
        return redact(wrong[-1][:500]) if wrong else ""

    def _compare(self, hello: Hello) -> None:
        """Tell what of a worker's machine is not as here; each once."""
        here = versions_here()
        other = [
            f"{name} {hello.versions.get(name)} (here {here[name]})"
            for name in here
            if hello.versions.get(name) != here[name]
        ]
        if other:
            self._tell_once(f"warning: on {hello.host}: {', '.join(other)}; results may differ in the last bit")
        behind = hello.niceness - (os.getpriority(os.PRIO_PROCESS, 0) if hasattr(os, "getpriority") else 0)
        if behind > 0:
            self._tell_once(
                f"note: workers on {hello.host} step back behind other processes (niceness {hello.niceness}); start its node with "
                "RAY_worker_niceness=0 where they should not"
            )

    def _tell_once(self, text: str) -> None:
        if text not in self._told:
            self._told.add(text)
            self._say(text)
