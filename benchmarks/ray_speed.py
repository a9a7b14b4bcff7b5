"""Two Ray workers against `--jobs 2`, and that against `--jobs 1`, on the same trials of this machine, in turn; no start is counted.

    python -m benchmarks.ray_speed                 # 4 alternations of 40 trials
    python -m benchmarks.ray_speed --rounds 8 --trials 80

What is measured lies between the end of the second trial and that of the last but one: both workers are then at work. CPU seconds are
those of all processes that the study started, Ray's own included; the ratio of rates says what is left of the speed.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import math
import multiprocessing
import os
import statistics
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from wonderful_team.api.study import Study
from wonderful_team.evals.store import Store

TASKS = ("rotate", "visual_manipulation", "rearrange", "novel_noun")
WARM = 2
LOOK_S = 0.05
NEAR_THE_END = 6
"""Of the last so many trials each end is looked at closely."""


@dataclass(frozen=True)
class Course:
    """One study: trials a minute and CPU seconds a trial, once both workers were at work; seconds until then."""

    per_minute: float
    cpu_s: float
    start_s: float


def descendants_cpu_s() -> float:
    """CPU time so far of all living processes that this one started, and of those that they have waited for [s]."""
    stats = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            stats[int(path.parent.name)] = [int(word) for word in path.read_text().rpartition(")")[2].split()[1:16]]
    ours = [os.getpid()]
    for pid in ours:
        ours += [child for child, fields in stats.items() if fields[0] == pid]
    return sum(sum(stats[pid][10:14]) for pid in ours if pid in stats) / os.sysconf("SC_CLK_TCK")


def course(ray: str | None, trials: int, folder: Path, jobs: int = 2) -> Course:
    """Run a study and look at its store from beside."""
    store, marks = folder / f"{ray}-{time.monotonic_ns()}.db", [(time.monotonic(), 0.0, 0)]
    first = 300000
    study = Study(
        TASKS, models="simulated:perfect", seeds=range(first, first + trials // len(TASKS)), store=store, controls=(),
        record="none", jobs=jobs, ray=ray,
    )  # fmt: skip
    over, total = threading.Event(), trials // len(TASKS) * len(TASKS)

    def look() -> None:
        while not store.is_file() and not over.wait(LOOK_S):
            pass
        with Store(store) as opened:
            while not over.wait(LOOK_S):
                done = opened.count(study.plan.name, "done")
                if done > marks[-1][2]:
                    # To look through all processes takes a few milliseconds of the cores that are measured: only where it is needed.
                    wanted = marks[-1][2] < WARM or done >= total - NEAR_THE_END
                    marks.append((time.monotonic(), descendants_cpu_s() if wanted else math.nan, done))

    looking = threading.Thread(target=look)
    looking.start()
    try:
        ended = study.run()
    finally:
        time.sleep(2 * LOOK_S)
        over.set()
        looking.join()
    assert ended.status.outcomes == {"success": ended.status.total}, ended
    began, warm = marks[0], next(mark for mark in marks if mark[2] >= WARM)
    # While the last trial runs, another worker has nothing to do.
    last = next(mark for mark in reversed(marks) if mark[2] < total)
    count = last[2] - warm[2]
    return Course(60 * count / (last[0] - warm[0]), (last[1] - warm[1]) / count, warm[0] - began[0])


def compare(rounds: int, trials: int) -> str:
    """Both in turn, and the ratio of each pair; why not where ray is missing."""
    if importlib.util.find_spec("ray") is None:
        return "skipped: ray is not installed (pip install '.[ray]')"
    pairs = []
    with tempfile.TemporaryDirectory() as name:
        for turn in range(rounds):
            order = (None, "local") if turn % 2 == 0 else ("local", None)
            found = {ray: course(ray, trials, Path(name)) for ray in order}
            pairs.append((found["local"], found[None]))
            print(f"  {turn + 1}/{rounds}: ray {found['local']}, jobs {found[None]}", flush=True)
    rates = sorted(ray.per_minute / jobs.per_minute for ray, jobs in pairs)
    cpu = [statistics.median(pair[k].cpu_s for pair in pairs) for k in (0, 1)]
    return (
        f"{statistics.median(rates):.2f} ({rates[0]:.2f}-{rates[-1]:.2f}, n = {rounds}); CPU a trial {cpu[0]:.2f} and {cpu[1]:.2f} s, "
        f"ratio {cpu[1] / cpu[0]:.2f}"
    )


def compare_cores(rounds: int, trials: int) -> str:
    """Two workers against one, in turn; beside it what two processes get of this machine's cores and of its memory."""
    rates, machine = [], []
    with tempfile.TemporaryDirectory() as name:
        for turn in range(rounds):
            order = (1, 2) if turn % 2 == 0 else (2, 1)
            found = {jobs: course(None, trials, Path(name), jobs).per_minute for jobs in order}
            rates.append(found[2] / found[1])
            machine.append(tuple(_two_to_one(work) for work in (_counting, _copying)))
    rates.sort()
    counting, copying = (statistics.median(column) for column in zip(*machine, strict=True))
    return (
        f"{statistics.median(rates):.2f} ({rates[0]:.2f}-{rates[-1]:.2f}, n = {rounds}); of this machine, two processes that count "
        f"{counting:.2f}, that copy memory {copying:.2f}"
    )


def _two_to_one(work: Callable[[], None]) -> float:
    """How much more two processes get done than one in the same time."""
    seconds = []
    for count in (1, 2):
        processes = [multiprocessing.get_context("fork").Process(target=work) for _ in range(count)]
        started = time.perf_counter()
        for process in processes:
            process.start()
        for process in processes:
            process.join()
        seconds.append(time.perf_counter() - started)
    return 2 * seconds[0] / seconds[1]


def _counting() -> None:
    total = 0
    for number in range(20_000_000):
        total = (total * 31 + number) & 0xFFFFFFFF


def _copying() -> None:
    values = np.ones(4_000_000, np.float32)
    for _ in range(400):
        values = values * np.float32(1.0001)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--trials", type=int, default=40)
    options = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    print(f"Ray / --jobs 2, trials a minute: {compare(options.rounds, options.trials)}")
    print(f"--jobs 2 / --jobs 1, trials a minute: {compare_cores(options.rounds, options.trials)}")


if __name__ == "__main__":
    main()
