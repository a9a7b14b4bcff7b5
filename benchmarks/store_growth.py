"""What a store costs as a study grows: claims, progress, opening and reading it, in processor time and memory.

    python -m benchmarks.store_growth                    # 10,000 and 100,000 trials
    python -m benchmarks.store_growth 1000000 --folder DIR

The trials are made up (nothing is run): all but two hundred are written as ended, with the accounts of six roles, then some are claimed and
ended one by one, under a cap. Each size runs in a process of its own, so the peak of memory is its own.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from wonderful_team.core.caps import Caps
from wonderful_team.evals.leases import Owner
from wonderful_team.evals.monitor import StudyMonitor
from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.report.tables import to_markdown
from wonderful_team.evals.store import Store
from wonderful_team.evals.suites import OPEN_LOOP, Suite
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import TrialRow

TASKS, METHODS = 10, ("team", "direct")
CLAIMS = 50
ROLES = ("supervisor", "verification", "manager", "checker", "mover", "memory")
USAGE = {"calls": 1, "tokens_in": 2000, "tokens_out": 300, "pictures": 3, "seconds": 4.2, "usd": 0.002}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sizes", nargs="*", type=int, default=[10_000, 100_000], metavar="TRIALS")
    parser.add_argument(
        "--folder", type=Path, help="Where the stores lie while they are measured. [default: a temporary one]"
    )
    asked = parser.parse_args()
    head = ("trials", "enter", "claim + end", "progress", "open", "read", "tables", "peak", "file")
    print("  ".join(f"{word:>11}" for word in head))
    with tempfile.TemporaryDirectory(dir=asked.folder) as folder:
        for size in asked.sizes:
            with multiprocessing.get_context("spawn").Pool(1) as pool:
                print("  ".join(f"{word:>11}" for word in pool.apply(measure, (size, Path(folder)))), flush=True)


def measure(size: int, folder: Path) -> tuple[str, ...]:
    """One size: a line of the table."""
    plan = _plan(size)
    (suite,) = plan.suites
    path, name, caps = folder / f"{size}.db", plan.name, Caps(calls=10**12, usd=1e9)
    with Store(path) as store:
        enter = _cpu(lambda: store.want(name, plan.trials(), plan.request()))
        _end_all_but(200, store, size)
        owner = Owner.this_process()

        def claim_and_end() -> None:
            for _ in range(CLAIMS):
                claim = store.claim(name, owner, caps)
                assert claim is not None
                store.finish(claim.trial, owner, TrialRow("success", calls=5, tokens=9000, usd=0.01))

        claimed = _cpu(claim_and_end) / CLAIMS
        progress = _cpu(StudyMonitor(store, name, lambda text, status: None).status)
    opened = _cpu(lambda: Store(path).close())
    with Store(path) as store:
        rows: list[Any] = []
        read = _cpu(lambda: rows.extend(store.rows(name)))
        summary = Summary(tuple(rows), tuple(store.requests()), plan.conditions(suite), ())
        tables = _cpu(lambda: to_markdown(summary))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    times = (_words(seconds) for seconds in (enter, claimed, progress, opened, read, tables))
    return (f"{size:,}", *times, f"{peak:.0f} MB", f"{path.stat().st_size / 1e6:.0f} MB")


def made_up(size: int, folder: Path) -> Path:
    """A store of so many trials, all but two hundred of them ended."""
    plan, path = _plan(size), folder / f"{size}.db"
    with Store(path) as store:
        store.want(plan.name, plan.trials(), plan.request())
        _end_all_but(200, store, size)
    return path


def _plan(size: int) -> StudyPlan:
    seeds = tuple(range(1000, 1000 + size // (TASKS * len(METHODS))))
    suite = Suite("made up", tuple(f"tabletop/made_up_{k}" for k in range(TASKS)), OPEN_LOOP)
    return StudyPlan((suite,), METHODS, ("simulated:perfect",), seeds)


def _end_all_but(left: int, store: Store, size: int) -> None:
    role = json.dumps(dict.fromkeys(ROLES, USAGE))
    with store._writing() as base:
        base.execute(
            "UPDATE trials SET state='done', ended='2026-01-01T00:00:00Z', outcome=CASE WHEN id % 3 THEN 'success' ELSE 'failure' END, "
            "reason='every goal is met', calls=5, tokens=9000, pictures=14, usd=0.01, seconds=20.0, rounds=4, provenance='[\"api\"]', "
            "by_role=?, page='', instruction='put the red block into the blue bowl', versions=?, facts=? WHERE id <= ?",
            (role, '{"wonderful_team": "0.1.0"}', '{"at least one valid subgoal": 1.0}', size - left),
        )


def _cpu(run: Callable[[], object]) -> float:
    started = time.process_time()
    run()
    return time.process_time() - started


def _words(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds >= 0.5 else f"{1000 * seconds:.2f} ms"


if __name__ == "__main__":
    main()
