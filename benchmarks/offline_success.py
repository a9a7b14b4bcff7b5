"""How often `offline` solves VIMA's 17 tasks and the fruit tasks: single attempt, open loop, from pixels and words alone.

    python -m benchmarks.offline_success                          # seeds from 1000: 50 per VIMA task, 20 per fruit variation
    python -m benchmarks.offline_success --first 0 --seeds 10     # development seeds, only for working on it
    python -m benchmarks.offline_success --tasks sweep_without_touching --reobserve 20   # a look after every push
    python -m benchmarks.offline_success --world vimabench --jobs 2                  # the user's own VIMA-Bench

`offline` is classical vision and a grammar, not a vision-language model; the figures say nothing about any VLM.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from wonderful_team.evals import Rate

VIMA = ("visual_manipulation", "scene_understanding", "rotate")
PICTURES = (
    "rearrange", "rearrange_then_restore", "novel_adj", "novel_noun", "novel_adj_and_noun", "twist", "follow_motion",
    "follow_order", "sweep_without_exceeding", "sweep_without_touching", "same_texture", "same_shape",
    "manipulate_old_neighbor", "pick_in_order_then_restore",
)  # fmt: skip
VIMA17 = (*VIMA, *PICTURES)
FRUIT = tuple(f"fruit_placement/{name}" for name in ("all_match", "no_area", "misplaced", "both"))


PROGRESS_EVERY = 10
"""Trials between two lines of progress."""


@dataclass(frozen=True)
class Job:
    """One trial to run."""

    task: str
    seed: int
    mode: str = "lean"
    ablation: str = "full"
    recolour: int | None = None
    instruction: str | None = None
    reobserve: int = 0
    replans: int = 0
    world: str = "tabletop"
    partition: str | None = None


@dataclass(frozen=True)
class Result:
    """What came of it."""

    job: Job
    outcome: str
    stage: str | None
    reason: str
    calls: int
    seconds: float


def run(job: Job) -> Result:
    """Run one trial in this process."""
    # Imported here: a worker of a spawned pool pays for it once, the parent never.
    from wonderful_team.core.values import Instruction
    from wonderful_team.offline import OfflineModel
    from wonderful_team.planning import TeamConfig, TeamPolicy
    from wonderful_team.runtime import rollout

    world = world_of(job)
    if job.instruction is not None:
        slots = {name: slot for name, slot in world.instruction.slots.items() if f"{{{name}}}" in job.instruction}
        world.instruction = Instruction(job.instruction, slots)
    team = TeamPolicy(OfflineModel(), TeamConfig(mode=job.mode, ablation=job.ablation))  # type: ignore[arg-type]
    started = time.perf_counter()
    try:
        trial = rollout(
            team,
            world,
            reobserve=job.reobserve,
            replans=job.replans,
            scorer=world.privileged,
            seed=job.seed,
            scene=job.task,
        )
    finally:
        world.close()
    seconds = time.perf_counter() - started
    return Result(job, trial.outcome, trial.stage, trial.reason, team.usage.calls, seconds)


def world_of(job: Job) -> Any:
    """The world of a job, with its scorer as `privileged`."""
    if job.world == "vimabench":
        from wonderful_team import registry

        name = f"vimabench/{job.task}" + (f"@{job.partition}" if job.partition else "")
        return registry.make_world(name, seed=job.seed)
    from wonderful_team.sims.tabletop import make_world

    options: dict[str, Any] = {} if job.recolour is None else {"recolour": job.recolour}
    if job.partition is not None:
        options["partition"] = job.partition
    return make_world(job.task, seed=job.seed, **options)


def run_all(jobs: list[Job], workers: int) -> list[Result]:
    """Run trials on several processes; results in the order of the jobs, with progress on stderr."""
    if workers == 1:
        return _told(map(run, jobs), len(jobs))
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        return _told(pool.map(run, jobs, chunksize=4), len(jobs))


def _told(results: Iterable[Result], count: int) -> list[Result]:
    ended: list[Result] = []
    for result in results:
        ended.append(result)
        last = len(ended) == count
        if last or len(ended) % PROGRESS_EVERY == 0:
            solved = sum(one.outcome == "success" for one in ended)
            print(f"{len(ended)}/{count} trials, {solved} solved, now {result.job.task}", file=sys.stderr, flush=True)
    return ended


def report(results: list[Result]) -> None:
    """Print the rate per task with its interval, and every failure with its stage."""
    for task in dict.fromkeys(result.job.task for result in results):
        mine = [result for result in results if result.job.task == task]
        scored = [result for result in mine if result.outcome in ("success", "failure")]
        rate = Rate(sum(result.outcome == "success" for result in scored), len(scored))
        others = Counter(result.outcome for result in mine if result not in scored)
        seeds = [result.job.seed for result in mine]
        extra = f"  not scored: {dict(others)}" if others else ""
        mean_s = sum(result.seconds for result in mine) / len(mine)
        print(f"{task:32s} {rate}  seeds {min(seeds)}-{max(seeds)}  {mean_s:.2f} s a trial{extra}")
        for result in mine:
            if result.outcome != "success":
                print(f"    seed {result.job.seed}: {result.outcome} at {result.stage}: {result.reason[:200]}")
    _report_mean(results)


def _report_mean(results: list[Result]) -> None:
    """The mean over VIMA's tasks, each counted once, and where the misses failed."""
    rates = []
    for task in VIMA17:
        scored = [result for result in results if result.job.task == task and result.outcome in ("success", "failure")]
        if scored:
            rates.append(sum(result.outcome == "success" for result in scored) / len(scored))
    if len(rates) > 1:
        print(
            f"mean over {len(rates)} of VIMA's 17 tasks: {100 * sum(rates) / len(rates):.1f} %, worst {100 * min(rates):.0f} %"
        )
    stages = Counter(str(result.stage) for result in results if result.outcome != "success")
    if stages:
        print("misses by stage: " + ", ".join(f"{name} {count}" for name, count in stages.most_common()))


def main() -> None:
    """Parse arguments, run, print, and optionally write JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", nargs="*", help="default: VIMA's 17, and on the tabletop the fruit tasks")
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--seeds", type=int, help="seeds per task (default: 50 per VIMA task, 20 per fruit variation)")
    parser.add_argument("--mode", default="lean", choices=["lean", "paper"])
    parser.add_argument("--ablation", default="full")
    parser.add_argument("--world", default="tabletop", choices=["tabletop", "vimabench"])
    parser.add_argument("--partition", help="a generalisation level, such as L3")
    parser.add_argument("--replans", type=int, default=0, help="replans after the first attempt (0: single attempt)")
    parser.add_argument("--reobserve", type=int, default=0, help="looks after pushes (0: open loop)")
    parser.add_argument("--recolour", type=int, help="redraw every scene with other colours, from this seed")
    parser.add_argument("--jobs", "--workers", type=int, default=2, help="processes")
    parser.add_argument("--json", type=Path, help="write every result to this file")
    options = parser.parse_args()
    jobs = [
        Job(
            task,
            options.first + number,
            options.mode,
            options.ablation,
            options.recolour,
            reobserve=options.reobserve,
            replans=options.replans,
            world=options.world,
            partition=options.partition,
        )
        for task in options.tasks or [*VIMA17, *(FRUIT if options.world == "tabletop" else ())]
        for number in range(options.seeds or (20 if task.startswith("fruit") else 50))
    ]
    print(f"model: offline (classical vision and a grammar)   method: team, {options.mode}, {options.ablation}")
    reobserve = f"a look after every push (at most {options.reobserve})" if options.reobserve else "open loop"
    attempts = f"{options.replans} replans" if options.replans else "single attempt"
    print(f"{attempts}, {reobserve}; {options.world}; 95 % Wilson intervals")
    results = run_all(jobs, options.jobs)
    report(results)
    if options.json:
        options.json.write_text(json.dumps([asdict(result) for result in results], indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
