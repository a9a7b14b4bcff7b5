"""How often the tabletop's oracle solves its tasks, and how fast: a check of the simulator, not of any planner.

Run: python benchmarks/oracle.py [--seeds 100] [--first 0] [--task NAME ...] [--levels] [--workers 2]

An episode: the scene is made, the oracle acts until it is solved or the horizon is reached, the score is read. Nothing
is drawn unless --pictures is given: then the instruction's pictures and both views before and after every action are.
Without --task the 17 tasks of VIMA-Bench run, with --levels each at every generalisation level that it has.

The last line compares the rate with the real simulator's own oracle: 4.7 s an episode on one core, measured with its
default options over 34 episodes (two seeds a task) of the same 17 tasks.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time

from wonderful_team.core.intervals import wilson_interval
from wonderful_team.sims.tabletop import make_world, partitions, task_names

REAL_S = 4.7
"""What an episode of VIMA-Bench's oracle takes on one core [s]."""


def solved(task: str, seed: int, pictures: bool = False) -> tuple[bool, str, int]:
    """Whether the oracle solves one scene, why not, and with how many actions."""
    world = make_world(task, seed)
    try:
        if pictures:
            _ = world.instruction, world.observe()
        count = 0
        while count < world.horizon and (actions := world.privileged.oracle()):
            # Pushes end where friction lets them: the oracle looks again after every action.
            world.execute(actions[0])
            count += 1
            if pictures:
                world.observe()
        score = world.privileged.score()
        return bool(score.success), f"{score.stage}: {score.reason}", count
    finally:
        world.close()


def _one(job: tuple[str, int, bool]) -> tuple[bool, str, int, float]:
    start = time.process_time()
    return *solved(*job), time.process_time() - start


def tasks_asked(options: argparse.Namespace) -> list[str]:
    """The tasks to run, such as rotate or rotate@L3."""
    named = options.task or [name for name in task_names() if "/" not in name]
    if not options.levels:
        return named
    return [f"{name}@{level}" for name in named for level in partitions(name)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=100, help="scenes per task")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--task", action="append", help="only this task, such as rotate or rotate@L3@clutter=2; repeat")
    parser.add_argument("--levels", action="store_true", help="every task at each of its generalisation levels")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--pictures", action="store_true", help="draw what a planner would see, too")
    options = parser.parse_args()
    tasks = tasks_asked(options)
    seeds = range(options.first, options.first + options.seeds)
    solved_count, cpu_s = 0, 0.0
    with multiprocessing.get_context("spawn").Pool(options.workers) as pool:
        # Processes start and load the simulator before the clock does.
        pool.map(_one, [(tasks[0], seeds[0], False)] * options.workers, chunksize=1)
        start = time.perf_counter()
        for task in tasks:
            results = pool.map(_one, [(task, seed, options.pictures) for seed in seeds], chunksize=1)
            solved_count += _tell(task, seeds, results)
            cpu_s += sum(seconds for *_, seconds in results)
        wall_s = time.perf_counter() - start
    episodes = len(tasks) * len(seeds)
    low, high = wilson_interval(solved_count, episodes)
    print(
        f"{solved_count}/{episodes} solved, 95 % {100 * low:.1f} to {100 * high:.1f} %; seeds {seeds[0]} to {seeds[-1]}"
    )
    rate = episodes / wall_s
    print(
        f"{wall_s:.1f} s, {1e3 * cpu_s / episodes:.0f} ms CPU an episode: {rate:.2f} episodes a second with "
        f"{options.workers} processes; on one core {REAL_S / (cpu_s / episodes):.0f} times the real simulator's "
        f"{1 / REAL_S:.2f} a second by CPU time, {rate * REAL_S / options.workers:.0f} times by the clock"
    )


def _tell(task: str, seeds: range, results: list[tuple[bool, str, int, float]]) -> int:
    """Print one line for a task and one for each miss; how many were solved."""
    good = sum(success for success, _, _, _ in results)
    low, high = wilson_interval(good, len(results))
    cost_ms = 1e3 * sum(seconds for *_, seconds in results) / len(results)
    steps = sum(count for _, _, count, _ in results) / len(results)
    print(
        f"{task:28s} {good:3d}/{len(results)}  95 % {100 * low:5.1f} to {100 * high:5.1f} %  "
        f"{steps:4.1f} actions, {cost_ms:4.0f} ms CPU an episode",
        flush=True,
    )
    for seed, (success, why, _, _) in zip(seeds, results, strict=True):
        if not success:
            print(f"    seed {seed}: {why}")
    return good


if __name__ == "__main__":
    main()
