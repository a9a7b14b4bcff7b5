"""Run a study: workers over a store, with progress, caps, and a clean end however it ends."""

from __future__ import annotations

import contextlib
import multiprocessing
import multiprocessing.connection
import os
import socket
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wonderful_team.core import deadline
from wonderful_team.core.caps import Caps
from wonderful_team.core.renamed import renamed_attribute
from wonderful_team.core.text import counted
from wonderful_team.errors import ConfigError
from wonderful_team.evals.monitor import Report, StudyMonitor, StudyStatus
from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.processes import interrupts_held, one_thread_each, without_main
from wonderful_team.evals.rate_limit import ProcessLimiter
from wonderful_team.evals.shipment import Shipment
from wonderful_team.evals.store import Store
from wonderful_team.evals.trials import RunSettings, TrialRunner
from wonderful_team.evals.workers import LATE, POLL_S, Work, work_until_done, worker_main

STARTS_THAT_FAIL = 3


@dataclass(frozen=True)
class StudyResult:
    """How a run of a study ended: `why` is "" when all trials ended, else what stopped it."""

    status: StudyStatus
    why: str = ""

    standing = renamed_attribute("standing", "status")


def run_study(
    plan: StudyPlan,
    store: str | Path,
    runner: TrialRunner,
    *,
    settings: RunSettings | None = None,
    caps: Caps | None = None,
    jobs: int | None = None,
    at_once: int = 1,
    calls_at_once: int | None = None,
    retry_errors: bool = False,
    ray: str | None = None,
    shipment: Shipment | None = None,
    needs_main: bool = True,
    report: Report = lambda text, status: None,
) -> StudyResult:
    """Run what is missing of a study.

    Args:
        plan: What is asked for.
        store: The file; the same plan on the same file resumes, also while another process works on it.
        runner: Turns a spec into a result; a module-level function, because worker processes import it.
        settings: How trials are run.
        caps: Of the whole study, earlier runs of it in this store included; `seconds` counts from now, and trials in flight are then cut.
        jobs: Worker processes, default one per core; 1 works in this process.
        at_once: Trials in flight per process.
        calls_at_once: Most model calls in flight over all workers; None for each trial's own limit.
        retry_errors: Run trials again that ended as errors.
        ray: Address of a Ray cluster ("local" starts one here): its workers run the trials instead, one per core of the cluster
            unless `jobs` says how many.
        shipment: What these workers need beside the package.
        needs_main: Worker processes run the calling script again, because something that they need stands in it. Without
            it they start also from a script that guards nothing with `if __name__ == "__main__":`.
        report: Told how it goes.

    Raises:
        ConfigError: Wrong use, or workers that cannot start.
        KeyboardInterrupt: Passed on after the trials in flight ended, or were given back.
    """
    workers, jobs = jobs, jobs or os.cpu_count() or 1
    if jobs < 1 or at_once < 1:
        raise ConfigError(f"jobs and trials at once must be at least 1, got {jobs} and {at_once}")
    settings, caps = settings or RunSettings(), caps or Caps()
    left_s = deadline.left_s(caps.seconds)
    ends_s = None if left_s is None else time.monotonic() + left_s
    with Store(store) as opened:
        for warning in opened.warnings:
            report(f"warning: {warning}", None)
        opened.want(plan.name, plan.trials(), plan.request())
        if retry_errors and (again := opened.retry_errors(plan.name)):
            report(f"{counted(again, 'trial')} that ended in an error: tried again", None)
        monitor = StudyMonitor(opened, plan.name, report)
        work = Work(opened.path, plan.name, runner, settings, caps, ends_s, at_once)
        report("", monitor.status())
        if not monitor.missing:
            pass
        elif ray is not None:
            from wonderful_team.evals.on_ray import run_on_ray

            run_on_ray(work, opened, monitor, ray, workers, calls_at_once, shipment)
        elif jobs == 1 and calls_at_once is None:
            work_until_done(work, lambda: monitor.look() and False)
        else:
            _run_processes(work, monitor, min(jobs, monitor.missing), calls_at_once, needs_main)
        report("", monitor.status())
        if caps.usd is not None and (unpriced := monitor.status().spent.unpriced):
            report(
                f"warning: {counted(unpriced, 'trial')} without a known price: the cap of {caps.usd:g} USD does not see them",
                None,
            )
        return StudyResult(monitor.status(), monitor.why(caps, work.late))


def _run_processes(work: Work, monitor: StudyMonitor, jobs: int, calls_at_once: int | None, needs_main: bool) -> None:
    """Spawn workers, replace those that die, and end them when told to."""
    context = multiprocessing.get_context("spawn")
    stopping = context.Event()
    if calls_at_once is not None:
        limiter = ProcessLimiter(context.BoundedSemaphore(calls_at_once))
        work = replace(work, settings=replace(work.settings, limiter=limiter))
    work = replace(work, parent=os.getpid())
    failing = 0

    def start() -> Any:
        process = context.Process(target=worker_main, args=(work, stopping), daemon=False)
        with interrupts_held(), contextlib.nullcontext() if needs_main else without_main():
            process.start()
        return process

    with one_thread_each():
        processes = [start() for _ in range(jobs)]
        try:
            while any(process.exitcode != 0 for process in processes):
                for place, process in enumerate(processes):
                    if process.exitcode in (None, 0):
                        continue
                    lost = monitor.store.crashed(process.pid or 0, socket.gethostname())
                    failing = 0 if lost else failing + 1
                    monitor.report(
                        f"warning: a worker died (exit code {process.exitcode}) at {', '.join(lost) or 'its start'}",
                        None,
                    )
                    if failing >= STARTS_THAT_FAIL and not monitor.status().here:
                        raise ConfigError(
                            f"workers die before they take a trial (exit code {process.exitcode}); see above"
                        )
                    processes[place] = start()
                monitor.look()
                if work.overdue:
                    stopping.set()
                    _end(processes, monitor, patient=False, why=LATE)
                    return
                multiprocessing.connection.wait([one.sentinel for one in processes if one.is_alive()], POLL_S)
        except BaseException as error:
            stopping.set()
            _end(processes, monitor, patient=isinstance(error, KeyboardInterrupt))
            raise


def _end(processes: list[Any], monitor: StudyMonitor, *, patient: bool, why: str = "") -> None:
    """Let trials in flight end; a second interrupt ends them at once, and their claims are given back."""
    try:
        if patient:
            monitor.report("interrupted: waiting for the trials in flight; press again to drop them", None)
            for process in processes:
                process.join()
    finally:
        for process in processes:
            if process.is_alive():
                process.kill()
                process.join()
                monitor.store.crashed(process.pid or 0, socket.gethostname(), why)
