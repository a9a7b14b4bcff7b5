"""How fast a study is: what the store costs per trial, and how many trials a minute the tabletop and the planner allow.

    python -m benchmarks.study_speed                       # simulated:perfect over vima17 x 100 seeds on 2 processes
    python -m benchmarks.study_speed --seeds 2
    python -m benchmarks.study_speed --tasks vima17 --seeds 20 --method oracle

Controls draw nothing: what is measured for `oracle` is physics, scoring and bookkeeping. With `simulated:perfect` the team
plans on truth seen through pictures, so pictures are drawn whenever something moved and somebody looks. CPU seconds say what a
trial takes whatever else the machine does; the rate is what it came to here.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from pathlib import Path

from wonderful_team.api.study import Study
from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.study import run_study
from wonderful_team.evals.suites import Protocol, Suite
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec


def nothing(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """A trial that takes no time."""
    return TrialRow("success")


def store_cost_s(folder: Path, trials: int = 400) -> float:
    """Seconds that handing out, writing and counting one trial take, in one process."""
    suite = Suite("empty", ("empty",), Protocol("empty", 1, 0))
    plan = StudyPlan((suite,), ("nothing",), ("-",), tuple(range(trials)), controls=())
    started = time.perf_counter()
    run_study(plan, folder / "empty.db", nothing, jobs=1)
    return (time.perf_counter() - started) / trials


def cpu_s() -> float:
    """CPU time of this process and of the workers that have ended [s]."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", nargs="*", default=["vima17"])
    parser.add_argument("--seeds", type=int, default=100, help="seeds per task")
    parser.add_argument("--first", type=int, default=1000, help="the first of them")
    parser.add_argument("--method", default="team")
    parser.add_argument("--model", default="simulated:perfect")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        print(f"store: {1000 * store_cost_s(Path(name)):.1f} ms a trial")
        study = Study(
            options.tasks,
            methods=[options.method],
            models=[options.model],
            seeds=range(options.first, options.first + options.seeds),
            store=Path(name) / "study.db",
            controls=(),
            record="none",
            jobs=options.jobs,
        )
        started, before_s = time.perf_counter(), cpu_s()
        ended = study.run()
        seconds, used_s = time.perf_counter() - started, cpu_s() - before_s
        done = ended.status.done
        print(f"{options.method} {options.model}: {done} trials in {seconds:.1f} s on {options.jobs} processes")
        print(f"{60 * done / seconds:.1f} trials/min here, start of the processes included; {ended.status.outcomes}")
        alone = 60 * options.jobs * done / used_s
        print(
            f"{used_s / done:.2f} CPU seconds a trial: {alone:.0f} trials/min if {options.jobs} cores did nothing else"
        )


if __name__ == "__main__":
    main()
