"""What each assumed error rate of a simulated model does to success: one rate at a time, the others as they are.

    python -m benchmarks.sensitivity                                    # simulated:paper-gpt-4o, at most 15 minutes of processor time: five seeds
    python -m benchmarks.sensitivity --rates overlooks --seeds 2
    python -m benchmarks.sensitivity --profile paper-claude-3-opus --method team:paper --cpu-minutes 60 --out sensitivity.png

Every value is tried on the same scenes of the nine tasks of the paper's ablations, seed by seed over all values, so that a run that is cut by its
limit (--cpu-minutes, --minutes) has the same whole seeds everywhere. A value that is the profile's own is one experiment for all rates and runs once. Errors are drawn by what
they are about, so a changed rate leaves all others as they were. Printed, as a table: successes of n with a 95 % Wilson interval, and the difference from the
profile as it is, paired by scene, with Newcombe's interval and the exact test. The picture (needs the extra `report`) shows a panel a rate, with the value that
the profile assumes marked. SIMULATED: nothing here says anything about a vision-language model.
"""

from __future__ import annotations

import argparse
import multiprocessing
import textwrap
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.core.intervals import wilson_interval
from wonderful_team.evals.pairing import mcnemar_exact, newcombe_paired
from wonderful_team.evals.suites import ABLATED
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.simulated import PROFILES, SimulatedModel

RATES: dict[str, tuple[float, ...]] = {
    "wrong_plan": (0.0, 0.2, 0.6),
    "overlooks": (0.0, 0.3, 0.9),
    "missed": (0.0, 0.05, 0.15),
    "imagined": (0.0, 0.05, 0.15),
    "wrong_thing": (0.0, 0.05, 0.15),
    "wrong_choice": (0.0, 0.05, 0.15),
    "edge": (0.0, 0.1, 0.3),
    "correction": (0.0, 0.25, 0.75),
}
"""Rates that the paper does not measure, and the values that are tried: none, what is assumed, three times as much."""
Cell = tuple[str, float]
"""A rate and its value; ("", 0.0) is the profile as it is."""
AS_IT_IS: Cell = ("", 0.0)


@dataclass(frozen=True)
class Job:
    """One scene with one rate changed."""

    profile: str
    mode: str
    cell: Cell
    task: str
    seed: int


def solved(job: Job) -> tuple[Job, bool, float]:
    """Whether the team solves the scene at first try, and the processor time that it took [s]."""
    started = time.process_time()
    world: Any = registry.make_world(f"tabletop/{job.task}", job.seed)
    try:
        rate, value = job.cell
        profile = replace(PROFILES[job.profile], **{rate: value}) if rate else PROFILES[job.profile]  # type: ignore[arg-type]
        model = SimulatedModel(world.privileged, world.instruction, profile)
        team = TeamPolicy(model, TeamConfig(mode=job.mode))  # type: ignore[arg-type]
        reobserve = world.horizon if "push" in world.vocabulary.kinds else 0
        trial = rollout(
            team, world, replans=0, reobserve=reobserve, scorer=world.privileged, seed=job.seed, max_age_s=None
        )
        return job, trial.outcome == "success", time.process_time() - started
    finally:
        world.close()


@dataclass
class Measured:
    """What came of each cell on whole seeds, in the order of scenes."""

    won: dict[Cell, list[bool]] = field(default_factory=dict)
    seeds: list[int] = field(default_factory=list)
    cpu_s: float = 0.0

    def of(self, profile: str, rate: str, value: float) -> list[bool]:
        """The results of a value; the profile's own value is the profile as it is."""
        return self.won[cell_of(profile, rate, value)]


def cell_of(profile: str, rate: str, value: float) -> Cell:
    return AS_IT_IS if getattr(PROFILES[profile], rate) == value else (rate, value)


def measure(args: argparse.Namespace, rates: Sequence[str], tasks: Sequence[str]) -> Measured:
    """Whole seeds, one after the other, until all are done or a limit would be passed."""
    cells = list(
        dict.fromkeys([AS_IT_IS, *(cell_of(args.profile, rate, one) for rate in rates for one in RATES[rate])])
    )
    mode = "paper" if args.method == "team:paper" else "lean"
    found, started = Measured({cell: [] for cell in cells}), time.monotonic()
    with multiprocessing.get_context("spawn").Pool(args.jobs) as pool:
        for seed in range(args.first, args.first + args.seeds):
            begun_s, begun_cpu_s = time.monotonic(), found.cpu_s
            jobs = [Job(args.profile, mode, cell, task, seed) for task in tasks for cell in cells]
            results: dict[tuple[Cell, str], bool] = {}
            for job, won, cpu_s in pool.imap_unordered(solved, jobs):
                results[job.cell, job.task] = won
                found.cpu_s += cpu_s
                if found.cpu_s > 60 * args.cpu_minutes or time.monotonic() - started > 60 * args.minutes:
                    pool.terminate()
                    print(f"seed {seed} was cut by the limit and does not count", flush=True)
                    return found
            for cell in cells:
                found.won[cell] += [results[cell, task] for task in tasks]
            found.seeds.append(seed)
            print(f"seed {seed}: {len(jobs)} trials, {found.cpu_s:.0f} s of processor time so far", flush=True)
            took_s, took_cpu_s = time.monotonic() - begun_s, found.cpu_s - begun_cpu_s
            if (
                found.cpu_s + took_cpu_s > 60 * args.cpu_minutes
                or time.monotonic() + took_s - started > 60 * args.minutes
            ):
                break
    return found


def table(found: Measured, rates: Sequence[str], profile: str) -> list[str]:
    """A line for each value."""
    lines = ["| rate | value | success | 95 % | against as it is | 95 % | exact p |", "|---|---|---|---|---|---|---|"]
    base = found.won[AS_IT_IS]
    for rate in rates:
        for value in RATES[rate]:
            mine = found.of(profile, rate, value)
            low, high = wilson_interval(sum(mine), len(mine))
            line = f"| `{rate}` | {value:g} | {sum(mine)}/{len(mine)} | {100 * low:.0f} to {100 * high:.0f} % |"
            if mine is base:
                lines.append(f"{line} as it is | | |")
                continue
            pairs = list(zip(mine, base, strict=True))
            more, less = pairs.count((True, False)), pairs.count((False, True))
            below, above = newcombe_paired(pairs.count((True, True)), more, less, pairs.count((False, False)))
            gap = f"{100 * (more - less) / len(pairs):+.0f} points"
            lines.append(f"{line} {gap} | {100 * below:+.0f} to {100 * above:+.0f} | {mcnemar_exact(more, less):.2g} |")
    return lines


def draw(found: Measured, rates: Sequence[str], args: argparse.Namespace) -> None:
    """A panel a rate."""
    from matplotlib.figure import Figure

    columns = min(4, len(rates))
    rows = -(-len(rates) // columns)
    figure = Figure(figsize=(3.2 * columns, 2.9 * rows), layout="constrained")
    for number, rate in enumerate(rates):
        axes = figure.add_subplot(rows, columns, number + 1)
        values = RATES[rate]
        results = [found.of(args.profile, rate, value) for value in values]
        shares = [sum(mine) / len(mine) for mine in results]
        spans = [wilson_interval(sum(mine), len(mine)) for mine in results]
        low = [max(0.0, share - span[0]) for share, span in zip(shares, spans, strict=True)]
        high = [max(0.0, span[1] - share) for share, span in zip(shares, spans, strict=True)]
        axes.errorbar(values, shares, yerr=(low, high), marker="o", capsize=3)
        axes.axvline(getattr(PROFILES[args.profile], rate), color="0.6", linestyle="--")
        axes.set(xlabel=rate.replace("_", " "), ylim=(0, 1))
        if number % columns == 0:
            axes.set_ylabel("success")
    n = len(found.won[AS_IT_IS])
    title = f"SIMULATED: simulated:{args.profile}, {args.method}; n = {n} a point, 95 % Wilson intervals; dashed: as assumed"
    figure.suptitle(textwrap.fill(title, 36 * columns), fontsize=9)
    figure.savefig(args.out, dpi=110)
    print(f"picture: {args.out}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--profile", default="paper-gpt-4o", choices=sorted(PROFILES))
    parser.add_argument("--method", default="team", choices=("team", "team:paper"))
    parser.add_argument("--rates", default=",".join(RATES), help=f"with commas, of {', '.join(RATES)}")
    parser.add_argument("--tasks", default=",".join(ABLATED), help="with commas")
    parser.add_argument("--first", type=int, default=730_000, help="the first seed")
    parser.add_argument("--seeds", type=int, default=100, help="most seeds")
    parser.add_argument("--cpu-minutes", type=float, default=15.0, help="most processor time")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="most time on the clock")
    parser.add_argument("--jobs", type=int, default=multiprocessing.cpu_count())
    parser.add_argument("--out", type=Path, default=Path("sensitivity.png"))
    args = parser.parse_args()
    rates = [rate for rate in args.rates.split(",") if rate]
    if unknown := [rate for rate in rates if rate not in RATES]:
        parser.error(f"--rates {', '.join(unknown)}: valid are {', '.join(RATES)}")
    tasks = [task for task in args.tasks.split(",") if task]
    if unknown := [task for task in tasks if task not in ABLATED]:
        parser.error(f"--tasks {', '.join(unknown)}: valid are {', '.join(ABLATED)}")
    found = measure(args, rates, tasks)
    if not found.seeds:
        parser.exit(
            1, "no whole seed fits the limit: nothing to show; take fewer --rates or --tasks, or a larger limit\n"
        )
    span = f"seeds {found.seeds[0]} to {found.seeds[-1]}"
    print(
        f"SIMULATED  simulated:{args.profile}, {args.method}, {len(tasks)} tasks, {span}, {found.cpu_s:.0f} s of processor time"
    )
    print("\n".join(table(found, rates, args.profile)))
    draw(found, rates, args)


if __name__ == "__main__":
    main()
