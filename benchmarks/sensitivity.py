"""What each assumed error rate of a simulated model does to success: one rate at a time, the others as they are.

    python -m benchmarks.sensitivity                                    # simulated:paper-gpt-4o, 9 tasks x 3 seeds a value: an hour
    python -m benchmarks.sensitivity --rates overlooks --seeds 2        # minutes
    python -m benchmarks.sensitivity --profile paper-claude-3-opus --method team --out sensitivity.png

Every value is tried on the same scenes of the nine tasks of the paper's ablations. Printed: successes of n with a 95 % Wilson interval; the
picture (needs the extra `report`) shows a panel a rate, with the value that the profile assumes marked. SIMULATED: nothing here says
anything about a vision-language model.
"""

from __future__ import annotations

import argparse
import multiprocessing
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.core.intervals import wilson_interval
from wonderful_team.evals.suites import ABLATED
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.simulated import PROFILES, SimulatedModel

RATES: dict[str, tuple[float, ...]] = {
    "wrong_plan": (0.0, 0.2, 0.4, 0.8),
    "overlooks": (0.0, 0.3, 0.6, 1.0),
    "missed": (0.0, 0.05, 0.1, 0.2),
    "imagined": (0.0, 0.05, 0.1, 0.2),
    "wrong_thing": (0.0, 0.05, 0.1, 0.2),
    "wrong_choice": (0.0, 0.05, 0.1, 0.2),
    "edge": (0.0, 0.1, 0.2, 0.3),
    "correction": (0.0, 0.25, 0.5, 0.75),
}
"""Rates that the paper does not measure, and the values that are tried."""


@dataclass(frozen=True)
class Job:
    """One scene with one rate changed."""

    profile: str
    mode: str
    rate: str
    value: float
    task: str
    seed: int


def solved(job: Job) -> bool:
    """Whether the team solves the scene at first try."""
    world: Any = registry.make_world(f"tabletop/{job.task}", job.seed)
    try:
        profile = replace(PROFILES[job.profile], **{job.rate: job.value})
        model = SimulatedModel(world.privileged, world.instruction, profile)
        team = TeamPolicy(model, TeamConfig(mode=job.mode))  # type: ignore[arg-type]
        reobserve = world.horizon if "push" in world.vocabulary.kinds else 0
        trial = rollout(
            team, world, replans=0, reobserve=reobserve, scorer=world.privileged, seed=job.seed, max_age_s=None
        )
        return trial.outcome == "success"
    finally:
        world.close()


def draw(counts: dict[tuple[str, float], tuple[int, int]], rates: Sequence[str], args: argparse.Namespace) -> None:
    """A panel a rate."""
    from matplotlib.figure import Figure

    columns = min(4, len(rates))
    rows = -(-len(rates) // columns)
    figure = Figure(figsize=(3.2 * columns, 2.9 * rows), layout="constrained")
    for number, rate in enumerate(rates):
        axes = figure.add_subplot(rows, columns, number + 1)
        values = RATES[rate]
        shares = [counts[rate, value][0] / counts[rate, value][1] for value in values]
        spans = [wilson_interval(*counts[rate, value]) for value in values]
        low = [max(0.0, share - span[0]) for share, span in zip(shares, spans, strict=True)]
        high = [max(0.0, span[1] - share) for share, span in zip(shares, spans, strict=True)]
        axes.errorbar(values, shares, yerr=(low, high), marker="o", capsize=3)
        axes.axvline(getattr(PROFILES[args.profile], rate), color="0.6", linestyle="--")
        axes.set(xlabel=rate.replace("_", " "), ylim=(0, 1))
        if number % columns == 0:
            axes.set_ylabel("success")
    n = counts[rates[0], RATES[rates[0]][0]][1]
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
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=multiprocessing.cpu_count())
    parser.add_argument("--out", type=Path, default=Path("sensitivity.png"))
    args = parser.parse_args()
    rates = [rate for rate in args.rates.split(",") if rate]
    if unknown := [rate for rate in rates if rate not in RATES]:
        parser.error(f"--rates {', '.join(unknown)}: valid are {', '.join(RATES)}")
    mode = "paper" if args.method == "team:paper" else "lean"
    counts: dict[tuple[str, float], tuple[int, int]] = {}
    seeds = range(args.first, args.first + args.seeds)
    with multiprocessing.get_context("spawn").Pool(args.jobs) as pool:
        for rate in rates:
            for value in RATES[rate]:
                jobs = [
                    Job(args.profile, mode, rate, value, task, seed) for task in args.tasks.split(",") for seed in seeds
                ]
                won = sum(pool.imap_unordered(solved, jobs))
                counts[rate, value] = won, len(jobs)
                low, high = wilson_interval(won, len(jobs))
                print(
                    f"SIMULATED  {rate:12s} {value:4.2f}  {won}/{len(jobs)}  {100 * low:.0f} to {100 * high:.0f} %",
                    flush=True,
                )
    draw(counts, rates, args)


if __name__ == "__main__":
    main()
