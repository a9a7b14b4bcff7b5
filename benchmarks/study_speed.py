"""How fast a study is: what the store costs per trial, and how many oracle trials per second the tabletop allows.

    python -m benchmarks.study_speed
    python -m benchmarks.study_speed --tasks vima17 --seeds 20 --method oracle

With `--model simulated:perfect` (where that model exists) it measures the planner on truth. Controls draw nothing: what is
measured for `oracle` is physics, scoring and bookkeeping.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.study import run_study
from wonderful_team.evals.suites import Protocol, Suite
from wonderful_team.evals.trials import RunSettings, TrialResult, TrialSpec
from wonderful_team.studies import Study


def nothing(spec: TrialSpec, settings: RunSettings) -> TrialResult:
    """A trial that takes no time."""
    return TrialResult("success")


def store_cost_s(folder: Path, trials: int = 400) -> float:
    """Seconds that handing out, writing and counting one trial take, in one process."""
    suite = Suite("empty", ("empty",), Protocol("empty", 1, 0))
    plan = StudyPlan((suite,), ("nothing",), ("-",), tuple(range(trials)), controls=())
    started = time.perf_counter()
    run_study(plan, folder / "empty.db", nothing, jobs=1)
    return (time.perf_counter() - started) / trials


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", nargs="*", default=["vima3"])
    parser.add_argument("--seeds", type=int, default=10, help="seeds per task, from 1000 on")
    parser.add_argument("--method", default="oracle")
    parser.add_argument("--model", default="offline")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        print(f"store: {1000 * store_cost_s(Path(name)):.1f} ms a trial")
        study = Study(
            options.tasks,
            methods=[options.method],
            models=[options.model],
            seeds=range(1000, 1000 + options.seeds),
            store=Path(name) / "study.db",
            controls=(),
            pages="none",
            jobs=options.jobs,
        )
        started = time.perf_counter()
        ended = study.run()
        seconds = time.perf_counter() - started
        done = ended.standing.done
        print(f"{options.method} {options.model}: {done} trials in {seconds:.1f} s on {options.jobs} processes")
        print(f"{done / seconds:.2f} trials/s, start of the processes included; outcomes {ended.standing.outcomes}")


if __name__ == "__main__":
    main()
